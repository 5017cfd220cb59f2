//! The hierarchy in memory: eight-wide inner nodes ([`bvh8`]), leaves of triangles ([`tri8`]) and of spheres
//! ([`sphere8`]), and the closest hits that leaf tests update ([`closest_hit`]).

pub(crate) mod bvh8;
pub(crate) mod closest_hit;
pub(crate) mod leaf;
pub(crate) mod sphere8;
pub(crate) mod tags;
pub(crate) mod tri8;
