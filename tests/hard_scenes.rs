//! The gallery of hard cases in `scenes/hard`: each picture is that of the `f64` renderer, or what can be said of it by
//! hand.

use std::fs;
use std::path::{Path, PathBuf};

use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::image::Film;
use vitrum::load;
use vitrum::render::{Observer, Options, reference, render};
use vitrum::scene::Scene;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/hard")
}

/// A scene of the gallery, small.
fn scene(name: &str) -> Scene {
    let file = folder().join(name).with_extension("toml");
    let loaded = load::scene(&file, &load::LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.report.warnings.is_empty(), "{name}: {:?}", loaded.report.warnings);
    assert!(loaded.report.dropped.is_empty(), "{name}: {:?}", loaded.report.dropped);
    let mut scene = loaded.scene;
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (WIDTH, HEIGHT, 1);
    scene
}

fn native(scene: &Scene) -> Film {
    let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default()).expect("there is memory");
    let outcome = render(scene, &accel, &Options::default(), &Observer::default()).expect("renders");
    assert_eq!((outcome.non_finite, outcome.clamped), (0, 0));
    outcome.film
}

/// Pixels of which a channel differs by more than `tolerance`.
fn apart(a: &Film, b: &Film, tolerance: f32) -> usize {
    let off = |(a, b): &(&[f32; 3], &[f32; 3])| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > tolerance);
    a.pixels.iter().zip(&b.pixels).filter(off).count()
}

/// The picture is that in `f64`, but for a share of the pixels, whose rays pass an edge too closely to call.
fn is_that_in_f64(name: &str, share: f64) {
    let scene = scene(name);
    let ours = native(&scene);
    let theirs = reference::render(&scene, &Options::default(), &Observer::default()).expect("renders").film;
    let apart = apart(&ours, &theirs, 1.0 / 255.0);
    let most = share * ours.pixels.len() as f64;
    println!("{name}: {apart} pixels of {} apart", ours.pixels.len());
    assert!(apart as f64 <= most, "{name}: {apart} pixels are apart, {most} may be");
    let brightest = theirs.pixels.iter().flatten().fold(0.0_f32, |m, &x| m.max(x));
    let darkest = theirs.pixels.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min);
    assert!(brightest - darkest > 0.2, "{name} shows nothing: {darkest} to {brightest}");
}

#[test]
fn every_hard_scene_says_what_is_hard_about_it_and_has_a_test_here() {
    let tests = include_str!("hard_scenes.rs");
    let mut count = 0;
    for file in fs::read_dir(folder()).expect("the folder is there") {
        let file = file.expect("readable").path();
        let text = fs::read_to_string(&file).expect("readable");
        let comment: usize = text.lines().take_while(|l| l.starts_with('#')).map(str::len).sum();
        assert!(comment > 60, "{}", file.display());
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        assert!(tests.contains(&format!("(\"{name}\"")), "no test of {name}");
        count += 1;
    }
    assert!(count >= 7, "{count}");
}

#[test]
fn glass_seen_along_its_face_is_that_in_f64() {
    is_that_in_f64("grazing", 0.004);
}

#[test]
fn media_that_touch_are_those_in_f64() {
    is_that_in_f64("touching", 0.004);
}

#[test]
fn glass_far_from_the_origin_is_that_in_f64() {
    // Coordinates are 1/64 apart, and rays start some ten such steps off a ball of radius 20: checks seen through it shift.
    is_that_in_f64("far", 0.04);
}

#[test]
fn tiny_and_huge_balls_are_those_in_f64() {
    is_that_in_f64("sizes", 0.004);
}

#[test]
fn needles_are_those_in_f64() {
    is_that_in_f64("needles", 0.02);
}

#[test]
fn the_window_into_the_sky_is_that_in_f64() {
    is_that_in_f64("critical", 0.004);
}

#[test]
fn shapes_of_index_one_leave_the_picture_of_the_empty_room() {
    let with = scene("index-one");
    let mut without = with.clone();
    without.geometry.truncate(1);
    without.objects.truncate(1);
    assert_eq!(without.objects[0].name, "ground");
    let apart = apart(&native(&with), &native(&without), 1e-4);
    // A ray that goes on from a surface starts an error bound further along: only the edges of the checks can tell.
    assert!(apart <= 4, "{apart} pixels differ");
}

#[test]
fn the_rim_of_the_window_is_where_the_critical_angle_is_met() {
    let mut scene = scene("critical");
    // What is above the water shines, what is below does not.
    scene.environment = vitrum::scene::Environment::Constant(vitrum::scene::Rgb::ONE);
    scene.lights.clear();
    scene.settings.lights_from = vitrum::scene::LightsFrom::Lamps;
    let film = native(&scene);
    let prepared = reference::Prepared::new(&scene, Default::default());
    let critical = (1.0_f64 / 1.333_333_3).asin();
    let (mut inside, mut outside) = (0, 0);
    for (k, pixel) in film.pixels.iter().enumerate() {
        let (x, y) = (k as u32 % WIDTH, k as u32 / WIDTH);
        let (_, dir) = prepared.camera_ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let angle = dir.y.acos();
        if angle < critical - 1e-4 {
            assert!(pixel[0] > 0.0, "pixel {x}, {y} at {angle} rad sees no sky");
            inside += 1;
        } else if angle > critical + 1e-4 {
            assert_eq!(pixel[0], 0.0, "pixel {x}, {y} at {angle} rad is totally reflected");
            outside += 1;
        }
    }
    assert!(inside > 1000 && outside > 1000, "{inside} inside, {outside} outside");
}
