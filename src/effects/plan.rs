//! Which effects are simulated, and why.

use super::reason::Facts;
use super::{Effect, EffectSet, RayBound, Reach, without};
use crate::geometry::contact::Pair;
use crate::scene::Scene;

/// What a render is asked for in the way of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// How stages are picked.
    pub pipeline: Pipeline,
    /// Effects that are left out although the scene calls for them.
    pub without: EffectSet,
}

/// How stages are picked. The picture is the same to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pipeline {
    /// What the scene does not call for is not in the code that renders it.
    #[default]
    Auto,
    /// Every stage is there and knows everything; what happens is selected by the scene's data.
    All,
}

/// One effect, decided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// What.
    pub effect: Effect,
    /// Whether it is simulated.
    pub on: bool,
    /// Because of which object, material, light or medium.
    pub because: String,
}

/// What a scene calls for.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectPlan {
    /// One for each of [`Effect::ALL`], in that order.
    pub decisions: Vec<Decision>,
    /// What rays and lights can reach.
    pub reach: Reach,
    /// Pairs of objects that touch, where that changes the picture.
    pub touching: Vec<Pair>,
    /// How many media a ray can be in at once, in words.
    pub stack: String,
    /// How many rays a pixel takes at most.
    pub rays: RayBound,
}

impl EffectPlan {
    /// Looks at the whole scene before the first ray.
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

    /// The effects that are simulated.
    #[must_use]
    pub fn on(&self) -> EffectSet {
        self.decisions.iter().filter(|d| d.on).map(|d| d.effect).collect()
    }

    /// What was decided of an effect.
    #[must_use]
    pub fn of(&self, effect: Effect) -> &Decision {
        &self.decisions[effect as usize]
    }
}
