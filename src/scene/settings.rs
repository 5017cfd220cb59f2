//! How a picture is taken.

/// The part of a scene that the command line may override.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// A regular grid of `samples` by `samples` rays a pixel; 1 is the pixel's centre.
    pub samples: u32,
    /// How many times a ray may reflect or refract. Deeper rays end as truncated weight.
    pub max_depth: u32,
    /// Rays whose largest channel weight is below this end as truncated weight.
    pub cutoff: f32,
    /// What transparent surfaces do to shadows.
    pub shadows: ShadowRule,
    /// How lamps with an extent are sampled.
    pub lamps: LampSampling,
    /// Wavelengths that a white ray divides into where a medium disperses it, at least 7; fewer count as 7.
    pub wavelengths: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            samples: 1,
            max_depth: 64,
            cutoff: 1.0 / 1024.0,
            shadows: ShadowRule::Straight,
            lamps: LampSampling::default(),
            wavelengths: 12,
        }
    }
}

crate::choice! {
    /// Effect of transparent surfaces on shadows.
    pub enum ShadowRule("shadows", derive(Eq)) {
        /// Transparent surfaces block light, as opaque ones do.
        "opaque" => Opaque,
        /// Light goes straight through transparent surfaces, weakened by reflection, tint and absorption.
        ///
        /// The reflectance at a surface is that seen from its thinner side, so that it is the same both ways. There are no caustics.
        "straight" => Straight,
    }
}

/// How lamps with an extent are sampled: by points on them, each of which shines as a lamp of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LampSampling {
    /// Points on each lamp for each place that it shines on, at least 1; a square number where they form a grid.
    pub count: u32,
    /// How they lie.
    pub pattern: Pattern,
    /// Another seed is another scrambling of the points; no grid depends on it.
    pub seed: u32,
    /// Skip shadow rays where nothing is between a place and a lamp, or one surface covers all of the lamp. The picture
    /// is the same.
    pub probe: bool,
}

impl Default for LampSampling {
    fn default() -> Self {
        Self { count: 32, pattern: Pattern::Sobol, seed: 0, probe: true }
    }
}

/// How the points on a lamp lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// As Sobol's sequence, scrambled after Owen for each pixel and depth anew; the rays of a pixel continue each
    /// other's. What is left of error is fine noise.
    Sobol,
    /// As a square grid, the same everywhere. What is left of error is steps.
    Grid,
}
