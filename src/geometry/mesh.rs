//! Indexed triangles.

use glam::{Vec2, Vec3};

use super::{Aabb, COORDINATE_LIMIT};

/// Indexed triangles with optional attributes at their corners.
///
/// Every index is in range; coordinates may still be anything, and an accelerator leaves out (and counts) the
/// triangles that [`TriMesh::is_usable`] refuses.
#[derive(Clone, Debug, Default)]
pub struct TriMesh {
    /// Corner positions, in scene units.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` a triangle; counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals to interpolate; empty where the mesh is flat.
    pub normals: Vec<Vec3>,
    /// Three indices into `normals` a triangle; empty with `normals`.
    pub normal_indices: Vec<[u32; 3]>,
    /// Texture coordinates; empty where the mesh has none.
    pub uvs: Vec<Vec2>,
    /// Three indices into `uvs` a triangle; empty with `uvs`.
    pub uv_indices: Vec<[u32; 3]>,
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
        corners + normals + size_of_val(self.uvs.as_slice()) + size_of_val(self.uv_indices.as_slice())
    }

    /// The corners of triangle `i`.
    #[inline(always)]
    #[must_use]
    pub fn corners(&self, i: usize) -> [Vec3; 3] {
        self.triangles[i].map(|k| self.positions[k as usize])
    }

    /// The interpolated-normal corners of triangle `i`, where the mesh has any.
    #[inline(always)]
    #[must_use]
    pub fn corner_normals(&self, i: usize) -> Option<[Vec3; 3]> {
        self.normal_indices.get(i).map(|n| n.map(|k| self.normals[k as usize]))
    }

    /// The texture-coordinate corners of triangle `i`, where the mesh has any.
    #[inline(always)]
    #[must_use]
    pub fn corner_uvs(&self, i: usize) -> Option<[Vec2; 3]> {
        self.uv_indices.get(i).map(|n| n.map(|k| self.uvs[k as usize]))
    }

    /// Whether triangle `i` can be hit: finite corners within [`COORDINATE_LIMIT`], and three different ones.
    /// Thin and even collinear triangles are kept: they hold the edges of their neighbours.
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

/// Whether a triangle with these corners can be hit ([`TriMesh::is_usable`]).
#[inline(always)]
pub(crate) fn is_usable([a, b, c]: &[Vec3; 3]) -> bool {
    let small = |p: &Vec3| p.abs().cmple(Vec3::splat(COORDINATE_LIMIT)).all();
    small(a) & small(b) & small(c) & (a != b) & (b != c) & (c != a)
}
