//! Bounds and content of a scene, for reports.

use glam::DVec3;

use super::Scene;
use crate::geometry::{Aabb, Shape};

/// Content of an object's shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Content {
    /// `mesh`, `sphere` or `plane`.
    pub kind: &'static str,
    /// Number of triangles; 0 for exact shapes.
    pub triangles: usize,
    /// True if a mesh has normals at its corners.
    pub normals: bool,
    /// True if a mesh has texture coordinates.
    pub uvs: bool,
    /// True if a mesh has colours at its corners.
    pub colours: bool,
}

impl Scene {
    /// Returns the corners of the box around all shapes but planes, in world coordinates; `None` if there is none.
    #[must_use]
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let bounds = self.geometry.iter().fold(Aabb::EMPTY, |b, g| match &g.shape {
            Shape::Mesh(mesh) => b.union(mesh.bounds()),
            Shape::Sphere(sphere) => b.union(sphere.bounds()),
            Shape::Plane(_) => b,
        });
        (bounds.lo.x <= bounds.hi.x).then(|| [bounds.lo, bounds.hi].map(|p| self.world(p.as_dvec3())))
    }

    /// Returns the content of an object.
    #[must_use]
    pub fn content(&self, object: usize) -> Content {
        let exact = |kind| Content { kind, triangles: 0, normals: false, uvs: false, colours: false };
        match &self.geometry[object].shape {
            Shape::Mesh(mesh) => Content {
                kind: "mesh",
                triangles: mesh.triangles.len(),
                normals: !mesh.normals.is_empty(),
                uvs: !mesh.uvs.is_empty(),
                colours: !mesh.colours.is_empty(),
            },
            Shape::Sphere(_) => exact("sphere"),
            Shape::Plane(_) => exact("plane"),
        }
    }
}
