//! Single pieces of glass.

use glam::Vec3;
use vitrum::geometry::Shape;
use vitrum::optics::FresnelModel;
use vitrum::render::reference::Prepared;
use vitrum::scene::{Environment, FresnelRule, Interface, Rgb, Scene};

use super::build::*;

const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

#[test]
fn a_glass_ball_seen_head_on_reflects_four_percent_and_all_echoes_make_it_7_7() {
    let mut scene = empty();
    let glass = medium(&mut scene, 1.5, 0.0, 0);
    put(&mut scene, sphere(0.0, 0.0, 0.0, 1.0), dielectric(glass));
    put(&mut scene, plane(Vec3::Z * 9.0, -Vec3::Z), emitter(1.0));
    scene.settings.max_depth = 1;
    let first = trace(&scene, [0.0, 0.0, 5.0], DOWN);
    close(first.radiance.x, 0.04, 1e-15);
    close(first.truncated.x, 0.96, 1e-15);
    scene.settings.max_depth = 40;
    close(radiance(&scene, [0.0, 0.0, 5.0], DOWN), 2.0 * 0.04 / 1.04, 1e-15);
}

fn shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("sphere", sphere(0.1, 0.2, -0.1, 1.0)),
        ("box", block(Vec3::new(-1.0, -0.8, -0.6), Vec3::new(1.1, 0.7, 0.9))),
        ("torus", torus(1.0, 0.4, 12, false)),
    ]
}

/// Interpolated normals divide light as strictly, but they are not reversible: a ray that entered between two normals
/// may circle for ever in total reflection, which only shows in the truncated weight.
fn smooth() -> (&'static str, Shape) {
    ("smooth torus", torus(1.0, 0.4, 12, true))
}

fn furnace(shape: Shape, max_depth: u32, cutoff: f32) -> Scene {
    let mut scene = empty();
    white(&mut scene);
    scene.settings.max_depth = max_depth;
    scene.settings.cutoff = cutoff;
    let glass = medium(&mut scene, 1.5, 0.0, 0);
    put(&mut scene, shape, dielectric(glass));
    scene
}

/// Rays towards the middle of things from all around.
fn around() -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
    (0..60).map(|k| {
        let (s, c) = (f64::from(k) * 2.4).sin_cos();
        let y = f64::from(k) / 30.0 - 1.0 + 1.0 / 60.0;
        let r = (1.0 - y * y).sqrt();
        let from = [4.0 * r * c, 4.0 * y, 4.0 * r * s];
        let to = [(f64::from(k) * 1.7).sin(), 0.3 * (f64::from(k) * 0.9).cos(), (f64::from(k) * 0.7).cos()];
        (from, [0, 1, 2].map(|i| to[i] - from[i]))
    })
}

#[test]
fn lossless_glass_of_any_shape_vanishes_in_a_furnace() {
    for (name, shape) in shapes() {
        let scene = furnace(shape, 1000, 1e-12);
        let mut met = 0;
        for (from, dir) in around() {
            let seen = trace(&scene, from, dir);
            assert!((seen.radiance.x - 1.0).abs() < 1e-9, "{name}: {} from {from:?}", seen.radiance.x);
            assert_eq!(seen.unmatched_exits.total(), 0, "{name}");
            met += u32::from(seen.rays.total() > 1);
        }
        assert!(met > 30, "{name}: {met} rays met it");
    }
}

#[test]
fn what_a_small_depth_lacks_is_the_truncated_weight() {
    for (name, shape) in shapes().into_iter().chain([smooth()]) {
        for (depth, cutoff) in [(0, 0.0), (1, 0.0), (2, 0.0), (5, 0.0), (50, 0.01)] {
            let scene = furnace(shape.clone(), depth, cutoff);
            let mut cut = 0.0;
            for (from, dir) in around() {
                let seen = trace(&scene, from, dir);
                assert!((1.0 - seen.radiance.x - seen.truncated.x).abs() < 1e-12, "{name} at depth {depth}: {seen:?}");
                cut += seen.truncated.x;
            }
            assert!(cut > 0.01, "{name} at depth {depth}: nothing cut");
        }
    }
}

