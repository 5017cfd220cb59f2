//! The partners of one face, found by place: a short list, or a grid over the face where there are many.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::face::{Face, Form};

/// Partners up to which all of them are looked at.
const FEW: usize = 16;

/// Cells that one partner may cover; a larger one is looked at everywhere.
const MOST_CELLS: i64 = 64;

/// Faces that coincide with a face somewhere, as places in the list of touching faces.
#[derive(Clone, Debug)]
pub(super) enum Partners {
    /// All of them.
    Few(Vec<u32>),
    /// By cell of a square grid on the face.
    Grid(Box<Grid>),
}

/// A grid in the plane of a face.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    axes: [DVec3; 2],
    cell: f64,
    cells: HashMap<[i64; 2], Vec<u32>>,
    /// Partners that cover too many cells.
    large: Vec<u32>,
}

impl Default for Partners {
    fn default() -> Self {
        Self::Few(Vec::new())
    }
}

impl Partners {
    /// The partners of `face`.
    pub fn new(face: &Face, partners: Vec<u32>, at: impl Fn(u32) -> Face) -> Self {
        let (Form::Triangle { normal, .. } | Form::Plane { normal, .. }) = face.form else {
            return Self::Few(partners);
        };
        if partners.len() <= FEW {
            return Self::Few(partners);
        }
        let across = normal.any_orthonormal_vector();
        let axes = [across, normal.cross(across)];
        let flat = |p: DVec3| DVec2::new(p.dot(axes[0]), p.dot(axes[1]));
        let rect = |i: u32| match at(i).form {
            Form::Triangle { corners, .. } => {
                let [a, b, c] = corners.map(flat);
                Some((a.min(b).min(c), a.max(b).max(c)))
            }
            _ => None,
        };
        let rects: Vec<_> = partners.iter().map(|&i| (i, rect(i))).collect();
        // A cell of the mean size of a partner holds a few of them.
        let sizes = rects.iter().filter_map(|(_, rect)| rect.map(|(lo, hi)| (hi - lo).max_element()));
        let cell = sizes.sum::<f64>() / partners.len() as f64;
        if !(cell > 0.0 && cell.is_finite()) {
            return Self::Few(partners);
        }
        let mut grid = Grid { axes, cell, cells: HashMap::new(), large: Vec::new() };
        for (i, rect) in rects {
            let Some((lo, hi)) = rect else {
                grid.large.push(i);
                continue;
            };
            // A place may lie off its face by the slack of a query, which is far less than a cell.
            let margin = cell * 1e-3;
            let ([x0, y0], [x1, y1]) = (grid.cell_of(lo - margin), grid.cell_of(hi + margin));
            if (x1 - x0 + 1).saturating_mul(y1 - y0 + 1) > MOST_CELLS {
                grid.large.push(i);
                continue;
            }
            for x in x0..=x1 {
                for y in y0..=y1 {
                    grid.cells.entry([x, y]).or_default().push(i);
                }
            }
        }
        Self::Grid(Box::new(grid))
    }

    /// Shows the partners that may lie at a point.
    #[inline]
    pub fn near(&self, point: DVec3, mut see: impl FnMut(u32)) {
        match self {
            Self::Few(partners) => partners.iter().for_each(|&i| see(i)),
            Self::Grid(grid) => {
                let flat = DVec2::new(point.dot(grid.axes[0]), point.dot(grid.axes[1]));
                let here = grid.cells.get(&grid.cell_of(flat)).into_iter().flatten();
                here.chain(&grid.large).for_each(|&i| see(i));
            }
        }
    }
}

impl Grid {
    fn cell_of(&self, p: DVec2) -> [i64; 2] {
        let cell = (p / self.cell).floor();
        [cell.x as i64, cell.y as i64]
    }
}
