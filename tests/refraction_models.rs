//! The choice of a refraction formula reaches both renderers, and both make the same picture of it.

use crate::support;

use glam::Vec3;
use support::scenes::{empty, glass, native, sphere};
use vitrum::image::Film;
use vitrum::optics::{Oliveira, RefractionModel};
use vitrum::render::{Observer, Options, reference};
use vitrum::scene::{Environment, Rgb, Scene};

fn ball() -> Scene {
    let mut scene = empty(0.0);
    scene.environment = Environment::Gradient { nadir: Rgb::X, horizon: Rgb::Y, zenith: Rgb::Z };
    scene.settings.max_depth = 4;
    let material = glass(&mut scene, 1.5, 0, Rgb::new(0.1, 0.2, 0.3));
    sphere(&mut scene, Vec3::ZERO, 1.0, material);
    scene
}

fn largest_difference(a: &Film, b: &Film) -> f32 {
    a.pixels.as_flattened().iter().zip(b.pixels.as_flattened()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn both(refraction: RefractionModel) -> [Film; 2] {
    let options = Options { refraction, ..Options::default() };
    let scene = ball();
    let ours = native(&scene, &options);
    let theirs = reference::render(&scene, &options, &Observer::default()).expect("nobody interrupts a test");
    // A formula that knows no direction where there is one loses weight, and says so.
    assert!(largest_difference(&ours.truncated, &theirs.truncated) < 1e-3, "{refraction:?}");
    [ours.film, theirs.film]
}

#[test]
fn exact_formulas_give_one_picture_and_approximations_others() {
    let [stable, _] = both(RefractionModel::Stable);
    for (model, exact) in [
        (RefractionModel::Stable, true),
        (RefractionModel::Trigonometric, true),
        (RefractionModel::Heckbert, true),
        (RefractionModel::Bec, true),
        (RefractionModel::SlidesVector, true),
        (RefractionModel::Oliveira(Oliveira::GLASS), false),
        (RefractionModel::Oliveira(Oliveira::AS_PRINTED), false),
        (RefractionModel::StraightThrough, false),
    ] {
        let [ours, theirs] = both(model);
        let apart = largest_difference(&ours, &theirs);
        assert!(apart < 2e-3, "{model}: the renderers are {apart} apart");
        let off = largest_difference(&ours, &stable);
        assert_eq!(off < 2e-3, exact, "{model}: {off} off the stable form");
    }
}

#[test]
fn the_constant_of_oliveiras_formula_changes_the_picture() {
    let [glass, _] = both(RefractionModel::Oliveira(Oliveira::GLASS));
    let [printed, _] = both(RefractionModel::Oliveira(Oliveira::AS_PRINTED));
    assert!(largest_difference(&glass, &printed) > 0.02);
}
