//! The proven cut-off keeps its word.

use glam::Vec3;
use vitrum::image::Film;
use vitrum::render::{Ceiling, Observer, Options, reference};
use vitrum::scene::{Falloff, Interface, Light, LightKind, Material, MirrorSource, Rgb, Scene};

use super::{outcomes, random};
use crate::support::scenes::{bare, cuboid, empty, glass, material, sphere};

fn furthest(a: &Film, b: &Film) -> f32 {
    let channels = |film: &Film| film.pixels.iter().flatten().copied().collect::<Vec<f32>>();
    channels(a).iter().zip(channels(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn within(error: f32) -> Options {
    Options { cutoff_error: Some(error), ..Options::default() }
}

/// Every renderer's largest difference to its own full picture, with rays traced as a share of the full one's.
fn tried(scene: &Scene, error: f32) -> Vec<(&'static str, f32, f64)> {
    outcomes(scene, &Options::default())
        .into_iter()
        .zip(outcomes(scene, &within(error)))
        .map(|((name, full), (_, cut))| {
            let share = cut.rays.total() as f64 / full.rays.total() as f64;
            (name, furthest(&full.film, &cut.film), share)
        })
        .collect()
}

#[test]
fn what_is_cut_changes_no_channel_of_any_pixel_by_more_than_was_allowed() {
    let (mut cut_most, mut nearest) = (1.0_f64, 0.0_f32);
    for seed in 0..12 {
        let scene = random::scene(seed);
        for error in [1.0 / 16.0, 1.0 / 256.0, 1.0 / 4096.0] {
            for (name, off, share) in tried(&scene, error) {
                // The film itself is in f32: values up to some 16 round by 1e-6.
                assert!(off <= error + 2e-6, "{name}, scene {seed}: off by {off} where {error} was allowed");
                assert!(share <= 1.0);
                cut_most = cut_most.min(share);
                nearest = nearest.max(off / error);
            }
        }
    }
    println!("down to {cut_most:.3} of the rays; the bound was used up to {nearest:.3}");
    assert!(cut_most < 0.7, "it cuts something: {cut_most}");
    assert!(nearest > 0.002, "and what it cuts is seen: {nearest}");
}

/// Three balls of glass in a row, in front of a wall of light.
fn many_branches() -> Scene {
    let mut scene = empty(1.0);
    let crown = glass(&mut scene, 1.8, 0, Rgb::ZERO);
    for i in 0..3 {
        sphere(&mut scene, Vec3::new(0.0, 0.0, 1.5 - 1.5 * i as f32), 0.7, crown);
    }
    scene.settings.max_depth = 14;
    scene
}

#[test]
fn rays_that_are_each_worth_less_than_the_error_are_together_worth_more_and_so_a_budget_is_needed() {
    let scene = many_branches();
    let error = 1.0 / 64.0;
    let full = reference::render(&scene, &Options::default(), &Observer::default()).unwrap().film;
    // In a scene of radiance 1 a ray of this weight is worth this error.
    let mut each = scene.clone();
    each.settings.cutoff = error;
    let each = reference::render(&each, &Options::default(), &Observer::default()).unwrap().film;
    assert!(furthest(&full, &each) > 1.5 * error, "{}", furthest(&full, &each));
    for (name, off, share) in tried(&scene, error) {
        assert!(off <= error, "{name}: {off}");
        assert!(off > 0.04 * error, "{name}: some of the budget is used, {off}");
        assert!(share < 0.5, "{name}: {share}");
    }
}

#[test]
fn what_is_cut_is_counted_as_truncated_and_makes_up_the_difference_in_a_scene_of_radiance_one() {
    let scene = many_branches();
    for (name, outcome) in outcomes(&scene, &within(1.0 / 32.0)) {
        for (seen, lost) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
            assert!((seen[0] + lost[0] - 1.0).abs() < 2e-5, "{name}: {} + {}", seen[0], lost[0]);
        }
    }
}

#[test]
fn no_radiance_of_any_picture_is_above_its_ceiling_and_that_of_a_bare_scene_is_known() {
    for seed in 0..12 {
        let scene = random::scene(seed);
        let ceiling = Ceiling::of(&scene).unwrap().at(0);
        let film = reference::render(&scene, &Options::default(), &Observer::default()).unwrap().film;
        for pixel in &film.pixels {
            for c in 0..3 {
                assert!(f64::from(pixel[c]) <= ceiling[c], "scene {seed}: {} above {}", pixel[c], ceiling[c]);
            }
        }
    }
    // Glass and mirrors in a grey room of light add nothing to it.
    let mut scene = many_branches();
    assert_eq!(Ceiling::of(&scene).unwrap().at(0).to_array(), [1.0; 3]);
    let mirror = bare(Interface::Mirror { reflectance: Rgb::new(1.0, 0.5, 0.0), source: MirrorSource::Traced });
    let mirror = material(&mut scene, mirror);
    sphere(&mut scene, Vec3::X * 3.0, 0.5, mirror);
    assert_eq!(Ceiling::of(&scene).unwrap().at(0).to_array(), [1.0; 3]);
    // A white floor of 2 x 2, one below a lamp of intensity 4: 4 / pi at its nearest, and the room's light.
    let white = Material { diffuse: vitrum::scene::Colour::Constant(Rgb::ONE), ..Material::default() };
    let white = material(&mut scene, white);
    cuboid(&mut scene, Vec3::new(9.0, -1.0, -1.0), Vec3::new(11.0, 0.0, 1.0), white);
    scene.lights.push(lamp(Vec3::new(10.0, 1.0, 0.0)));
    let most = Ceiling::of(&scene).unwrap().at(0).x;
    let by_hand = 4.0 / std::f64::consts::PI;
    assert!(most >= by_hand && most < by_hand * 1.0001, "{most}");
    // However far the lamp, where distance does not weaken it.
    scene.lights[0].falloff = Falloff::None;
    let most = Ceiling::of(&scene).unwrap().at(0).x;
    assert!((4.0..4.001).contains(&most), "{most}");
}

/// All that a camera ray meets is a mirror, and all that this shows is a room of radiance 1.
#[test]
fn a_ray_goes_on_that_is_worth_a_little_more_than_the_error_and_ends_where_it_is_worth_less() {
    let error = 1.0 / 64.0;
    for (share, seen) in [(1.05, true), (0.95, false)] {
        let mut scene = empty(1.0);
        let reflectance = Rgb::splat(share * error);
        let mirror = bare(Interface::Mirror { reflectance, source: MirrorSource::Traced });
        let mirror = material(&mut scene, mirror);
        sphere(&mut scene, Vec3::ZERO, 4.0, mirror);
        for (name, outcome) in outcomes(&scene, &within(error)) {
            let got = outcome.film.at(16, 16)[0];
            assert!((got - if seen { share * error } else { 0.0 }).abs() < 1e-6, "{name}: {share} gives {got}");
        }
    }
}

fn lamp(position: Vec3) -> Light {
    Light {
        name: String::from("bulb"),
        kind: LightKind::Point { position },
        intensity: Rgb::splat(4.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    }
}

#[test]
fn a_lamp_that_touches_what_it_lights_is_refused_with_the_names_of_both() {
    let mut scene = many_branches();
    let grey = material(&mut scene, Material::default());
    cuboid(&mut scene, Vec3::new(-5.0, -2.0, -5.0), Vec3::new(5.0, -1.0, 5.0), grey);
    scene.lights.push(lamp(Vec3::new(0.3, -1.0, 0.7)));
    let refused = reference::render(&scene, &within(0.01), &Observer::default()).unwrap_err();
    assert_eq!(refused.exit_code(), 2);
    let message = refused.to_string();
    assert!(
        message.contains("`bulb`") && message.contains("`object 3`") && message.contains("proven cut-off"),
        "{message}"
    );
    assert!(!message.contains('\n'));
    // Without the square of the distance there is nothing to fear; nor where nothing answers to the lamp.
    scene.lights[0].falloff = Falloff::None;
    assert!(Ceiling::of(&scene).is_ok());
    scene.lights[0].falloff = Falloff::InverseSquare;
    scene.materials[grey as usize] = Material::black("black");
    assert!(Ceiling::of(&scene).is_ok());
}
