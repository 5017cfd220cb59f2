//! Options of a render beyond the scene's own settings.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64};

use crate::effects;
use crate::optics::{FresnelModel, RefractionModel};
use crate::system::threads;
use crate::systems::maps::{Maps, Proxy};

crate::choice! {
    /// Source of reflected light.
    ///
    /// Mirrors whose own source is the environment are not affected.
    pub enum Reflection("reflection", derive(Eq, Hash), default(Traced)) {
        /// None: reflected light is left out and counted as truncated weight.
        "none" => None,
        /// Environment in the mirror direction, at any depth and through all objects.
        "environment" => Environment,
        /// Sphere map of each reflector's surroundings, taken from its centre.
        "sphere-map" => SphereMap,
        /// Cube map of each reflector's surroundings, taken from its centre.
        "cube-map" => CubeMap,
        /// Virtual scene behind each curved mirror, a ball or a smooth mesh, after Ofek and Rappoport; reflected rays elsewhere.
        "virtual" => Virtual,
        /// Rays of the camera's mirror image, in planar mirrors that it sees; reflected rays elsewhere.
        "planar" => Planar,
        /// Reflected rays.
        "traced" => Traced,
    }
}

/// Options of one render. Threads and tiles do not change the picture.
#[derive(Clone, Debug)]
pub struct Options {
    /// Formula for the share of light that a surface reflects.
    pub fresnel: FresnelModel,
    /// Formula for the direction of refracted light.
    pub refraction: RefractionModel,
    /// Source of reflected light.
    pub reflection: Reflection,
    /// Largest number of consecutive mirrors that a camera is mirrored in, under [`Reflection::Planar`]. Light that would
    /// need more is left out, and its weight is counted as truncated.
    pub mirror_levels: u32,
    /// Stand-in for the surroundings of reflectors that show maps.
    pub proxy: Proxy,
    /// Maps taken before, for another camera on the same scene. `None` takes new ones if the reflection asks for maps.
    pub maps: Option<Arc<Maps>>,
    /// Object that camera rays pass as if it were not there. All other rays meet it.
    pub past: Option<u32>,
    /// Effects left out, and the choice of stages.
    pub effects: effects::Options,
    /// Ends rays by a proven bound instead of by their weight (`Settings::cutoff`). The value, above 0, is the largest
    /// change in any channel of any pixel. The depth limit still applies.
    pub cutoff_error: Option<f32>,
    /// Number of worker threads; 0 means one per processor.
    pub threads: usize,
    /// Edge of a square tile, in pixels; at least 1.
    pub tile: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            fresnel: FresnelModel::Exact,
            refraction: RefractionModel::Stable,
            reflection: Reflection::Traced,
            mirror_levels: u32::MAX,
            proxy: Proxy::None,
            maps: None,
            past: None,
            effects: effects::Options::default(),
            cutoff_error: None,
            threads: 0,
            tile: 32,
        }
    }
}

/// Progress of a render, and the request to stop it.
#[derive(Debug, Default)]
pub struct Observer {
    /// Number of pixels finished so far.
    pub pixels_done: AtomicU64,
    /// Request to stop: when set, the render ends within a tile with `Error::Interrupted`.
    pub stop: AtomicBool,
}

impl Options {
    /// Returns the refraction formula to use: `refraction`, or none if refraction is left out.
    #[must_use]
    pub fn bending(&self) -> RefractionModel {
        if self.effects.without.has(effects::Effect::Refraction) {
            RefractionModel::StraightThrough
        } else {
            self.refraction
        }
    }

    /// Returns true if rays carry polarisation or budgets.
    #[must_use]
    pub fn carries(&self) -> bool {
        self.fresnel == FresnelModel::Polarised || self.cutoff_error.is_some()
    }

    /// Returns the number of threads, with 0 resolved to one per processor.
    #[must_use]
    pub fn thread_count(&self) -> usize {
        threads::count(self.threads)
    }
}
