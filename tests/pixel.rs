//! The rays of one pixel, written down: they are the picture's, to the bit, and what is said of them is so.

use crate::support;

use std::process::Command;

use assert_cmd::prelude::*;
use glam::{DVec3, Vec3};
use support::{backends, scenes};
use vitrum::accel::Accel;
use vitrum::load::{self, LoadOptions};
use vitrum::optics::{FresnelModel, Oliveira, RefractionModel};
use vitrum::render::record::{Event, Met, Source, Tree};
use vitrum::render::reference::{self, Prepared};
use vitrum::render::{Observer, Options, RayKind, recorded, render};
use vitrum::scene::{Falloff, Highlight, HighlightModel, Interface, Light, LightKind, Material, Rgb, Scene, Settings};

fn built(scene: &Scene) -> Accel {
    backends::native(&scene.geometry)
}

/// Radiance, truncated weight and rays of a pixel on the native path.
fn native(scene: &Scene, options: &Options, pixel: (u32, u32)) -> ([f32; 3], [f32; 3], Tree) {
    with(&built(scene), scene, options, pixel)
}

fn with(accel: &Accel, scene: &Scene, options: &Options, pixel: (u32, u32)) -> ([f32; 3], [f32; 3], Tree) {
    recorded(scene, accel, options, &Observer::default(), pixel).expect("nobody interrupts a test")
}

/// The sum of numbers that are multiples of 2^-64 but for digits below, as the renderer adds them up.
fn fixed_sum(numbers: impl Iterator<Item = DVec3>, samples: u32) -> [f32; 3] {
    let mut sums = [0_i128; 3];
    for number in numbers {
        for (sum, x) in sums.iter_mut().zip(number.to_array()) {
            // Towards zero, as `as` rounds.
            *sum += (x * 2.0_f64.powi(64)) as i128;
        }
    }
    sums.map(|s| (s as f64 * (2.0_f64.powi(-64) / f64::from(samples))) as f32)
}

fn small(name: &str, samples: u32) -> Scene {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let mut scene = load::scene(&path, &LoadOptions::default()).expect("a scene of ours").scene;
    scene.settings = Settings { width: 24, height: 16, samples, ..scene.settings };
    scene
}

#[test]
fn every_pixel_is_the_sum_of_its_rays_and_the_pictures_own_to_the_bit() {
    let refraction = |refraction| Options { refraction, ..Options::default() };
    let schlick = Options { fresnel: FresnelModel::Schlick, ..Options::default() };
    for (name, samples, options) in [
        ("glass.toml", 1, Options::default()),
        ("absorption.toml", 2, Options::default()),
        ("goblet.toml", 1, schlick),
        ("hall.toml", 1, Options::default()),
        ("box.toml", 2, refraction(RefractionModel::Oliveira(Oliveira::GLASS))),
        ("illum.toml", 1, refraction(RefractionModel::Heckbert)),
    ] {
        let scene = small(name, samples);
        let accel = built(&scene);
        let picture = render(&scene, &accel, &options, &Observer::default()).expect("not interrupted");
        let mut rays = 0;
        for y in 0..16 {
            for x in 0..24 {
                if (x + 3 * y) % 5 != 0 {
                    continue;
                }
                let (radiance, truncated, tree) = with(&accel, &scene, &options, (x, y));
                let at = (y * 24 + x) as usize;
                assert_eq!(radiance, picture.film.pixels[at], "{name} ({x}, {y}): radiance");
                assert_eq!(truncated, picture.truncated.pixels[at], "{name} ({x}, {y}): truncated weight");
                let n = samples * samples;
                let shares = fixed_sum(tree.shares().map(|share| share.radiance), n);
                assert_eq!(shares, radiance, "{name} ({x}, {y}): sum of the shares");
                let cut = fixed_sum(tree.events.iter().flat_map(|e| &e.cut).map(|c| c.weight), n);
                for (a, b) in cut.iter().zip(truncated) {
                    assert!((a - b).abs() <= 1e-6 * b, "{name} ({x}, {y}): {cut:?} cut off, not {truncated:?}");
                }
                assert_eq!(tree.roots().len(), n as usize);
                rays += tree.events.len();
            }
        }
        println!("{name}: {rays} rays");
    }
}

#[test]
fn the_f64_renderers_rays_add_up_to_its_pixel() {
    for name in ["glass.toml", "absorption.toml", "illum.toml"] {
        let scene = small(name, 1);
        let picture = reference::render(&scene, &Options::default(), &Observer::default()).expect("not interrupted");
        let prepared = Prepared::with(&scene, &Options::default());
        for (x, y) in [(3, 4), (12, 8), (10, 9), (20, 11)] {
            let (tally, tree) = prepared.recorded(x, y);
            assert_eq!(tally.radiance.as_vec3().to_array(), picture.film.pixels[(y * 24 + x) as usize]);
            let sum: DVec3 = tree.shares().map(|share| share.radiance).sum();
            assert!((sum - tally.radiance).abs().max_element() <= 1e-12 * tally.radiance.max_element());
            let cut: DVec3 = tree.events.iter().flat_map(|e| &e.cut).map(|c| c.weight).sum();
            assert!((cut - tally.truncated).abs().max_element() <= 1e-12);
        }
    }
}

