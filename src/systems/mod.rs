//! The lecture notes' reflection systems, which are older than a ray for each pixel: what they need to know of a scene,
//! and their arithmetic.
//!
//! A system finds what a mirror shows without tracing reflected rays. [`planar`] has the mirrors that a matrix serves, [`maps`] the
//! environment maps of reflectors. The
//! renderer shades what the systems find by the same stages as any other picture (`render`), so that the picture differs
//! from the traced one by what the system gets wrong and by nothing else.

pub mod alhazen;
pub mod maps;
pub mod planar;
mod reflector;

pub use reflector::reflects;
