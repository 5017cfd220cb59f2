//! Effects that are on are simulated, and no others: the stages that run, and the visible result.

use std::path::Path;

use glam::Vec3;
use vitrum::effects::{self, Effect, EffectPlan, EffectSet, Pipeline};
use vitrum::render::{Observer, Options, Stage, reference};
use vitrum::scene::{Colour, Environment, FresnelRule, Interface, Material, Rgb};

use super::{auto_and_all, by, grey, lamp, mirror, same, small};
use crate::support::scenes::{bare, cuboid, empty, glass, material, native, plane, sphere};

#[test]
fn a_diffuse_scene_runs_no_stage_but_those_of_diffuse_surfaces() {
    let mut scene = empty(0.0);
    let grey = material(&mut scene, grey());
    cuboid(&mut scene, Vec3::splat(-0.5), Vec3::splat(0.5), grey);
    scene.lights.push(lamp(Vec3::new(2.0, 3.0, 4.0)));
    let streams = native(&scene, &Options::default()).streams;
    for stage in [Stage::Gather, Stage::Base, Stage::Light, Stage::Shadow] {
        assert!(streams.of(stage) > 0, "{stage:?}");
    }
    for stage in [
        Stage::Medium,
        Stage::Miss,
        Stage::Mirror,
        Stage::Conductor,
        Stage::Dielectric,
        Stage::Thin,
        Stage::Coated,
        Stage::Alpha,
        Stage::Lamp,
        Stage::Pass,
    ] {
        assert_eq!(streams.of(stage), 0, "{stage:?}");
    }
    assert_eq!(Stage::COUNT, 14, "a stage that is new is in one of these lists");
    let on: Vec<_> = EffectPlan::resolve(&scene, &effects::Options::default()).on().iter().collect();
    assert_eq!(on, [Effect::Diffuse, Effect::HardShadows]);
    // The same scene with a pane behind the eye has its code, and never runs it.
    let pane = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::ONE };
    let pane = material(&mut scene, bare(pane));
    sphere(&mut scene, Vec3::new(0.0, 0.0, 50.0), 0.1, pane);
    let streams = native(&scene, &Options::default()).streams;
    assert_eq!((streams.of(Stage::Thin), streams.of(Stage::Pass)), (0, 0));
}

/// No object is of it: that the eye is in it is all there is to know it by.
#[test]
fn the_medium_around_the_eye_weakens_what_is_seen_through_it() {
    let mut scene = empty(0.0);
    glass(&mut scene, 1.0, 0, Rgb::new(0.5, 0.25, 0.0));
    scene.camera.medium = Some(1);
    let wall = material(&mut scene, Material { emission: Rgb::ONE, ..Material::black("wall") });
    plane(&mut scene, Vec3::Z, Vec3::Z, wall);
    (scene.settings.width, scene.settings.height) = (1, 1);
    (scene.camera.eye, scene.camera.target) = (Vec3::Z * 5.0, Vec3::ZERO);
    let [auto, all] = auto_and_all(&scene, EffectSet::EMPTY, &Options::default());
    assert!(same(&auto, &all));
    for (seen, absorption) in auto.film.pixels[0].into_iter().zip([0.5_f32, 0.25, 0.0]) {
        assert!((seen - (-4.0 * absorption).exp()).abs() < 1e-6, "{seen} through {absorption}");
    }
}

#[test]
fn both_renderers_leave_out_the_same() {
    for name in ["box", "absorption", "illum"] {
        let scene = small(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml"));
        let plan = EffectPlan::resolve(&scene, &effects::Options::default());
        for effect in plan.on().iter() {
            let options = by(Pipeline::Auto, EffectSet::EMPTY.with(effect), &Options::default());
            let ours = native(&scene, &options);
            let theirs = reference::render(&scene, &options, &Observer::default()).expect("nobody interrupts a test");
            let pixels = ours.film.pixels.iter().zip(&theirs.film.pixels);
            let apart = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 5e-3)).count();
            // Edges and what magnifies roundings.
            assert!(apart <= 24, "{name} without {effect}: {apart} pixels");
        }
    }
}

#[test]
fn each_effect_that_is_on_shows_when_it_is_left_out() {
    let mut scene = empty(0.3);
    let ambient = Material { ambient: Rgb::ONE, emission: Rgb::splat(0.1), ..grey() };
    let checker = Colour::Checker { even: Rgb::ONE, odd: Rgb::ZERO, size: 0.3, offset: Vec3::splat(0.1) };
    let grey = material(&mut scene, Material { diffuse: checker, ..ambient });
    let mirror = material(&mut scene, mirror());
    let clear = glass(&mut scene, 1.5, 0, Rgb::X);
    scene.environment = Environment::Gradient { nadir: Rgb::X, horizon: Rgb::Y, zenith: Rgb::Z };
    scene.ambient = Rgb::splat(0.2);
    plane(&mut scene, Vec3::Y * -1.0, Vec3::Y, grey);
    sphere(&mut scene, Vec3::new(-0.7, 0.0, 0.0), 0.6, mirror);
    sphere(&mut scene, Vec3::new(0.7, 0.0, 0.0), 0.6, clear);
    scene.lights.push(lamp(Vec3::new(1.0, 3.0, 2.0)));
    let whole = native(&scene, &Options::default());
    let on = EffectPlan::resolve(&scene, &effects::Options::default()).on();
    for effect in [
        Effect::Ambient,
        Effect::Emission,
        Effect::Diffuse,
        Effect::HardShadows,
        Effect::ShadowsThroughGlass,
        Effect::Mirror,
        Effect::Refraction,
        Effect::FresnelSplit,
        Effect::Absorption,
        Effect::Environment,
        Effect::Textures,
    ] {
        assert!(on.has(effect), "{effect}");
        let left = native(&scene, &by(Pipeline::Auto, EffectSet::EMPTY.with(effect), &Options::default()));
        assert_ne!(whole.film, left.film, "{effect}");
    }
}
