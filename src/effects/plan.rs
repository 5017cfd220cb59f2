//! Decisions on which effects are simulated, with reasons.

use super::reason::Facts;
use super::{Effect, EffectSet, RayBound, Reach, without};
use crate::geometry::contact::Pair;
use crate::scene::Scene;

/// Choice of effects for a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Selection of the stages.
    pub pipeline: Pipeline,
    /// Effects left out although the scene has them.
    pub without: EffectSet,
}

/// Selection of the stages. The picture is the same to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pipeline {
    /// Picks stages that contain only code the scene needs.
    #[default]
    Auto,
    /// Picks stages that contain code for everything and select by the scene's data.
    All,
}

/// Decision on one effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Effect decided on.
    pub effect: Effect,
    /// True if the effect is simulated.
    pub on: bool,
    /// Object, material, light or medium that decided it, in words.
    pub because: String,
}

/// Effects of a scene and the facts behind them.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectPlan {
    /// Decisions, one for each of [`Effect::ALL`] in that order.
    pub decisions: Vec<Decision>,
    /// Objects and lights that rays can reach.
    pub reach: Reach,
    /// Pairs of touching objects, as far as contact changes the picture.
    pub touching: Vec<Pair>,
    /// Number of media that a ray can be in at once, in words.
    pub stack: String,
    /// Upper bound on the number of rays.
    pub rays: RayBound,
}

impl EffectPlan {
    /// Examines the whole scene before the first ray.
    #[must_use]
    pub fn resolve(scene: &Scene, options: &Options) -> Self {
        let scene = without(scene, options.without);
        let reach = Reach::of(&scene);
        let touching = super::contacts(&scene).pairs().to_vec();
        let facts = Facts::new(&scene, &reach, &touching);
        let decisions = Effect::ALL
            .iter()
            .map(|&effect| {
                if options.without.has(effect) {
                    Decision { effect, on: false, because: String::from("left out on request") }
                } else {
                    let (on, because) = facts.of(effect);
                    Decision { effect, on, because }
                }
            })
            .collect();
        let (nested, stack) = facts.stack();
        let rays = RayBound::of(&scene, &reach, nested);
        Self { decisions, stack, rays, reach, touching }
    }

    /// Returns the effects that are simulated.
    #[must_use]
    pub fn on(&self) -> EffectSet {
        self.decisions.iter().filter(|d| d.on).map(|d| d.effect).collect()
    }

    /// Returns the decision on an effect.
    #[must_use]
    pub fn of(&self, effect: Effect) -> &Decision {
        &self.decisions[effect as usize]
    }
}
