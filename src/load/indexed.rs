//! Meshes as most formats hold them: lists of attributes by vertex, and triangles whose corners index all of them.

use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::draft::MeshDraft;
use super::extent::within;
use super::report::Reporter;
use crate::Result;
use crate::geometry::{COORDINATE_LIMIT, TriMesh};
use crate::scene::Rgb;
use crate::system::memory;

/// Cure in messages about memory.
pub(super) const CURE: &str = "take a model of fewer triangles";
/// Most bytes per triangle of a checked mesh: three lists of indices, and three normals of its own.
const BYTES_A_TRIANGLE: u64 = 3 * 12 + 3 * 12 + 4;

/// Mesh that has not been checked. Lists of attributes are empty or as long as `positions`.
#[derive(Debug, Default)]
pub(super) struct Indexed {
    pub positions: Vec<DVec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    /// Linear colours.
    pub colours: Vec<Rgb>,
    /// Three indices of vertices for each triangle; they may be out of range.
    pub triangles: Vec<[u32; 3]>,
    /// Line of each triangle in the file; empty if the format has no lines.
    pub lines: Vec<u32>,
}

impl Indexed {
    /// Returns the mesh of all triangles that can be drawn, with their lines; the others are counted and reported. The
    /// mesh has no triangle if none can be drawn. Coordinates are at most `limit` if most of the positions exceed the
    /// general limit.
    ///
    /// A triangle without a usable normal at each corner is flat. Colours are limited to 0..=1.
    pub(super) fn checked(mut self, file: &Path, limit: f64, reporter: &mut Reporter) -> Result<(MeshDraft, Vec<u32>)> {
        let what = format!("the mesh of {}", file.display());
        memory::need(&what, self.triangles.len() as u64 * BYTES_A_TRIANGLE, CURE)?;
        let usual = f64::from(COORDINATE_LIMIT);
        let beyond = self.positions.iter().filter(|&&p| within(p, limit) && !within(p, usual)).count();
        let limit = if 2 * beyond > self.positions.len() { limit } else { usual };
        self.keep_drawable(file, limit, reporter)?;
        self.check_attributes(file, reporter)?;

        let mut mesh = TriMesh { colours: self.colours, ..TriMesh::default() };
        if !self.uvs.is_empty() {
            (mesh.uvs, mesh.uv_indices) = (self.uvs, self.triangles.clone());
        }
        if !self.normals.is_empty() {
            mesh.normal_indices = self.triangles.clone();
            let mut lacking = 0_u64;
            for (corners, indices) in self.triangles.iter().zip(&mut mesh.normal_indices) {
                if indices.iter().any(|&i| self.normals[i as usize] == Vec3::ZERO) {
                    lacking += 1;
                    *indices = [self.normals.len() as u32; 3];
                    self.normals.push(flat_normal(corners.map(|i| self.positions[i as usize])));
                }
            }
            for _ in 0..lacking {
                reporter.warn(file, 0, "a face without a usable normal at every corner is flat", String::new)?;
            }
            // Normals that no triangle uses still have to be normals.
            self.normals.iter_mut().filter(|n| **n == Vec3::ZERO).for_each(|n| *n = Vec3::Y);
            mesh.normals = self.normals;
        }
        mesh.triangles = self.triangles;
        let mut draft = MeshDraft { corners: self.positions, mesh, ..MeshDraft::default() };
        draft.round_unless_far();
        Ok((draft, self.lines))
    }

    /// Removes the triangles that cannot be drawn.
    fn keep_drawable(&mut self, file: &Path, limit: f64, reporter: &mut Reporter) -> Result<()> {
        let positions = &self.positions;
        let fault = |t: &[u32; 3]| -> Option<(&'static str, String)> {
            let Some(corners) = places(positions, t) else {
                let kind = "faces that name a vertex that does not exist are left out";
                return Some(("a vertex that does not exist", String::from(kind)));
            };
            if let Some(p) = corners.iter().find(|&&p| !within(p, limit)) {
                let reason = if p.is_finite() {
                    "a corner beyond the largest coordinate"
                } else {
                    "a corner that is not finite"
                };
                let kind = format!("faces with a corner that is not finite or beyond {limit:.1e} are left out");
                return Some((reason, kind));
            }
            let [a, b, c] = corners;
            (a == b || b == c || c == a)
                .then(|| ("corners that coincide", String::from("faces whose corners coincide are left out")))
        };
        let mut kept = 0;
        for i in 0..self.triangles.len() {
            let line = self.lines.get(i).copied();
            if let Some((reason, kind)) = fault(&self.triangles[i]) {
                reporter.dropped(reason);
                reporter.warn(file, line.unwrap_or(0) as usize, &kind, String::new)?;
                continue;
            }
            self.triangles[kept] = self.triangles[i];
            if let Some(line) = line {
                self.lines[kept] = line;
            }
            kept += 1;
        }
        self.triangles.truncate(kept);
        self.lines.truncate(kept);
        Ok(())
    }

    /// Normalises normals (zero marks one that cannot be used), and limits colours and texture coordinates.
    fn check_attributes(&mut self, file: &Path, reporter: &mut Reporter) -> Result<()> {
        for n in &mut self.normals {
            *n = n.as_dvec3().try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3());
        }
        if self.normals.iter().all(|n| *n == Vec3::ZERO) {
            self.normals.clear();
        }
        for colour in &mut self.colours {
            let kept = colour.map(|c| if c >= 0.0 { c.min(1.0) } else { 0.0 });
            if kept != *colour {
                reporter.warn(file, 0, "colours of corners below 0 or above 1 are limited to these", String::new)?;
                *colour = kept;
            }
        }
        for uv in self.uvs.iter_mut().filter(|uv| !uv.is_finite()) {
            reporter.warn(file, 0, "texture coordinates that are not finite count as 0", String::new)?;
            *uv = Vec2::ZERO;
        }
        Ok(())
    }
}

/// Returns the corners of a triangle, if they exist.
fn places(positions: &[DVec3], triangle: &[u32; 3]) -> Option<[DVec3; 3]> {
    let [a, b, c] = triangle.map(|i| positions.get(i as usize).copied());
    Some([a?, b?, c?])
}

/// Returns the unit normal of a triangle; +y for one without area, which no ray hits.
fn flat_normal([a, b, c]: [DVec3; 3]) -> Vec3 {
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
}
