//! Rays, hits and the shapes that rays meet. No materials: a shape knows only where it is.

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

/// The largest magnitude of a coordinate that takes part in intersection, in scene units: areas stay finite in
/// `f32`. It is the number below Embree's bound, which is 1.844e18 (`FLT_LARGE`) and exclusive.
pub const COORDINATE_LIMIT: f32 = 1.844e18_f32.next_down();

/// Which kinds of geometry a ray looks for; a set of bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct GeometryMask(pub u8);

impl GeometryMask {
    /// Surfaces that let no light through.
    pub const OPAQUE: Self = Self(1);
    /// Surfaces that let light through.
    pub const TRANSMISSIVE: Self = Self(2);
    /// Every surface.
    pub const ALL: Self = Self(3);

    /// Whether the two sets share a kind.
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

/// One shape of a scene. Its place in the list handed to an accelerator is the `geometry` of a hit.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// What it looks like.
    pub shape: Shape,
    /// The kinds it counts as; a ray passes through whatever its own mask does not meet.
    pub mask: GeometryMask,
}

impl Geometry {
    /// A shape that every ray looks for.
    #[must_use]
    pub fn new(shape: impl Into<Shape>) -> Self {
        Self { shape: shape.into(), mask: GeometryMask::ALL }
    }
}

/// The shapes that can be intersected.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles; the hit's `primitive` is the triangle.
    Mesh(TriMesh),
    /// An exact sphere; `primitive` is 0.
    Sphere(Sphere),
    /// An infinite plane, which no bounding box holds; `primitive` is 0.
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
