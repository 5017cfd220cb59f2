//! The arbiter keeps the promise of every accelerator, never finds the native one wrong, and pictures the same scene.

use crate::support;

use glam::Vec3;
use support::{Rng, backends, contract, scenes, shapes};
use vitrum::accel::Intersector;
use vitrum::accel::reference::{Reference, Verdict};
use vitrum::geometry::{Geometry, GeometryMask, Ray, Shape};
use vitrum::render::{Observer, Options, reference};
use vitrum::scene::{Falloff, Light, LightKind, Material, Rgb};

#[test]
fn the_arbiter_keeps_the_contract() {
    contract::holds(Reference::build, true);
}

/// Rays at `world`, two thirds of them aimed at corners and at points of edges.
fn rays(world: &[Geometry], count: usize) -> Vec<Ray> {
    let mut rng = Rng::new(17);
    let corners: Vec<[Vec3; 3]> = world
        .iter()
        .filter_map(|g| if let Shape::Mesh(m) = &g.shape { Some(m) } else { None })
        .flat_map(|m| (0..m.triangles.len()).map(|i| m.corners(i)))
        .collect();
    (0..count)
        .map(|k| {
            let [a, b, _] = corners[rng.below(corners.len())];
            let target = [a, a.lerp(b, rng.unit()), rng.point() * 2.0][k % 3];
            let origin = rng.point() * 6.0;
            Ray::new(origin, target - origin)
        })
        .collect()
}

#[test]
fn the_native_path_is_never_wrong_on_balls_spheres_and_planes() {
    let world = vec![
        shapes::masked(shapes::closed_sphere(16, 0.2, 1.0, Vec3::ZERO), GeometryMask::OPAQUE),
        shapes::masked(shapes::closed_sphere(9, 0.0, 0.5, Vec3::new(1.5, 0.5, -0.5)), GeometryMask::OPAQUE),
        shapes::ball(Vec3::new(-1.5, 0.2, 0.4), 0.7, GeometryMask::OPAQUE),
        shapes::plane(Vec3::new(0.0, -2.0, 0.0), Vec3::Y, GeometryMask::OPAQUE),
    ];
    let native = backends::native(&world);
    let arbiter = Reference::build(&world);
    assert_eq!(native.build_stats().dropped, arbiter.stats().dropped);
    let rays = rays(&world, 6000);
    let (hits, blocked) = (contract::closest(&native, &rays), contract::occluded(&native, &rays));
    let (mut agree, mut undecidable) = (0, 0);
    for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(blocked) {
        for verdict in [arbiter.judge(ray, hit), arbiter.judge_occluded(ray, blocked)] {
            match verdict {
                Verdict::Agrees => agree += 1,
                Verdict::Undecidable(_, margin) => {
                    assert!(margin.distance <= margin.bound, "{margin:?}");
                    undecidable += 1;
                }
                Verdict::Wrong(fault) => panic!("{fault:?}: {ray:?} met {hit:?}"),
            }
        }
    }
    assert!(agree > 9000 && undecidable < 3000, "{agree} agree, {undecidable} undecidable");
}

/// Case PA-09 of the catalogue.
#[test]
fn both_renderers_make_the_same_picture() {
    let mut scene = scenes::empty(1.0);
    (scene.settings.width, scene.settings.height) = (64, 48);
    scene.settings.max_depth = 8;
    scene.camera.eye = Vec3::new(0.5, 1.0, 5.0);
    let glass = scenes::glass(&mut scene, 1.5, 0, Rgb::new(0.1, 0.2, 0.4));
    scenes::sphere(&mut scene, Vec3::ZERO, 1.0, glass);
    scenes::cuboid(&mut scene, Vec3::new(1.2, -0.9, -0.5), Vec3::new(2.0, 0.8, 0.6), glass);
    let floor = scenes::material(&mut scene, Material::default());
    scenes::plane(&mut scene, Vec3::Y * -1.0, Vec3::Y, floor);
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Point { position: Vec3::new(-2.0, 4.0, 3.0) },
        intensity: Rgb::splat(30.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    let options = Options { threads: 1, ..Options::default() };
    let quick = scenes::native(&scene, &options);
    let slow = reference::render(&scene, &options, &Observer::default()).unwrap();
    let far = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 5e-4);
    let off = quick.film.pixels.iter().zip(&slow.film.pixels).filter(|(a, b)| far(a, b)).count();
    let cut = quick.truncated.pixels.iter().zip(&slow.truncated.pixels).filter(|(a, b)| far(a, b)).count();
    assert!(off <= 6 && cut <= 6, "{off} pixels and {cut} truncated weights differ");
    assert_eq!(quick.unmatched_exits, slow.unmatched_exits);
}
