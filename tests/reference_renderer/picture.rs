//! Whole pictures: camera, samples, counts, threads, interruption.

use std::sync::atomic::Ordering::Relaxed;

use glam::{DVec3, Vec3};
use vitrum::Error;
use vitrum::optics::FresnelModel;
use vitrum::render::reference::{Prepared, render};
use vitrum::render::{Observer, Options, RayKind};
use vitrum::scene::{Camera, Colour, Environment, Falloff, LightKind, Material, Projection, Rgb, Scene};

use super::build::*;

fn options(threads: usize) -> Options {
    Options { threads, ..Options::default() }
}

/// Looking along -z from z = 5, 40 by 20 pixels.
fn view(projection: Projection) -> Scene {
    let mut scene = empty();
    scene.camera = Camera { eye: Vec3::Z * 5.0, target: Vec3::ZERO, up: Vec3::Y, projection, medium: None };
    scene.settings.width = 40;
    scene.settings.height = 20;
    scene
}

#[test]
fn a_pinhole_spans_its_vertical_angle_and_an_orthographic_camera_its_height() {
    let scene = view(Projection::Pinhole { vfov: 90.0 });
    let ray = |scene: &Scene, x, y| Prepared::new(scene, FresnelModel::Exact).camera_ray(x, y);
    for (x, y, want) in
        [(20.0, 10.0, [0.0, 0.0]), (20.0, 0.0, [0.0, 1.0]), (40.0, 20.0, [2.0, -1.0]), (0.5, 9.5, [-1.95, 0.05])]
    {
        let (origin, dir) = ray(&scene, x, y);
        assert_eq!(origin, DVec3::Z * 5.0);
        let want = DVec3::new(want[0], want[1], -1.0).normalize();
        assert!((dir - want).length() < 1e-15, "{dir} {want}");
    }
    let scene = view(Projection::Orthographic { height: 4.0 });
    let (origin, dir) = ray(&scene, 40.0, 20.0);
    assert_eq!((origin, dir), (DVec3::new(4.0, -2.0, 5.0), -DVec3::Z));
}

#[test]
fn samples_are_a_regular_grid_at_sub_pixel_centres() {
    let mut scene = view(Projection::Orthographic { height: 20.0 });
    // One pixel is one unit; the edge at x = -0.6 leaves the lower 2 of 5 columns of samples dark in pixel 19.
    let edge = block(Vec3::new(-0.6, -90.0, -1.0), Vec3::new(90.0, 90.0, 0.0));
    put(&mut scene, edge, emitter(1.0));
    for (samples, want) in [(1, 1.0), (2, 0.5), (5, 0.6)] {
        scene.settings.samples = samples;
        let outcome = render(&scene, &options(1), &Observer::default()).unwrap();
        assert_eq!(outcome.film.at(18, 3), [0.0; 3]);
        close(f64::from(outcome.film.at(19, 3)[0]), want, 1e-7);
        assert_eq!(outcome.film.at(20, 3), [1.0; 3]);
        assert_eq!(outcome.rays.of(RayKind::Camera), u64::from(800 * samples * samples));
    }
}

fn still_life() -> Scene {
    let mut scene = view(Projection::Pinhole { vfov: 50.0 });
    scene.settings.cutoff = 1e-3;
    scene.settings.max_depth = 8;
    scene.environment = Environment::Gradient { nadir: Rgb::ZERO, horizon: Rgb::ONE, zenith: Rgb::new(0.2, 0.4, 1.0) };
    let glass = medium(&mut scene, 1.5, 0.1, 0);
    put(&mut scene, sphere(0.0, 0.0, 0.0, 1.0), dielectric(glass));
    put(&mut scene, torus(2.0, 0.3, 16, true), dielectric(glass));
    let diffuse = Colour::Checker { even: Rgb::ONE, odd: Rgb::ZERO, size: 0.5, offset: Vec3::Y * 0.25 };
    put(&mut scene, plane(Vec3::Y * -1.0, Vec3::Y), Material { diffuse, ..Material::default() });
    scene.lights.push(light(LightKind::Point { position: Vec3::new(2.0, 5.0, 3.0) }, Falloff::None));
    scene
}

