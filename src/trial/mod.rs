//! Trials: back ends side by side on the same rays. Knows shapes and accelerators, neither scenes nor materials.

pub mod random;
pub mod rays;

pub use rays::{Picture, RayKind, RaySet, View};
