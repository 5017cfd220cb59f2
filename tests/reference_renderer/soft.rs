//! Lamps with an extent, and the soft edges of their shadows.

use std::f64::consts::PI;

use glam::Vec3;
use vitrum::geometry::Shape;
use vitrum::scene::{Falloff, LampSampling, Light, LightKind, Material, Pattern, Rgb, Scene, Spread};

use super::build::*;

/// A white floor at y = 0 under a lamp of intensity 3, sampled by a grid of `side` by `side`.
fn floor(kind: LightKind, falloff: Falloff, side: u32) -> Scene {
    let mut scene = empty();
    scene.settings.lamps = LampSampling { count: side * side, pattern: Pattern::Grid, ..LampSampling::default() };
    put(&mut scene, plane(Vec3::ZERO, Vec3::Y), lambert(1.0));
    scene.lights.push(light(kind, falloff));
    scene
}

/// Returns the radiance of the floor at `x` and z = 0, seen from beside whatever stands on it.
fn seen(scene: &Scene, x: f64) -> f64 {
    radiance(scene, [x, 0.5, 40.0], [0.0, -0.5, -40.0])
}

fn ball(position: Vec3, radius: f32) -> LightKind {
    LightKind::Sphere { position, radius }
}

/// A level rectangle around (0, height, 0) that shines downwards.
fn sheet(width: f32, depth: f32, height: f32, spread: Spread) -> LightKind {
    let corner = Vec3::new(-0.5 * width, height, -0.5 * depth);
    LightKind::Rectangle { corner, edges: [Vec3::X * width, Vec3::Z * depth], spread }
}

/// An opaque sheet at a height that covers all of x < `edge`.
fn cover(scene: &mut Scene, edge: f32, height: f32) {
    let slab = block(Vec3::new(-100.0, height - 1e-4, -30.0), Vec3::new(edge, height, 30.0));
    put(scene, slab, Material::black("cover"));
}

#[test]
fn a_ball_wholly_above_the_horizon_lights_as_its_middle_would() {
    for (radius, within) in [(1e-3, 1e-7), (0.5, 1e-4), (3.9, 3e-3)] {
        let scene = floor(ball(Vec3::new(3.0, 4.0, 0.0), radius), Falloff::InverseSquare, 32);
        let want = 3.0 / PI * 0.8 / 25.0;
        close(seen(&scene, 0.0), want, within * want);
    }
}

#[test]
fn a_shrinking_lamp_becomes_a_point() {
    let position = Vec3::new(1.5, 2.0, -0.5);
    for falloff in [Falloff::InverseSquare, Falloff::None] {
        let point = seen(&floor(LightKind::Point { position }, falloff, 4), 0.2);
        let small = |kind| seen(&floor(kind, falloff, 4), 0.2);
        close(small(ball(position, 1e-4)), point, 1e-6 * point);
        let corner = position - Vec3::new(5e-5, 0.0, 5e-5);
        let edges = [Vec3::X * 1e-4, Vec3::Z * 1e-4];
        let even = LightKind::Rectangle { corner, edges, spread: Spread::Even };
        close(small(even), point, 1e-4 * point);
        // By the cosine it is weaker by that of the angle at which it is left.
        let cos = 2.0 / (1.3_f64 * 1.3 + 2.0 * 2.0 + 0.5 * 0.5).sqrt();
        close(small(LightKind::Rectangle { corner, edges, spread: Spread::Cosine }), point * cos, 1e-4 * point);
    }
}

/// The configuration factor of a rectangle right above a facing surface: four times that of a quarter of it, above whose
/// corner the surface is (Howell, C-10).
#[test]
fn a_rectangle_lights_by_its_configuration_factor_and_only_on_one_side() {
    let (w, d, h) = (2.0_f64, 1.0, 1.5);
    let scene = floor(sheet(2.0, 1.0, 1.5, Spread::Cosine), Falloff::InverseSquare, 64);
    let (x, y) = (0.5 * w / h, 0.5 * d / h);
    let side = |p: f64, q: f64| p / (1.0 + p * p).sqrt() * (q / (1.0 + p * p).sqrt()).atan();
    let factor = 4.0 * (side(x, y) + side(y, x)) / (2.0 * PI);
    // A white surface sends E / pi = L F, where L is I over the area.
    close(seen(&scene, 0.0), 3.0 / (w * d) * factor, 1e-4);

    let mut turned = scene.clone();
    if let LightKind::Rectangle { edges, .. } = &mut turned.lights[0].kind {
        edges.swap(0, 1);
    }
    assert_eq!(seen(&turned, 0.0), 0.0, "the floor is behind it");
}

/// By similar triangles: a lamp of width w at height H behind a straight edge at height h has a half shadow of width
/// w h / (H - h) on the floor.
#[test]
fn the_half_shadow_of_an_edge_is_as_wide_as_similar_triangles_say() {
    let (width, lamp, edge) = (2.0_f64, 6.0, 1.5);
    let mut scene = floor(sheet(2.0, 0.01, 6.0, Spread::Even), Falloff::None, 32);
    cover(&mut scene, 0.0, 1.5);
    let half = 0.5 * width * edge / (lamp - edge);
    let open = floor(sheet(2.0, 0.01, 6.0, Spread::Even), Falloff::None, 32);
    let fraction = |x: f64| seen(&scene, x) / seen(&open, x);
    assert_eq!(fraction(-half - 1e-3), 0.0);
    assert_eq!(fraction(half + 1e-3), 1.0);
    assert!(fraction(-half + 2.0 * half / 32.0) > 0.0 && fraction(half - 2.0 * half / 32.0) < 1.0);

    // In between, each column of the lamp that is seen past the edge adds its own cosine.
    for k in -9..10 {
        let x = half * f64::from(k) / 10.0 + 1e-4;
        let columns = (0..32).map(|i| (f64::from(i) + 0.5) / 32.0 * width - 0.5 * width);
        let cosine = |column: f64| lamp / ((column - x).powi(2) + lamp * lamp).sqrt();
        let passes = |column: f64| x + (column - x) * edge / lamp > 0.0;
        let want: f64 = columns.filter(|&c| passes(c)).map(cosine).sum::<f64>() / 32.0 * 3.0;
        close(seen(&scene, x), want, 1e-4);
        // And the share grows evenly over the width.
        close(fraction(x), 0.5 + 0.5 * x / half, 0.5 / 32.0 + 0.01);
    }
}

