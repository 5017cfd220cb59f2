//! Light on surfaces from what shines beside lamps: emissive shapes and the environment.
//!
//! A shaded point takes `light_samples` samples of all emissive shapes together, and as many of the environment. They are
//! scrambled Sobol points as on area lamps, so the picture is the same on every run. Highlights answer to emissive shapes,
//! and not to the environment, which mirrors and coats reflect.

mod around;
mod emitters;
mod stage;
mod tree;

pub use around::Around;
pub use emitters::Emitters;
pub use stage::stages;

use crate::scene::Scene;

/// Sources of a scene that light surfaces, prepared for sampling.
#[derive(Debug, Default)]
pub struct Shine {
    /// Emissive shapes and sampled lamps, if they light surfaces.
    pub emitters: Option<Emitters>,
    /// Environment, if it lights surfaces.
    pub around: Option<Around>,
}

/// Kind of source that shines beside lamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shiner {
    /// Emissive shapes and sampled lamps.
    Emitters,
    /// The environment.
    Around,
}

impl Shiner {
    /// Both kinds.
    pub const ALL: [Self; 2] = [Self::Emitters, Self::Around];

    /// Returns the number that stands for the kind where lamps have their index; lamps come first.
    #[must_use]
    pub fn number(self, scene: &Scene) -> usize {
        scene.lights.len() + self as usize
    }

    /// Returns the kind of this number, or `None` if it is that of a lamp.
    #[must_use]
    pub fn of(number: usize, scene: &Scene) -> Option<Self> {
        Self::ALL.get(number.checked_sub(scene.lights.len())?).copied()
    }
}

impl Shine {
    /// Prepares what lights the surfaces of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let shining = scene.shining();
        Self {
            emitters: shining.emitters().then(|| Emitters::of(scene)).flatten(),
            around: shining.sky.then(|| Around::of(scene)).flatten(),
        }
    }
}
