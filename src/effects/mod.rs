//! Effects that a scene needs, with reasons, decided before the first ray.
//!
//! [`EffectPlan::resolve`] examines a whole scene and decides for each [`Effect`] whether it is simulated, and why. The
//! render picks its stages by the plan. [`without`] takes effects out of a scene.

mod bound;
mod effect;
mod plan;
mod reach;
mod reason;
mod set;
mod shell;
mod touching;
mod without;

pub use bound::RayBound;
pub use effect::Effect;
pub use plan::{Decision, EffectPlan, Options, Pipeline};
pub use reach::Reach;
pub use set::EffectSet;
pub use touching::contacts;
pub use without::without;
