//! Settings of the picture.

/// Settings of a scene that the command line may override.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Edge of the regular grid of rays per pixel: `samples` by `samples`. 1 is the pixel's centre.
    pub samples: u32,
    /// Largest number of reflections and refractions along a path. Deeper rays end as truncated weight.
    pub max_depth: u32,
    /// Cut-off: rays whose largest channel weight is below this end as truncated weight.
    pub cutoff: f32,
    /// Treatment of shadow rays at transparent surfaces.
    pub shadows: ShadowRule,
    /// Sampling of area lamps.
    pub lamps: LampSampling,
    /// Treatment of many lamps.
    pub lamp_choice: LampChoice,
    /// Sources that light surfaces.
    pub lights_from: LightsFrom,
    /// True if surfaces cast shadows in the light of emissive shapes and of the environment.
    pub shine_shadows: bool,
    /// Number of wavelengths that a white ray divides into at dispersive media, at least 7; fewer count as 7.
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
            lamp_choice: LampChoice::default(),
            lights_from: LightsFrom::default(),
            shine_shadows: true,
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

crate::choice! {
    /// Sources of the light on matt surfaces.
    pub enum LightsFrom("lights-from", derive(Eq), default(Auto)) {
        /// Lamps; in a scene without lamps and ambient light, emissive shapes and the environment as well.
        "auto" => Auto,
        /// Lamps only.
        "lamps" => Lamps,
        /// Lamps and emissive shapes.
        "emissive" => Emissive,
        /// Lamps and the environment.
        "sky" => Sky,
        /// Lamps, emissive shapes and the environment.
        "all" => All,
    }
}

impl LightsFrom {
    /// Returns the level under which only lamps and the given sources light surfaces.
    #[must_use]
    pub fn only(emissive: bool, sky: bool) -> Self {
        match (emissive, sky) {
            (false, false) => Self::Lamps,
            (true, false) => Self::Emissive,
            (false, true) => Self::Sky,
            (true, true) => Self::All,
        }
    }
}

crate::choice! {
    /// Lamps that light a surface.
    pub enum LampChoice("lamps", derive(Eq), default(Each)) {
        /// Every lamp lights every surface.
        "each" => Each,
        /// Of point and spot lamps with inverse-square falloff and shadows, a sample lights each point, chosen by what arrives.
        ///
        /// The cost grows with the logarithm of their number, and the picture has the noise of area lamps.
        "sampled" => Sampled,
    }
}

/// Sampling of area lamps by points, each of which shines like a lamp of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LampSampling {
    /// Number of sample points per lamp and shaded point, at least 1; a square number for a grid.
    pub count: u32,
    /// Arrangement of the points.
    pub pattern: Pattern,
    /// Seed of the scrambling; without effect on a grid.
    pub seed: u32,
    /// Skips shadow rays where nothing lies between a shaded point and a lamp, or where one surface covers all of the
    /// lamp. The picture is the same.
    pub probe: bool,
}

impl Default for LampSampling {
    fn default() -> Self {
        Self { count: 32, pattern: Pattern::Sobol, seed: 0, probe: true }
    }
}

/// Arrangement of the sample points on a lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Sobol's sequence with Owen scrambling, anew for each pixel and depth; the rays of a pixel continue each other's
    /// points. The remaining error is fine noise.
    Sobol,
    /// Square grid, the same everywhere. The remaining error appears as steps.
    Grid,
}
