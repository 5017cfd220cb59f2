//! Reasons for effects being on or off.

use std::path::Path;

use glam::Vec3;
use vitrum::effects::{self, Decision, Effect, EffectPlan};
use vitrum::scene::{Rgb, Scene};

use super::{grey, lamp, small};
use crate::support::scenes::{empty, glass, material, plane, sphere};

#[test]
fn reasons_name_what_they_are_about() {
    let mut scene = empty(1.0);
    let clear = glass(&mut scene, 1.52, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::ZERO, 1.0, clear);
    scene.objects[0].name = "goblet".into();
    let why = |scene: &Scene, effect| {
        let decision = EffectPlan::resolve(scene, &effects::Options::default()).of(effect).clone();
        (decision.on, decision.because)
    };
    let is = |on, text: &str| (on, text.to_owned());
    assert_eq!(why(&scene, Effect::Refraction), is(true, "`goblet` has index 1.52 against `air` 1"));
    assert_eq!(why(&scene, Effect::Absorption), is(false, "no medium has a colour"));
    assert_eq!(why(&scene, Effect::HardShadows), is(false, "the only light is the environment"));
    assert_eq!(why(&scene, Effect::NestedMedia), is(false, "depth 1 is enough, no two dielectrics overlap"));
    scene.media[1].absorption = Rgb::X;
    assert_eq!(why(&scene, Effect::Absorption), is(true, "`medium 1.52` has a colour"));
    sphere(&mut scene, Vec3::X, 0.5, clear);
    assert_eq!(why(&scene, Effect::NestedMedia), is(true, "`goblet` and `object 1` may overlap"));
    scene.media[1].ior = 1.0;
    assert_eq!(why(&scene, Effect::TotalInternalReflection), is(false, "no ray can start in a denser medium"));
    assert_eq!(
        why(&scene, Effect::Refraction),
        is(false, "every transparent solid has the index of what surrounds it")
    );
    // A lamp under an opaque floor.
    let floor = material(&mut scene, grey());
    plane(&mut scene, Vec3::Y * -2.0, Vec3::Y, floor);
    scene.objects[2].name = "floor".into();
    scene.lights.push(lamp(Vec3::Y * -3.0));
    assert_eq!(why(&scene, Effect::HardShadows), is(false, "`lamp` is behind `floor`"));
    assert_eq!(why(&scene, Effect::Diffuse).1, "`lamp` is behind `floor`");
    // Nothing is in the way of a light that casts no shadows.
    scene.lights[0].shadows = false;
    assert!(why(&scene, Effect::Diffuse).0, "{}", why(&scene, Effect::Diffuse).1);
}

#[test]
fn the_illumination_model_of_a_material_decides_what_is_simulated() {
    let scene = small(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/illum.toml"));
    let plan = EffectPlan::resolve(&scene, &effects::Options::default());
    for (effect, model) in [
        (Effect::Mirror, "illum3"),
        (Effect::ThinPanes, "illum4"),
        (Effect::Coats, "illum5"),
        (Effect::Refraction, "illum6"),
    ] {
        let Decision { on, because, .. } = plan.of(effect);
        assert!(*on && because.contains(&format!("`models/{model}`")), "{effect}: {because}");
    }
    let only = |kept: &str| {
        let mut scene = scene.clone();
        let others: Vec<usize> = (0..scene.objects.len()).filter(|&o| !scene.objects[o].name.ends_with(kept)).collect();
        others.into_iter().rev().for_each(|o| {
            scene.objects.remove(o);
            scene.geometry.remove(o);
        });
        EffectPlan::resolve(&scene, &effects::Options::default()).on()
    };
    assert!(!only("illum2").has(Effect::FresnelSplit) && only("illum2").has(Effect::Highlight));
    // 6 reflects a fixed share, 7 what Fresnel says.
    assert!(only("illum6").has(Effect::Refraction) && !only("illum6").has(Effect::FresnelSplit));
    assert!(only("illum7").has(Effect::Refraction) && only("illum7").has(Effect::FresnelSplit));
}
