//! Refraction at planar surfaces by raised objects.

use glam::Vec3;
use vitrum::optics::RefractionModel;
use vitrum::render::{Observer, Options, reference};
use vitrum::scene::{Dispersion, FresnelRule, Interface, Material, Medium, Projection, Rgb, Scene};

use super::{difference, is_at_edge, outcomes};
use crate::support::scenes::{bare, cuboid, empty, material, native, plane, sphere};

const WATER: f32 = 1.333;

fn raised() -> Options {
    Options { refraction: RefractionModel::Raised, ..Options::default() }
}

/// Glowing boxes below y = 0, all depths divided by `raise`.
fn boxes(raise: f32) -> Scene {
    let mut scene = empty(0.0);
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (64, 48, 1);
    scene.camera.eye = Vec3::new(0.4, 1.6, 2.4);
    scene.camera.target = Vec3::new(0.0, -0.3, 0.0);
    scene.camera.projection = Projection::Pinhole { vfov: 40.0 };
    let deep = |x: f32, y: f32, z: f32| Vec3::new(x, y / raise, z);
    for (lo, hi, colour) in [
        (deep(-5.0, -1.1, -5.0), deep(5.0, -1.0, 5.0), Rgb::new(0.2, 0.3, 0.4)),
        (deep(-0.8, -1.0, -0.5), deep(-0.2, -0.3, 0.1), Rgb::new(0.9, 0.2, 0.1)),
        (deep(0.2, -1.0, -0.2), deep(0.5, -0.8, 0.4), Rgb::new(0.1, 0.8, 0.3)),
    ] {
        let glow = material(&mut scene, Material { emission: colour, ..Material::black("glow") });
        cuboid(&mut scene, lo, hi, glow);
    }
    scene
}

/// A material of clear water that lets everything through.
fn water(scene: &mut Scene) -> u32 {
    scene.media.push(Medium {
        name: String::from("water"),
        ior: f64::from(WATER),
        dispersion: Dispersion::None,
        absorption: Rgb::ZERO,
        priority: 0,
    });
    let medium = scene.media.len() as u32 - 1;
    material(scene, bare(Interface::Dielectric { medium, rule: FresnelRule::Fixed(Rgb::ZERO), tint: Rgb::ONE }))
}

#[test]
fn a_pool_is_seen_as_if_its_floor_and_all_in_it_were_raised() {
    let drawn = native(&boxes(WATER), &Options::default()).film;
    let mut pool = boxes(1.0);
    let surface = water(&mut pool);
    plane(&mut pool, Vec3::ZERO, Vec3::Y, surface);
    for (name, outcome) in outcomes(&pool, &raised()) {
        for p in 0..drawn.pixels.len() {
            let off = difference(&drawn, &outcome.film, p);
            assert!(off <= 1e-5 || is_at_edge(&drawn, p, 1e-3), "{name}: pixel {p} by {off}");
        }
    }
    let traced = native(&pool, &Options::default()).film;
    let moved = (0..drawn.pixels.len()).filter(|&p| difference(&drawn, &traced, p) > 1e-3).count();
    assert!(moved > 20, "light is bent by the sine and not by the tangent: {moved}");
}

#[test]
fn curved_surfaces_bend_light_by_snells_law() {
    let mut scene = boxes(1.0);
    let ball = water(&mut scene);
    sphere(&mut scene, Vec3::new(0.1, 0.2, 0.6), 0.5, ball);
    // A pane far behind the eye, so that something is planar.
    cuboid(&mut scene, Vec3::new(-1.0, -1.0, 90.0), Vec3::new(1.0, 1.0, 91.0), ball);
    for ((name, plain), (_, raised)) in outcomes(&scene, &Options::default()).iter().zip(outcomes(&scene, &raised())) {
        assert!(plain.film == raised.film, "{name}");
    }
}

#[test]
fn a_scene_without_a_planar_body_is_refused_by_name() {
    let mut scene = boxes(1.0);
    let ball = water(&mut scene);
    sphere(&mut scene, Vec3::new(0.1, 0.2, 0.6), 0.5, ball);
    let told =
        reference::render(&scene, &raised(), &Observer::default()).expect_err("a ball is not planar").to_string();
    let name = &scene.objects.last().expect("it has objects").name;
    assert!(told.contains(&format!("--refraction raised: `{name}` is a sphere")), "{told}");
}
