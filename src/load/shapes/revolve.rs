//! Surfaces of revolution about the y axis.

use glam::{DVec2, DVec3, Vec2};

use crate::geometry::TriMesh;
use crate::load::transform::sin_cos_degrees;

/// Polyline of points `(r, y)`, with the normals at both ends of each piece.
pub(super) struct Profile {
    /// Radius and height. The outside is on the right in the direction of the polyline. Only the ends may have radius
    /// 0.
    pub points: Vec<DVec2>,
    /// True if the last point is joined to the first.
    pub looped: bool,
    /// Unit normals at the start and at the end of each piece; `None` for a mesh of flat triangles.
    pub normals: Option<Vec<[DVec2; 2]>>,
}

/// Returns the surface that `profile` sweeps in `segments` steps (at least 3) from +x towards +z.
pub(super) fn revolve(profile: &Profile, segments: u32) -> TriMesh {
    let columns: Vec<(f64, f64)> = angles(segments, 0.0);
    let mut mesh = TriMesh::default();

    // One corner on the axis, a ring of corners elsewhere.
    let mut rings = Vec::with_capacity(profile.points.len());
    for point in &profile.points {
        rings.push((mesh.positions.len() as u32, point.x == 0.0));
        let around = if point.x == 0.0 { 1 } else { columns.len() };
        mesh.positions.extend(columns[..around].iter().map(|&c| around_y(*point, c).as_vec3()));
    }
    let corner = |row: usize, column: u32| {
        let (first, pole) = rings[row % rings.len()];
        if pole { first } else { first + column % segments }
    };

    let heights = arc_fractions(profile);
    for v in &heights {
        mesh.uvs.extend((0..=segments).map(|j| Vec2::new(j as f32 / segments as f32, *v as f32)));
    }
    let uv = |row: usize, column: u32| row as u32 * (segments + 1) + column;

    let mut normals = Normals { columns: &columns, segments, last: None };
    for row in 0..heights.len() - 1 {
        let poles = [rings[row].1, rings[(row + 1) % rings.len()].1];
        let ends = profile.normals.as_ref().map(|n| {
            let [start, end] = n[row];
            [normals.ring(&mut mesh, start, poles[0]), normals.ring(&mut mesh, end, poles[1])]
        });
        for j in 0..segments {
            // Corners as (end of the piece, column).
            let mut triangle = |corners: [(usize, u32); 3]| {
                mesh.triangles.push(corners.map(|(end, k)| corner(row + end, k)));
                mesh.uv_indices.push(corners.map(|(end, k)| uv(row + end, k)));
                if let Some(ends) = ends {
                    mesh.normal_indices
                        .push(corners.map(|(end, k)| ends[end].at(if poles[end] { j } else { k }, segments)));
                }
            };
            if !poles[1] {
                triangle([(0, j), (1, j), (1, j + 1)]);
            }
            if !poles[0] {
                triangle([(0, j), (1, j + 1), (0, j + 1)]);
            }
        }
    }
    mesh
}

/// Returns cosine and sine of `segments` even steps; the first angle is `start` steps.
fn angles(segments: u32, start: f64) -> Vec<(f64, f64)> {
    (0..segments)
        .map(|j| {
            let (s, c) = sin_cos_degrees(360.0 * (f64::from(j) + start) / f64::from(segments));
            (c, s)
        })
        .collect()
}

fn around_y(point: DVec2, (c, s): (f64, f64)) -> DVec3 {
    DVec3::new(point.x * c, point.y, point.x * s)
}

/// Returns the position of each row along the polyline, from 0 to 1.
fn arc_fractions(profile: &Profile) -> Vec<f64> {
    let mut rows = vec![0.0];
    let joined = profile.looped.then(|| profile.points[0]);
    for (a, b) in profile.points.iter().zip(profile.points[1..].iter().copied().chain(joined)) {
        rows.push(rows[rows.len() - 1] + a.distance(b));
    }
    let whole = rows[rows.len() - 1];
    rows.iter().map(|r| (r / whole).min(1.0)).collect()
}

/// Ring of normals in the mesh, or one normal for all columns.
#[derive(Clone, Copy)]
struct Ring {
    first: u32,
    single: bool,
}

impl Ring {
    fn at(self, column: u32, segments: u32) -> u32 {
        if self.single { self.first } else { self.first + column % segments }
    }
}

/// Builder of rings of normals, which shares a ring between pieces that join smoothly.
struct Normals<'a> {
    columns: &'a [(f64, f64)],
    segments: u32,
    last: Option<(DVec2, bool, Ring)>,
}

impl Normals<'_> {
    /// Returns the ring of the profile normal `n`. On the axis a slanted normal is that of the middle of each segment.
    fn ring(&mut self, mesh: &mut TriMesh, n: DVec2, pole: bool) -> Ring {
        if let Some((m, p, ring)) = self.last
            && m == n
            && p == pole
        {
            return ring;
        }
        let ring = Ring { first: mesh.normals.len() as u32, single: n.x == 0.0 };
        if ring.single {
            mesh.normals.push(around_y(n, (1.0, 0.0)).as_vec3());
        } else if pole {
            mesh.normals.extend(angles(self.segments, 0.5).into_iter().map(|c| around_y(n, c).as_vec3()));
        } else {
            mesh.normals.extend(self.columns.iter().map(|&c| around_y(n, c).as_vec3()));
        }
        self.last = Some((n, pole, ring));
        ring
    }
}
