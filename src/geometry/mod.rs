//! Rays, hits, and shapes with their intersection tests. Shapes have no materials.

mod aabb;
pub mod contact;
mod hit;
mod mesh;
pub(crate) mod plane;
mod ray;
mod shaft;
pub(crate) mod slab;
mod spawn;
pub(crate) mod sphere;
pub(crate) mod topology;
pub(crate) mod triangle;
pub mod triangle_test;

pub use aabb::{Aabb, Aabb8, Octant};
pub use hit::{Hit, Hit8, NO_GEOMETRY};
pub use mesh::TriMesh;
pub(crate) use mesh::is_usable;
pub use plane::Plane;
pub use ray::{Ray, Ray8};
pub use shaft::{Content, Shaft, ShaftEnd};
pub use spawn::Spot;
pub use sphere::Sphere;
pub use triangle::intersect as intersect_triangle;

/// The largest magnitude of a coordinate that takes part in intersection, in scene units. Below it areas stay finite in
/// `f32`. It is the largest number below Embree's exclusive bound, 1.844e18 (`FLT_LARGE`).
pub const COORDINATE_LIMIT: f32 = 1.844e18_f32.next_down();

/// A set of geometry classes: those a shape belongs to, or those a ray can hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct GeometryMask(pub u8);

impl GeometryMask {
    /// Opaque surfaces.
    pub const OPAQUE: Self = Self(1);
    /// Surfaces that transmit light.
    pub const TRANSMISSIVE: Self = Self(2);
    /// All surfaces.
    pub const ALL: Self = Self(3);

    /// Returns true if the two sets share a class.
    #[inline(always)]
    #[must_use]
    pub const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

impl Default for GeometryMask {
    fn default() -> Self {
        Self::ALL
    }
}

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
