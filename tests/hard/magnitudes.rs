//! Planes and spheres of any height, size and distance, in whole pictures: what a hair's breadth, the scale of a scene or
//! the camera's distance must not change.

use glam::{DVec3, Vec3};
use vitrum::accel::Backend;
use vitrum::geometry::{Plane, Shape, Sphere};
use vitrum::image::Film;
use vitrum::render::{Options, reference};
use vitrum::scene::{
    Camera, Colour, Environment, Falloff, Interface, Light, LightKind, Material, MirrorSource, Projection, Rgb, Scene,
};

use crate::support::{Rng, backends, scenes};

/// The pictures of a scene by the native path, by the `f64` renderer, and by Embree where it is built in and found.
fn pictures(scene: &Scene) -> Vec<(&'static str, Film)> {
    let options = Options::default();
    let native = scenes::native(scene, &options).film;
    let arbiter = reference::render(scene, &options, &Default::default()).expect("nobody interrupts a test").film;
    let mut pictures = vec![("native", native), ("f64", arbiter)];
    if let Some(embree) = backends::embree(Backend::Embree, &scene.geometry) {
        let outcome = vitrum::render::render(scene, &embree, &options, &Default::default());
        pictures.push(("embree", outcome.expect("nobody interrupts a test").film));
    }
    pictures
}