#[test]
fn threads_change_no_byte_and_every_pixel_is_reported() {
    let scene = still_life();
    let one = render(&scene, &options(1), &Observer::default()).unwrap();
    assert_eq!((one.non_finite, one.clamped, one.unmatched_exits), (0, 0, 0));
    assert!(RayKind::ALL.iter().all(|&kind| one.rays.of(kind) > 100), "{:?}", one.rays);
    assert!(one.rays.by_depth.len() <= 9);
    for threads in [2, 3, 8] {
        let observer = Observer::default();
        let many = render(&scene, &options(threads), &observer).unwrap();
        assert_eq!((&many.film, &many.truncated, &many.rays), (&one.film, &one.truncated, &one.rays));
        assert_eq!(observer.pixels_done.load(Relaxed), 800);
    }
}

#[test]
fn the_film_holds_what_single_rays_give() {
    let scene = still_life();
    let outcome = render(&scene, &options(2), &Observer::default()).unwrap();
    let prepared = Prepared::new(&scene, FresnelModel::Exact);
    for (x, y) in [(0, 0), (20, 10), (13, 17), (39, 19)] {
        let want = prepared.radiance_at(f64::from(x) + 0.5, f64::from(y) + 0.5).map(|c| c as f32);
        assert_eq!(outcome.film.at(x, y), want);
    }
}

#[test]
fn a_picture_that_is_stopped_is_no_picture() {
    let observer = Observer::default();
    observer.stop.store(true, Relaxed);
    assert!(matches!(render(&still_life(), &options(2), &observer), Err(Error::Interrupted)));
    assert_eq!(observer.pixels_done.load(Relaxed), 0);
}

#[test]
fn an_edge_pixel_changes_when_its_ray_moves_by_a_few_ulps_and_an_inner_one_does_not() {
    let mut scene = empty();
    put(&mut scene, block(Vec3::new(-1.0, -1.0, -1.0), Vec3::new(0.5, 1.0, 0.0)), emitter(1.0));
    let prepared = Prepared::new(&scene, FresnelModel::Exact);
    let step = 2.0 * f64::from(f32::EPSILON);
    let spread = |x: f64| {
        let at = |x: f64| prepared.radiance_along(DVec3::new(x, 0.25, 5.0), -DVec3::Z)[0];
        (at(x + step) - at(x - step)).abs()
    };
    close(spread(0.5), 1.0, 0.0);
    close(spread(0.4), 0.0, 0.0);
}

#[test]
fn what_is_not_finite_is_counted_and_what_is_too_bright_is_clamped() {
    let mut scene = view(Projection::Pinhole { vfov: 90.0 });
    scene.environment = Environment::Constant(Rgb::new(1.0, f32::NAN, f32::INFINITY));
    let outcome = render(&scene, &options(1), &Observer::default()).unwrap();
    assert_eq!((outcome.non_finite, outcome.film.at(3, 3)), (800, [0.0; 3]));
    scene.environment = Environment::Constant(Rgb::splat(1e30));
    let outcome = render(&scene, &options(1), &Observer::default()).unwrap();
    assert_eq!((outcome.clamped, outcome.film.at(3, 3)), (800, [(1_u64 << 62) as f32; 3]));
}

#[test]
fn a_camera_that_looks_nowhere_and_a_film_without_rows_do_no_harm() {
    let mut scene = still_life();
    scene.camera.target = scene.camera.eye;
    let outcome = render(&scene, &options(1), &Observer::default()).unwrap();
    assert_eq!(outcome.film.at(3, 3), [0.0; 3]);
    scene.settings.height = 0;
    assert!(render(&scene, &options(1), &Observer::default()).unwrap().film.pixels.is_empty());
}
