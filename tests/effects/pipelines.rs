//! The same picture by the stages that a scene calls for and by those that know everything, with effects or without them.

use vitrum::effects::{Effect, EffectPlan, EffectSet, Pipeline};
use vitrum::render::Options;

use super::{auto_and_all, by, same, scene_files, small};
use crate::support::scenes::native;
use crate::support::{Rng, random};

#[test]
fn every_scene_of_the_project_is_the_same_by_all_stages_as_by_its_own() {
    for file in scene_files() {
        let [auto, all] = auto_and_all(&small(&file), EffectSet::EMPTY, &Options::default());
        assert!(same(&auto, &all), "{}", file.display());
    }
}

#[test]
fn random_scenes_with_random_effects_left_out_are_the_same_by_all_stages_as_by_their_own() {
    let mut rng = Rng::new(77);
    for seed in 0..300 {
        let (scene, fresnel) = random::scene(seed);
        let options = Options { fresnel, ..Options::default() };
        let some: EffectSet = Effect::ALL.into_iter().filter(|_| rng.below(6) == 0).collect();
        for without in [EffectSet::EMPTY, some] {
            let [auto, all] = auto_and_all(&scene, without, &options);
            assert!(same(&auto, &all), "scene {seed} without {:?}", without.iter().collect::<Vec<_>>());
        }
    }
}

#[test]
fn what_is_off_can_be_left_out_without_changing_a_bit() {
    for seed in 0..120 {
        let (scene, fresnel) = random::scene(seed);
        let options = Options { fresnel, ..Options::default() };
        let whole = native(&scene, &options);
        let plan = EffectPlan::resolve(&scene, &options.effects);
        for decision in plan.decisions.iter().filter(|d| !d.on) {
            let without = EffectSet::EMPTY.with(decision.effect);
            let left = native(&scene, &by(Pipeline::Auto, without, &options));
            assert!(same(&whole, &left), "scene {seed}: {} is off ({})", decision.effect, decision.because);
        }
    }
}