/// A ball of glass of index 1.5 in front of the eye, nothing else, seen through its middle.
fn ball() -> Scene {
    let mut scene = scenes::empty(1.0);
    scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
    scene.settings = Settings { width: 1, height: 1, max_depth: 2, ..scene.settings };
    let glass = scenes::glass(&mut scene, 1.5, 0, Rgb::new(0.0, 0.5, 0.0));
    scenes::sphere(&mut scene, Vec3::ZERO, 1.0, glass);
    scene
}

fn both(scene: &Scene) -> [Tree; 2] {
    let options = Options::default();
    [native(scene, &options, (0, 0)).2, Prepared::with(scene, &options).recorded(0, 0).1]
}

fn only(tree: &Tree, kind: RayKind, depth: u32) -> Event {
    let found: Vec<&Event> = tree.events.iter().filter(|e| e.kind == kind && e.depth == depth).collect();
    assert_eq!(found.len(), 1, "{} of depth {depth}", kind.name());
    found[0].clone()
}

#[test]
fn a_ball_of_glass_head_on_is_what_the_textbook_says() {
    for tree in both(&ball()) {
        let near = |a: DVec3, b: DVec3| assert!((a - b).abs().max_element() < 1e-6, "{a}, not {b}");
        let camera = only(&tree, RayKind::Camera, 0);
        assert!((camera.t - 4.0).abs() < 1e-6 && camera.media.is_empty());
        let Met::Surface { object: 0, front: true, point, cos_i, .. } = camera.met else { panic!("{:?}", camera.met) };
        near(point, DVec3::Z);
        assert!((cos_i - 1.0).abs() < 1e-6);
        let split = camera.split.expect("a boundary");
        assert_eq!(split.indices, Some((1.0, 1.5)));
        near(split.reflected, DVec3::splat(0.04));
        near(split.transmitted, DVec3::splat(0.96));
        near(split.sum(), DVec3::ONE);
        assert!((split.cos_t.expect("not total") - 1.0).abs() < 1e-6);

        let inside = only(&tree, RayKind::Transmitted, 1);
        assert_eq!(inside.media, [1]);
        assert!((inside.t - 2.0).abs() < 1e-6);
        // exp(-0.5 * 2) of the green is left.
        near(inside.arrived, DVec3::new(0.96, 0.96 * (-1.0_f64).exp(), 0.96));
        // What was mirrored at once sees the environment.
        let mirrored = only(&tree, RayKind::Reflected, 1);
        assert_eq!(mirrored.met, Met::Nothing);
        assert_eq!(mirrored.shares[0].source, Source::Environment);
        near(mirrored.shares[0].radiance, DVec3::splat(0.04));
        // At depth 2 the limit ends what would go on from inside: of the reflected ray both of its rays.
        let again = only(&tree, RayKind::Reflected, 2);
        assert_eq!(again.cut.len(), 2);
        assert!(again.cut.iter().all(|cut| cut.too_deep));
        let lost: DVec3 = again.cut.iter().map(|cut| cut.weight).sum();
        near(lost, again.arrived);
        assert_eq!(tree.events.len(), 5);
    }
}

#[test]
fn a_blocked_lamp_names_what_blocks_it_and_a_free_one_what_it_adds() {
    let mut scene = scenes::empty(0.0);
    scene.settings = Settings { width: 1, height: 1, ..scene.settings };
    scene.camera.eye = Vec3::new(0.0, 4.0, 0.01);
    let lit = scenes::material(
        &mut scene,
        Material {
            highlight: Some(Highlight { colour: Rgb::splat(0.2), exponent: 10.0, model: HighlightModel::Phong }),
            ..Material::default()
        },
    );
    let opaque = scenes::material(&mut scene, scenes::bare(Interface::Opaque));
    scenes::plane(&mut scene, Vec3::ZERO, Vec3::Y, lit);
    scenes::sphere(&mut scene, Vec3::new(3.0, 3.0, 0.0), 0.5, opaque);
    let lamp = |position| Light {
        name: String::from("lamp"),
        kind: LightKind::Point { position },
        intensity: Rgb::ONE,
        falloff: Falloff::None,
        shadows: true,
    };
    // Behind the ball, free, and below the plane.
    scene.lights = [Vec3::new(6.0, 6.0, 0.0), Vec3::new(-3.0, 3.0, 0.0), Vec3::new(0.0, -3.0, 0.0)].map(lamp).to_vec();
    for tree in both(&scene) {
        let camera = only(&tree, RayKind::Camera, 0);
        let lights: Vec<_> = camera.shares.iter().filter(|s| matches!(s.source, Source::Light(_))).collect();
        assert_eq!(lights.len(), 2, "{lights:?}");
        assert_eq!((lights[0].source, lights[0].blocker), (Source::Light(0), Some(1)));
        assert_eq!(lights[0].radiance, DVec3::ZERO);
        assert!(lights[0].unshadowed.x > 0.3);
        assert_eq!((lights[1].source, lights[1].blocker), (Source::Light(1), None));
        assert_eq!(lights[1].radiance, lights[1].unshadowed);
        // Lambert at 45 degrees on an albedo of 1/2.
        assert!((lights[1].radiance.x - 0.5 * 0.5_f64.sqrt()).abs() < 0.01, "{}", lights[1].radiance);
    }
}

