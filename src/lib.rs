//! Vitrum: a SIMD packet ray tracer for people who care how light bends.

pub mod accel;
pub mod error;
pub mod geometry;
pub mod image;
pub mod math;
pub mod optics;
pub mod render;
pub mod scene;
pub mod simd;

pub use error::{Error, Result};
