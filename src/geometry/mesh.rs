//! Triangle meshes.

use glam::{Vec2, Vec3};

use super::aabb::Aabb;
use super::limit::COORDINATE_LIMIT;

/// An indexed triangle mesh with optional attributes at the corners.
///
/// Every index is in range. Coordinates may have any value: an accelerator leaves out, and counts, triangles that are not
/// usable ([`TriMesh::is_usable`]).
#[derive(Clone, Debug, Default)]
pub struct TriMesh {
    /// Corner positions, in scene units.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` for each triangle, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals to interpolate; empty if the mesh is flat-shaded.
    pub normals: Vec<Vec3>,
    /// Three indices into `normals` for each triangle; empty if `normals` is.
    pub normal_indices: Vec<[u32; 3]>,
    /// Texture coordinates; empty if the mesh has none.
    pub uvs: Vec<Vec2>,
    /// Three indices into `uvs` for each triangle; empty if `uvs` is.
    pub uv_indices: Vec<[u32; 3]>,
    /// Linear colours of the corners, one for each position; empty if the mesh has none.
    pub colours: Vec<Vec3>,
}

impl TriMesh {
    /// A mesh without normals and texture coordinates.
    #[must_use]
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, ..Self::default() }
    }

    /// Bytes of all lists.
    pub(crate) fn bytes(&self) -> usize {
        let corners = size_of_val(self.positions.as_slice()) + size_of_val(self.triangles.as_slice());
        let normals = size_of_val(self.normals.as_slice()) + size_of_val(self.normal_indices.as_slice());
        let uvs = size_of_val(self.uvs.as_slice()) + size_of_val(self.uv_indices.as_slice());
        corners + normals + uvs + size_of_val(self.colours.as_slice())
    }

    /// The corners of triangle `i`.
    #[inline(always)]
    #[must_use]
    pub fn corners(&self, i: usize) -> [Vec3; 3] {
        self.triangles[i].map(|k| self.positions[k as usize])
    }

    /// The normals at the corners of triangle `i`, if the mesh has any.
    #[inline(always)]
    #[must_use]
    pub fn corner_normals(&self, i: usize) -> Option<[Vec3; 3]> {
        self.normal_indices.get(i).map(|n| n.map(|k| self.normals[k as usize]))
    }

    /// The texture coordinates at the corners of triangle `i`, if the mesh has any.
    #[inline(always)]
    #[must_use]
    pub fn corner_uvs(&self, i: usize) -> Option<[Vec2; 3]> {
        self.uv_indices.get(i).map(|n| n.map(|k| self.uvs[k as usize]))
    }

    /// The colours at the corners of triangle `i`, if the mesh has any.
    #[inline(always)]
    #[must_use]
    pub fn corner_colours(&self, i: usize) -> Option<[Vec3; 3]> {
        if self.colours.is_empty() { None } else { Some(self.triangles[i].map(|k| self.colours[k as usize])) }
    }

    /// Returns true if triangle `i` can be hit: its corners are finite, within [`COORDINATE_LIMIT`], and different from each
    /// other. Thin and even collinear triangles are usable, since they close the gaps between their neighbours.
    #[must_use]
    pub fn is_usable(&self, i: usize) -> bool {
        is_usable(&self.corners(i))
    }

    /// The box around every usable triangle.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        (0..self.triangles.len())
            .filter(|&i| self.is_usable(i))
            .fold(Aabb::EMPTY, |b, i| b.union(Aabb::of(&self.corners(i))))
    }
}

/// Returns true if a triangle with these corners can be hit ([`TriMesh::is_usable`]).
#[inline(always)]
pub(crate) fn is_usable([a, b, c]: &[Vec3; 3]) -> bool {
    let small = |p: &Vec3| p.abs().cmple(Vec3::splat(COORDINATE_LIMIT)).all();
    small(a) & small(b) & small(c) & (a != b) & (b != c) & (c != a)
}
