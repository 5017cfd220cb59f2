//! Triangle tests and reciprocals on whole pictures: one walk, which finds what the native path finds.

use glam::Vec3;
use vitrum::accel::native::Native;
use vitrum::accel::walk::Walk;
use vitrum::accel::{BuildQuality, Unbounded};
use vitrum::geometry::triangle_test::TriangleModel;
use vitrum::geometry::{Geometry, GeometryMask, Ray, Shape};
use vitrum::render::{Observer, Options, render};
use vitrum::scene::{Rgb, Scene};
use vitrum::simd::ReciprocalModel;

use crate::support::contract::{self, bits};
use crate::support::{Rng, aim, scenes, shapes};

fn walk(geometry: &[Geometry], test: TriangleModel) -> Walk {
    Walk::build(geometry, BuildQuality::Default, test, ReciprocalModel::Exact)
}

#[test]
fn the_watertight_walk_keeps_the_contract_and_gives_the_bits_of_native() {
    contract::holds(|g| walk(g, TriangleModel::Watertight), true);
    let mut rng = Rng::new(71);
    let ball = shapes::closed_sphere(24, 0.2, 1.0, Vec3::ZERO);
    let seams = aim::at_seams(&ball, Vec3::ZERO, 0.5, 2000, &mut rng);
    let geometry = [
        shapes::masked(ball, GeometryMask::OPAQUE),
        shapes::masked(shapes::soup(400, 0.3, &mut rng), GeometryMask::TRANSMISSIVE),
        shapes::ball(Vec3::X, 0.3, GeometryMask::OPAQUE),
    ];
    let anywhere = (0..4000).map(|_| Ray::new(rng.point() * 3.0, rng.direction()));
    let rays: Vec<Ray> = seams.into_iter().chain(anywhere).collect();
    let (own, native) = (walk(&geometry, TriangleModel::Watertight), Native::build(&geometry));
    let pairs = contract::closest(&own, &rays).into_iter().zip(contract::closest(&native, &rays));
    assert_eq!(pairs.filter(|(a, b)| bits(a) != bits(b)).count(), 0);
    assert_eq!(contract::occluded(&own, &rays), contract::occluded(&native, &rays));
}

/// A box of glass before a ball of triangles, on a plane.
fn still_life() -> Scene {
    let mut scene = scenes::empty(0.7);
    let clear = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
    let dense = scenes::glass(&mut scene, 2.4, 1, Rgb::ZERO);
    scenes::cuboid(&mut scene, Vec3::new(-1.0, -0.8, 0.4), Vec3::new(0.3, 0.5, 1.1), clear);
    scenes::add(&mut scene, Shape::Mesh(shapes::closed_sphere(12, 0.1, 0.7, Vec3::new(0.4, 0.0, -0.4))), dense);
    scenes::plane(&mut scene, Vec3::NEG_Y, Vec3::Y, clear);
    scene.settings.cutoff = 1.0 / 256.0;
    scene
}

fn picture(scene: &Scene, test: TriangleModel) -> Vec<[f32; 3]> {
    let accel = Unbounded::new(walk(&scene.geometry, test), &scene.geometry);
    let outcome = render(scene, &accel, &Options::default(), &Observer::default()).expect("nobody interrupts a test");
    assert_eq!((outcome.non_finite, outcome.clamped), (0, 0), "{test:?}");
    outcome.film.pixels
}

#[test]
fn a_picture_by_the_watertight_walk_is_natives_and_the_other_tests_differ_by_roundings() {
    let scene = still_life();
    let native = scenes::native(&scene, &Options::default()).film.pixels;
    assert!(picture(&scene, TriangleModel::Watertight) == native, "to the bit");
    let apart = |pixels: &[[f32; 3]]| {
        let off = |(p, q): (&[f32; 3], &[f32; 3])| p.iter().zip(q).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let mut all: Vec<f32> = pixels.iter().zip(&native).map(off).collect();
        all.sort_by(f32::total_cmp);
        all[all.len() / 2]
    };
    for test in TriangleModel::ALL {
        let off = apart(&picture(&scene, test));
        assert!(off < 1e-5, "{test:?}: {off} in the median");
    }
}