#[test]
fn a_slab_displaces_light_and_keeps_its_direction() {
    let mut scene = empty();
    scene.environment = Environment::Gradient { nadir: Rgb::ZERO, horizon: Rgb::ZERO, zenith: Rgb::ONE };
    scene.settings.max_depth = 2;
    let glass = medium(&mut scene, 1.5, 0.0, 0);
    put(&mut scene, block(Vec3::new(-50.0, 0.0, -50.0), Vec3::new(50.0, 2.0, 50.0)), dielectric(glass));
    let angle = 0.9_f64;
    let (from, dir) = ([0.3, -1.0, 0.2], [angle.sin(), angle.cos(), 0.0]);
    let passes = (1.0 - fresnel(1.0, 1.5, angle)).powi(2);
    close(radiance(&scene, from, dir), passes * angle.cos(), 1e-14);

    // One unit of air, two of glass, one of air: a bead there is seen, and one on the straight way is not.
    let x = 0.3 + 2.0 * angle.tan() + 2.0 * (angle.sin() / 1.5).asin().tan();
    put(&mut scene, sphere(x as f32, 3.0, 0.2, 1e-4), emitter(7.0));
    close(radiance(&scene, from, dir), passes * 7.0, 1e-14);
    let straight = 0.3 + 4.0 * angle.tan();
    scene.geometry[1].shape = sphere(straight as f32, 3.0, 0.2, 1e-4);
    close(radiance(&scene, from, dir), passes * angle.cos(), 1e-14);
}

#[test]
fn absorption_in_a_slab_is_beer_lambert() {
    let mut scene = empty();
    white(&mut scene);
    let dye = medium(&mut scene, 1.0, 0.0, 0);
    scene.media[dye as usize].absorption = Rgb::new(0.25, 0.5, 1.0);
    put(&mut scene, layer(-2.0, 0.0), dielectric(dye));
    let seen = trace(&scene, [0.3, 0.4, 3.0], DOWN).radiance;
    for (got, sigma) in seen.to_array().into_iter().zip([0.25, 0.5, 1.0]) {
        // Secondary rays start some 1e-12 off these large faces.
        close(got, f64::exp(-2.0 * sigma), 2e-12);
    }
    let angle = 1.0_f64;
    let oblique = radiance(&scene, [0.3, 0.4, 3.0], [angle.sin(), 0.0, -angle.cos()]);
    close(oblique, (-0.25 * 2.0 / angle.cos()).exp(), 2e-12);
}

/// Case AB-01 of the catalogue.
#[test]
fn light_that_never_leaves_an_absorbing_medium_is_gone_and_no_nan() {
    let mut scene = empty();
    white(&mut scene);
    let ink = medium(&mut scene, 1.0, 0.5, 0);
    put(&mut scene, plane(Vec3::ZERO, Vec3::Z), dielectric(ink));
    let seen = trace(&scene, [0.0, 0.0, 1.0], DOWN);
    assert_eq!((seen.radiance.x, seen.non_finite, seen.truncated.x), (0.0, 0, 0.0));
}

#[test]
fn a_tint_weakens_what_is_refracted_and_a_fixed_share_replaces_fresnel() {
    let mut scene = empty();
    white(&mut scene);
    scene.settings.max_depth = 2;
    let glass = medium(&mut scene, 1.5, 0.0, 0);
    let interface =
        Interface::Dielectric { medium: glass, rule: FresnelRule::Fixed(Rgb::splat(0.25)), tint: Rgb::splat(0.5) };
    put(&mut scene, layer(-2.0, 0.0), bare(interface));
    // Reflected, and through both faces; echoes are deeper.
    close(radiance(&scene, [0.3, 0.4, 3.0], DOWN), 0.25 + (0.75 * 0.5_f64).powi(2), 1e-15);
}

#[test]
fn each_fresnel_model_gives_its_own_reflectance() {
    let mut scene = empty();
    scene.settings.max_depth = 1;
    let glass = medium(&mut scene, 1.5, 0.0, 0);
    put(&mut scene, layer(-2.0, 0.0), dielectric(glass));
    put(&mut scene, plane(Vec3::Z * 9.0, -Vec3::Z), emitter(1.0));
    let angle = 1.2_f64;
    let dir = glam::DVec3::new(angle.sin(), 0.0, -angle.cos());
    let by = |model| Prepared::new(&scene, model).radiance_along(glam::DVec3::Z, dir)[0];
    close(by(FresnelModel::Exact), fresnel(1.0, 1.5, angle), 1e-14);
    close(by(FresnelModel::Schlick), 0.04 + 0.96 * (1.0 - angle.cos()).powi(5), 1e-14);
    close(by(FresnelModel::Off), 0.04, 1e-14);
}

#[test]
fn a_fixed_share_yields_to_total_reflection() {
    let mut scene = empty();
    scene.settings.max_depth = 1;
    let glass = medium(&mut scene, 1.5, 0.0, 0);
    let rule = FresnelRule::Fixed(Rgb::splat(0.25));
    put(&mut scene, plane(Vec3::ZERO, Vec3::Z), bare(Interface::Dielectric { medium: glass, rule, tint: Rgb::ONE }));
    put(&mut scene, plane(Vec3::Z * -9.0, Vec3::Z), emitter(1.0));
    let critical = (1.0 / 1.5_f64).asin();
    let below = |angle: f64| radiance(&scene, [0.0, 0.0, -1.0], [angle.sin(), 0.0, angle.cos()]);
    close(below(critical - 1e-3), 0.25, 1e-15);
    close(below(critical + 1e-3), 1.0, 1e-15);
}
