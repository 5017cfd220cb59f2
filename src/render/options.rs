//! What a render is asked for beyond the scene's own settings.

use std::sync::atomic::{AtomicBool, AtomicU64};

use crate::effects;
use crate::optics::{FresnelModel, Oliveira, RefractionModel};

/// What becomes of light that surfaces reflect, mirrors that show the environment apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Reflection {
    /// A ray is traced.
    #[default]
    Traced,
    /// The environment is looked up in the mirror direction, at any depth and whatever stands between.
    Environment,
    /// It is left out, and counted as the weight of a ray that ended.
    None,
    /// In planar mirrors that the camera sees, or sees in other planar mirrors: by rays of the camera's mirror image
    /// ([`crate::systems`]). Elsewhere a ray is traced.
    Planar,
}

/// Choices of one render. Threads and tiles do not change the picture.
#[derive(Clone, Debug)]
pub struct Options {
    /// Which Fresnel formula splits light.
    pub fresnel: FresnelModel,
    /// Which formula bends light.
    pub refraction: RefractionModel,
    /// The constant of [`RefractionModel::Oliveira`]; no other formula looks at it.
    pub oliveira: Oliveira,
    /// What becomes of reflected light.
    pub reflection: Reflection,
    /// Under [`Reflection::Planar`], how many mirrors in a row a camera is mirrored in; light that would need more is left
    /// out, and counted as the weight of a ray that ended.
    pub mirror_levels: u32,
    /// Which effects are left out, and how stages are picked.
    pub effects: effects::Options,
    /// Cuts rays by a proven bound instead of by their weight (`Settings::cutoff`): what is cut changes no channel of any
    /// pixel by more than this, which is above 0. The depth limit cuts all the same.
    pub cutoff_error: Option<f32>,
    /// Worker threads; 0 is one a processor.
    pub threads: usize,
    /// Edge of a square tile in pixels, at least 1.
    pub tile: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            fresnel: FresnelModel::Exact,
            refraction: RefractionModel::Stable,
            oliveira: Oliveira::GLASS,
            reflection: Reflection::Traced,
            mirror_levels: u32::MAX,
            effects: effects::Options::default(),
            cutoff_error: None,
            threads: 0,
            tile: 32,
        }
    }
}

/// How a caller watches a render, and stops it.
#[derive(Debug, Default)]
pub struct Observer {
    /// Pixels finished so far.
    pub pixels_done: AtomicU64,
    /// Set it, and the render ends within a tile with `Error::Interrupted`.
    pub stop: AtomicBool,
}

impl Options {
    /// The formula that bends light: the one asked for, or none where refraction is left out.
    #[must_use]
    pub fn bending(&self) -> RefractionModel {
        if self.effects.without.has(effects::Effect::Refraction) {
            RefractionModel::StraightThrough
        } else {
            self.refraction
        }
    }

    /// The number of threads asked for, with 0 resolved to one a processor.
    #[must_use]
    pub fn thread_count(&self) -> usize {
        match self.threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            n => n,
        }
    }
}
