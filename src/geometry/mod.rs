//! Rays, hits, and shapes with their intersection tests. Shapes have no materials.

mod aabb;
pub mod contact;
mod hit;
mod limit;
mod mask;
mod mesh;
pub(crate) mod plane;
mod ray;
mod shaft;
mod shape;
pub(crate) mod slab;
mod spawn;
pub(crate) mod sphere;
pub(crate) mod topology;
pub(crate) mod triangle;
pub mod triangle_test;

pub use aabb::{Aabb, Aabb8, Octant};
pub use hit::{Hit, Hit8, NO_GEOMETRY};
pub use limit::COORDINATE_LIMIT;
pub use mask::GeometryMask;
pub use mesh::TriMesh;
pub(crate) use mesh::is_usable;
pub use plane::Plane;
pub use ray::{Ray, Ray8};
pub use shaft::{Content, Shaft, ShaftEnd};
pub use shape::{Geometry, Shape};
pub use spawn::Spot;
pub use sphere::Sphere;
pub use triangle::intersect as intersect_triangle;