#[test]
fn reflected_transmitted_and_absorbed_make_one_at_every_surface() {
    for name in ["glass.toml", "goblet.toml", "illum.toml", "hall.toml"] {
        let scene = small(name, 1);
        for (x, y) in [(8, 8), (12, 8), (15, 10), (4, 12)] {
            let (_, _, narrow) = native(&scene, &Options::default(), (x, y));
            let (_, wide) = Prepared::with(&scene, &Options::default()).recorded(x, y);
            for (tree, bound) in [(narrow, 3e-7), (wide, 2e-15)] {
                for split in tree.events.iter().filter_map(|e| e.split) {
                    assert!((split.sum() - DVec3::ONE).abs().max_element() <= bound, "{name}: {split:?}");
                }
            }
        }
    }
}

fn vitrum(args: &str) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("vitrum").expect("it was built");
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args.split_whitespace()).assert()
}

fn stdout(args: &str) -> String {
    String::from_utf8(vitrum(args).success().get_output().stdout.clone()).expect("text")
}

#[test]
fn the_text_fits_eighty_columns_and_names_what_was_met() {
    let text = stdout("pixel scenes/glass.toml 12 8 --width 24 --height 16 --samples 1 --least 0 --backend native");
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    for word in ["reference f64", "R + T + A", "angle out", "camera", "conditioned", "ulp"] {
        assert!(text.contains(word), "no `{word}` in\n{text}");
    }
}

#[test]
fn the_json_holds_every_ray_and_the_drawing_a_box_for_each_that_shows() {
    let folder = tempfile::tempdir().expect("a folder");
    let svg = folder.path().join("tree.svg");
    let line = "pixel scenes/glass.toml 12 8 --width 24 --height 16 --samples 1 --backend native --depth 3";
    let json: serde_json::Value = serde_json::from_str(&stdout(&format!("{line} --json"))).expect("JSON");
    let rays = json["rays"].as_array().expect("a list");
    assert!(!rays.is_empty() && rays[0]["parent"].is_null());
    for (i, ray) in rays.iter().enumerate().skip(1) {
        assert!(ray["parent"].as_u64().expect("a place") < i as u64);
    }
    assert_eq!(json["pixel"].as_array().map(Vec::len).expect("a list") % 2, 0);
    stdout(&format!("{line} --least 0 --svg {}", svg.display()));
    let drawn = std::fs::read_to_string(&svg).expect("written");
    assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
    // One more for the paper.
    assert_eq!(drawn.matches("<rect").count(), rays.len() + 1);
    assert_eq!(drawn.matches("<path").count(), rays.len() - 1);
}

#[test]
fn a_pixel_or_sample_that_is_not_there_is_one_line_with_the_cure() {
    for (args, words) in [
        ("pixel scenes/glass.toml 24 0 --width 24 --height 16", "X is 0 to 23"),
        ("pixel scenes/glass.toml 0 16 --width 24 --height 16", "Y is 0 to 15"),
        ("pixel scenes/glass.toml 0 0 --samples 2 --sample 5", "a pixel has 4"),
        ("pixel scenes/glass.toml 0 0 --backend reference", "always shown"),
        ("pixel scenes/none.toml 0 0", "none.toml"),
    ] {
        let out = vitrum(args).failure().get_output().clone();
        let error = String::from_utf8(out.stderr).expect("text");
        assert!(error.contains(words) && error.lines().count() == 1, "{args}: {error}");
        assert!(out.stdout.is_empty());
    }
}

#[test]
fn a_render_and_its_pixels_agree_on_what_is_cut_by_weight() {
    let mut scene = ball();
    scene.settings = Settings { max_depth: 64, cutoff: 0.01, ..scene.settings };
    let accel = backends::native(&scene.geometry);
    let picture = render(&scene, &accel, &Options::default(), &Observer::default()).expect("not interrupted");
    let (_, truncated, tree) = native(&scene, &Options::default(), (0, 0));
    assert_eq!(truncated, picture.truncated.pixels[0]);
    let cuts: Vec<_> = tree.events.iter().flat_map(|e| &e.cut).collect();
    assert!(
        !cuts.is_empty() && cuts.iter().all(|cut| cut.too_light && !cut.too_deep && cut.weight.max_element() < 0.01)
    );
}