/// Each picture but the second, that of the `f64` renderer, with its pixels beyond 2e-3 of that one.
fn against_f64(pictures: &[(&'static str, Film)]) -> Vec<(&'static str, usize, f32)> {
    let other = pictures.iter().filter(|(name, _)| *name != "f64");
    other.map(|(name, film)| (*name, off(film, &pictures[1].1, 2e-3))).map(|(n, (k, most))| (n, k, most)).collect()
}

/// Pixels of which a channel differs by more than `limit`, and the largest difference.
fn off(a: &Film, b: &Film, limit: f32) -> (usize, f32) {
    let largest = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max);
    let all: Vec<f32> = a.pixels.iter().zip(&b.pixels).map(largest).collect();
    (all.iter().filter(|d| **d > limit).count(), all.iter().copied().fold(0.0, f32::max))
}

fn gradient(scene: &mut Scene) {
    let (nadir, horizon, zenith) = (Rgb::new(0.1, 0.2, 0.3), Rgb::new(1.0, 0.9, 0.8), Rgb::new(0.3, 0.4, 1.0));
    scene.environment = Environment::Gradient { nadir, horizon, zenith };
}

/// A glass ball half sunk into a matt floor under a lamp.
fn ball_in_a_floor(point: Vec3, normal: Vec3) -> Scene {
    let mut scene = scenes::empty(0.0);
    gradient(&mut scene);
    scene.camera.eye = Vec3::new(0.0, 1.0, 5.0);
    scene.camera.projection = Projection::Pinhole { vfov: 45.0 };
    let grey = Material { diffuse: Colour::Constant(Rgb::splat(0.5)), ..Material::default() };
    let grey = scenes::material(&mut scene, grey);
    let crown = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
    scenes::sphere(&mut scene, Vec3::ZERO, 1.0, crown);
    scenes::plane(&mut scene, point, normal, grey);
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Point { position: Vec3::new(3.0, 5.0, 3.0) },
        intensity: Rgb::splat(40.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    (scene.settings.max_depth, scene.settings.cutoff) = (12, 1e-4);
    scene
}

/// SI-09: a floor that is a hair off the origin, as `0.1 + 0.2 - 0.3` is, makes the picture of the floor at the origin.
#[test]
fn a_plane_a_hair_off_the_origin_is_not_in_its_own_shadow() {
    for normal in [Vec3::Y, Vec3::new(0.2, 1.0, 0.3).normalize()] {
        let at_origin = pictures(&ball_in_a_floor(Vec3::ZERO, normal));
        let mut unlit = ball_in_a_floor(Vec3::ZERO, normal);
        unlit.lights.clear();
        let (lit, _) = off(&at_origin[0].1, &scenes::native(&unlit, &Options::default()).film, 0.02);
        assert!(lit > 300, "the lamp lights {lit} pixels of the floor");
        for (name, count, most) in against_f64(&at_origin) {
            assert!(count <= 2, "{name} and f64, {normal}: {count} pixels, {most} at most");
        }
        for height in [1e-45, 1e-40, -1e-30, 1e-18, 5.55e-17, -5.55e-17, 1e-14, -1e-12, 1e-9] {
            for ((name, film), (_, want)) in pictures(&ball_in_a_floor(normal * height, normal)).iter().zip(&at_origin)
            {
                let (count, most) = off(film, want, 5e-4);
                assert_eq!(count, 0, "{name}, {height:e} along {normal}: {most} off at most");
            }
        }
    }
}

/// A floor that the ball stands clear of, given by a point far aside, tilted or not.
#[test]
fn a_plane_below_the_origin_is_lit_wherever_it_is_anchored() {
    let shaded = ball_in_a_floor(Vec3::new(0.0, -1.0, 0.0), Vec3::Y);
    for (name, count, most) in against_f64(&pictures(&shaded)) {
        assert!(count <= 2, "{name} and f64: {count} pixels, {most} at most");
    }
    for normal in [Vec3::Y, Vec3::new(-0.1, 1.0, 0.25).normalize()] {
        for aside in [0.0, 10.0, -300.0] {
            let along = normal.cross(Vec3::new(0.3, 0.1, 1.0)).normalize() * aside;
            let mut scene = ball_in_a_floor(normal * -1.5 + along, normal);
            let shaded = scenes::native(&scene, &Options::default()).film;
            // The ball's shadow aside, shadows change nothing.
            (scene.geometry, scene.objects) = (scene.geometry.split_off(1), scene.objects.split_off(1));
            let alone = scenes::native(&scene, &Options::default()).film;
            scene.lights[0].shadows = false;
            assert!(alone == scenes::native(&scene, &Options::default()).film, "{normal}, {aside}: in its own shadow");
            assert!(off(&shaded, &alone, 1e-3).0 > 10, "the ball is seen");
        }
    }
}

/// A glass ball of radius 1 as far away as asked, filling the picture.
fn ball_from_afar(distance: f64, towards: DVec3, orthographic: bool) -> Scene {
    let mut scene = scenes::empty(0.0);
    gradient(&mut scene);
    let vfov = (2.0 * (1.2 / distance).atan().to_degrees()) as f32;
    scene.camera = Camera {
        eye: (towards * distance).as_vec3(),
        target: Vec3::ZERO,
        up: if towards.y == 0.0 { Vec3::Y } else { Vec3::X },
        projection: if orthographic { Projection::Orthographic { height: 2.4 } } else { Projection::Pinhole { vfov } },
        medium: None,
    };
    (scene.settings.width, scene.settings.height) = (64, 48);
    (scene.settings.max_depth, scene.settings.cutoff) = (10, 1e-3);
    let crown = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
    scenes::sphere(&mut scene, Vec3::ZERO, 1.0, crown);
    scene
}

/// SP-01: along an axis rays from any distance keep their digits, and so does what they see.
#[test]
fn a_sphere_seen_from_a_million_radii_away_is_as_right_as_one_close_by() {
    for towards in [DVec3::Z, -DVec3::X, DVec3::Y] {
        for distance in [10.0, 1e3, 1e5, 1e6] {
            for orthographic in [true, false] {
                let pictures = pictures(&ball_from_afar(distance, towards, orthographic));
                let native = &pictures[0].1;
                let seen = native.pixels.iter().filter(|p| (p[0] - native.at(0, 0)[0]).abs() > 1e-3).count();
                assert!(seen > 500, "the ball is seen from {distance} along {towards}: {seen} pixels");
                for (name, count, most) in against_f64(&pictures) {
                    let from = format!("from {distance} along {towards}, orthographic {orthographic}");
                    assert_eq!(count, 0, "{name}, {from}: {most} at most");
                }
            }
        }
    }
}

/// The same scene at another scale, a power of two, so that nothing rounds anew.
fn scaled(scene: &Scene, scale: f32) -> Scene {
    let mut scene = scene.clone();
    for geometry in &mut scene.geometry {
        geometry.shape = match &geometry.shape {
            Shape::Sphere(s) => Shape::Sphere(Sphere { centre: s.centre * scale, radius: s.radius * scale }),
            Shape::Plane(p) => Shape::Plane(Plane { point: p.point * scale, ..*p }),
            Shape::Mesh(_) => unreachable!("there are none"),
        };
    }
    scene.camera.eye *= scale;
    scene.camera.target *= scale;
    if let Projection::Orthographic { height } = &mut scene.camera.projection {
        *height *= scale;
    }
    scene
}

/// Spheres of 1e-10, 1e-20, 1e-30 and 1e15 make the picture of a sphere of 1, to the last bit.
#[test]
fn the_scale_of_a_scene_of_spheres_and_planes_changes_no_bit() {
    let mut rng = Rng::new(61);
    for orthographic in [false, true] {
        let mut scene = ball_from_afar(7.0, DVec3::new(0.6, 0.48, 0.64), orthographic);
        scene.settings.max_depth = 8;
        let water = scenes::glass(&mut scene, 1.33, 1, Rgb::ZERO);
        scenes::sphere(&mut scene, rng.point() * 0.3, 0.4, water);
        let mirror = Interface::Mirror { reflectance: Rgb::splat(0.8), source: MirrorSource::Traced };
        let mirror = scenes::material(&mut scene, scenes::bare(mirror));
        scenes::sphere(&mut scene, Vec3::new(0.2, -0.8, 1.5), 0.3, mirror);
        scenes::plane(&mut scene, Vec3::new(0.3, -1.25, 0.1), Vec3::new(0.1, 1.0, 0.05).normalize(), mirror);
        let want = scenes::native(&scene, &Options::default());
        assert_eq!(want.unmatched_exits, 0);
        for exponent in [-100, -67, -34, -10, 10, 50] {
            let got = scenes::native(&scaled(&scene, 2_f32.powi(exponent)), &Options::default());
            let (count, most) = off(&got.film, &want.film, 0.0);
            assert_eq!(count, 0, "2^{exponent}, orthographic {orthographic}: {most} off at most");
        }
    }
}