#[test]
fn a_newton_step_leaves_t_where_it_is_and_the_estimate_alone_does_not() {
    let mut rng = Rng::new(73);
    let geometry = [shapes::masked(shapes::closed_sphere(12, 0.1, 1.0, Vec3::ZERO), GeometryMask::OPAQUE)];
    let rays: Vec<Ray> = (0..2000)
        .map(|_| {
            let origin = rng.direction() * 4.0;
            Ray::new(origin, rng.point() * 0.4 - origin)
        })
        .collect();
    let hits = |reciprocal| {
        contract::closest(&Walk::build(&geometry, BuildQuality::Default, TriangleModel::Watertight, reciprocal), &rays)
    };
    let truth = hits(ReciprocalModel::Exact);
    assert!(truth.iter().all(|hit| hit.is_hit()));
    // The median, since estimates also lose hits, or find the far side.
    let off = |reciprocal| {
        let pairs = hits(reciprocal).into_iter().zip(&truth);
        let mut off: Vec<f32> = pairs.filter(|(a, _)| a.is_hit()).map(|(a, b)| (a.t - b.t).abs() / b.t).collect();
        off.sort_by(f32::total_cmp);
        off[off.len() / 2]
    };
    let [estimate, newton, exact] = ReciprocalModel::ALL.map(off);
    assert!(exact == 0.0 && newton < 1e-6, "{exact} {newton}");
    if cfg!(target_arch = "x86_64") {
        assert!(estimate > 1e-6 && estimate < 1e-2, "{estimate}");
    }
}

#[test]
fn aimed_rays_slip_past_the_tests_that_leak_and_fall_to_f64_in_the_certified_one() {
    let mut rng = Rng::new(72);
    let ball = shapes::closed_sphere(20, 0.1, 1.0, Vec3::ZERO);
    let seams: Vec<Ray> = (0..4000)
        .map(|_| {
            let [a, b, _] = ball.corners(rng.below(ball.triangles.len()));
            let origin = rng.direction() * 0.4;
            Ray::new(origin, a + (b - a) * rng.unit() - origin)
        })
        .collect();
    let anywhere: Vec<Ray> = (0..4000).map(|_| Ray::new(rng.direction() * 0.4, rng.direction())).collect();
    let geometry = [shapes::masked(ball, GeometryMask::OPAQUE)];
    let lost = |test: TriangleModel, rays: &[Ray]| {
        let of = walk(&geometry, test);
        let hits = contract::closest(&of, rays);
        (hits.iter().filter(|hit| !hit.is_hit()).count(), of.test_counts())
    };
    for test in [TriangleModel::Watertight, TriangleModel::Certified] {
        assert_eq!(lost(test, &seams).0, 0, "{test:?}");
    }
    // A sixth slips past one triangle and the next, where no other is behind (tests/formulas.rs).
    for test in [TriangleModel::MollerTrumbore, TriangleModel::PlaneArea] {
        assert!(lost(test, &seams).0 > 80 && lost(test, &anywhere).0 == 0, "{test:?}: {:?}", lost(test, &seams));
    }
    let (aimed, random) = (lost(TriangleModel::Certified, &seams).1, lost(TriangleModel::Certified, &anywhere).1);
    assert!(aimed.tested > 10_000 && aimed.share() > 0.02 && random.share() < 1e-3, "{aimed:?} {random:?}");
    assert_eq!(lost(TriangleModel::MollerTrumbore, &seams).1.settled, 0);
}

#[cfg(feature = "cli")]
#[test]
fn the_walk_is_a_choice_of_the_native_path_and_told_in_the_summary() {
    use assert_cmd::Command;
    use predicates::prelude::*;
    use predicates::str::contains;

    let folder = tempfile::tempdir().unwrap();
    let scene = super::command::SCENE
        .replace("shape = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1", "shape = \"torus\"\nmajor = 0.7\nminor = 0.3");
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let render = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("vitrum").unwrap();
        command.current_dir(&folder).args(["render", "scene.toml", "-o", "out.png"]).args(arguments).assert()
    };
    let done = render(&["--triangles", "certified", "--reciprocal", "newton", "--json"]).success();
    let json: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    assert_eq!((&json["walk"]["triangles"], &json["backend"]), (&"certified".into(), &"native".into()));
    let [tested, settled] = ["tested", "settled"].map(|key| json["walk"][key].as_u64().unwrap());
    assert!(tested > 100 && settled < tested, "{settled} of {tested}");
    done.stderr(contains("certified, reciprocal newton").and(contains("settled in f64")));
    render(&["--triangles", "woop", "--quiet"]).success();
    for backend in ["embree", "embree-fast", "reference"] {
        render(&["--triangles", "pluecker", "--backend", backend]).code(2).stderr(contains("--backend"));
        render(&["--reciprocal", "exact", "--backend", backend]).code(2).stderr(contains("--reciprocal"));
    }
    render(&["--max-error", "0.1", "--no-absorption"]).code(2).stderr(contains("--no-absorption"));
}
