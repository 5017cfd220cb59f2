//! Ranges of a scene's values, for the loader and for [`Scene::validate`](super::Scene::validate).

use std::ops::RangeInclusive;

/// Refractive indices, real parts of those of metals among them.
pub const INDICES: RangeInclusive<f64> = 1e-3..=1e3;

/// Largest imaginary part of a metal's index.
pub const MOST_EXTINCTION: f32 = 1e3;

/// Exponents of highlights.
pub const EXPONENTS: RangeInclusive<f64> = 0.0..=1e6;

/// Rays along one side of a pixel.
pub const SAMPLES: RangeInclusive<u32> = 1..=256;

/// Largest depth of a ray.
pub const MOST_DEPTH: u32 = 10_000;

/// Largest number of samples per lamp; more make no visible difference.
pub const LIGHT_SAMPLES: RangeInclusive<u32> = 1..=4096;

/// Largest number of wavelengths of a render; more make no visible difference.
pub const MOST_WAVELENGTHS: u32 = 64;

/// Smallest sine of the angle between the camera's `up` and its view.
pub const LEAST_SINE_OF_UP: f64 = 1e-4;

/// Smallest sine of the angle between the edges of a rectangular lamp.
pub const LEAST_SINE_OF_EDGES: f64 = 1e-3;
