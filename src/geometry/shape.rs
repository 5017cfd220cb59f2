//! Shapes of a scene.

use super::aabb::Aabb;
use super::mask::GeometryMask;
use super::mesh::TriMesh;
use super::plane::Plane;
use super::sphere::Sphere;

/// One shape of a scene. Its index in the list that an accelerator is built from is the `geometry` of a hit.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// The shape.
    pub shape: Shape,
    /// The classes of the shape. A ray hits the shape only if their masks share a class.
    pub mask: GeometryMask,
}

impl Geometry {
    /// A shape that every ray looks for.
    #[must_use]
    pub fn new(shape: impl Into<Shape>) -> Self {
        Self { shape: shape.into(), mask: GeometryMask::ALL }
    }
}

/// A shape.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A triangle mesh; the hit's `primitive` is the triangle.
    Mesh(TriMesh),
    /// An exact sphere; `primitive` is 0.
    Sphere(Sphere),
    /// An infinite plane, which has no bounding box; `primitive` is 0.
    Plane(Plane),
}

impl Shape {
    /// Returns the box around all that can be hit; empty for a plane, which no box holds. Of a mesh it takes a pass over all
    /// triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Plane(_) => Aabb::EMPTY,
        }
    }
}

impl From<TriMesh> for Shape {
    fn from(mesh: TriMesh) -> Self {
        Self::Mesh(mesh)
    }
}

impl From<Sphere> for Shape {
    fn from(sphere: Sphere) -> Self {
        Self::Sphere(sphere)
    }
}

impl From<Plane> for Shape {
    fn from(plane: Plane) -> Self {
        Self::Plane(plane)
    }
}