/// A ball R behind a ball r, their middles D apart, the smaller one in front: the core shadow ends where the outer
/// tangents cross, the half shadow is bounded by the inner ones.
#[test]
fn core_and_half_shadow_of_a_ball_are_bounded_by_the_tangents() {
    let (lamp, body, top, height) = (1.0_f64, 0.6_f64, 8.0, 2.0);
    let open = floor(ball(Vec3::new(0.0, 8.0, 0.0), 1.0), Falloff::InverseSquare, 32);
    let mut scene = open.clone();
    put(&mut scene, sphere(0.0, 2.0, 0.0, 0.6), Material::black("body"));
    let apart = top - height;
    // The tip of the core shadow lies below the body by r D / (R - r); its cone's half angle has sine (R - r) / D.
    let tip = body * apart / (lamp - body);
    let core = (tip - height) * ((lamp - body) / apart).asin().tan();
    // The inner tangents cross above the body by r D / (R + r).
    let crossing = body * apart / (lamp + body);
    let outer = (crossing + height) * ((lamp + body) / apart).asin().tan();
    assert_eq!(seen(&scene, core - 0.01), 0.0);
    assert!(seen(&scene, core + 0.03) > 0.0);
    let share = |x: f64| seen(&scene, x) / seen(&open, x);
    assert!(share(outer - 0.05) < 1.0);
    assert_eq!(share(outer + 0.01), 1.0);
    // Half way the disc of the lamp is about half covered.
    close(share(0.5 * (core + outer)), 0.5, 0.1);
}

#[test]
fn scrambled_points_come_to_what_a_fine_grid_does_within_the_half_shadow() {
    let kind = ball(Vec3::new(0.5, 6.0, 0.0), 1.0);
    let mut grid = floor(kind, Falloff::InverseSquare, 48);
    cover(&mut grid, 0.2, 1.5);
    let mut sobol = grid.clone();
    sobol.settings.lamps = LampSampling { count: 1024, seed: 5, ..LampSampling::default() };
    for x in [-0.3, -0.1, 0.05, 0.2, 0.4] {
        let want = seen(&grid, x);
        close(seen(&sobol, x), want, 4e-3 * seen(&grid, 3.0));
    }
    let other = LampSampling { seed: 6, count: 16, ..LampSampling::default() };
    let few = |lamps| {
        seen(&Scene { settings: vitrum::scene::Settings { lamps, ..sobol.settings.clone() }, ..sobol.clone() }, 0.05)
    };
    assert!(few(other) != few(LampSampling { seed: 7, ..other }), "another seed, other points");
    assert_eq!(few(other), few(other));
}

/// A pane of index 1 between is not there.
#[test]
fn light_of_a_lamp_passes_glass_as_that_of_a_point_does() {
    let kind = ball(Vec3::new(0.0, 6.0, 0.0), 1.0);
    let open = floor(kind, Falloff::InverseSquare, 8);
    let tinted = |tint: f32| {
        let mut scene = open.clone();
        let interface = vitrum::scene::Interface::ThinDielectric {
            ior: 1.0,
            rule: vitrum::scene::FresnelRule::Fresnel,
            tint: Rgb::splat(tint),
        };
        put(&mut scene, pane(), bare(interface));
        seen(&scene, 0.3)
    };
    close(tinted(1.0), seen(&open, 0.3), 1e-12);
    close(tinted(0.25), seen(&open, 0.3) * 0.25, 1e-9);
}

fn pane() -> Shape {
    plane(Vec3::new(0.0, 2.0, 0.0), Vec3::Y)
}

#[test]
fn a_lamp_in_a_surface_or_around_a_place_does_no_harm() {
    let inside = floor(ball(Vec3::new(0.0, 0.1, 0.0), 0.5), Falloff::InverseSquare, 8);
    assert_eq!(seen(&inside, 0.0), 0.0, "inside the ball");
    let lit = seen(&inside, 2.0);
    assert!(lit > 0.0 && lit.is_finite());
    let level = floor(sheet(1.0, 1.0, 0.0, Spread::Even), Falloff::InverseSquare, 8);
    let outcome = trace(&level, [0.03, 0.5, 40.0], [0.0, -0.5, -40.0]);
    assert!(outcome.radiance.x.is_finite());
}

#[test]
fn without_shadows_a_lamp_shines_through_everything() {
    let mut scene = floor(ball(Vec3::new(0.0, 6.0, 0.0), 1.0), Falloff::InverseSquare, 8);
    let open = seen(&scene, 0.0);
    cover(&mut scene, 100.0, 1.5);
    assert_eq!(seen(&scene, 0.0), 0.0);
    scene.lights[0] = Light { shadows: false, ..scene.lights[0].clone() };
    assert_eq!(seen(&scene, 0.0), open);
}
