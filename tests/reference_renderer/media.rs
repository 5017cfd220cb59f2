//! Media within media.

use glam::Vec3;
use vitrum::scene::{Environment, Rgb, Scene};

use super::build::*;

const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

/// Along -z: glass over 1..0, water over 0.5..-5 (its first half unit inside the glass), ice over -1..-3 in the water,
/// and a lamp at `lamp`. No light that is reflected on the way to it gets there in five steps.
fn drink(order: [usize; 3], lamp: f32) -> Scene {
    let mut scene = empty();
    let glass = medium(&mut scene, 1.5, 0.1, 30);
    let water = medium(&mut scene, 1.33, 0.2, 10);
    let ice = medium(&mut scene, 1.31, 0.3, 20);
    for i in order {
        let (shape, medium) =
            [(layer(0.0, 1.0), glass), (layer(-5.0, 0.5), water), (layer(-3.0, -1.0), ice)][i].clone();
        put(&mut scene, shape, dielectric(medium));
    }
    put(&mut scene, plane(Vec3::Z * lamp, Vec3::Z), emitter(1.0));
    scene.settings.max_depth = 5;
    scene
}

fn passes(n1: f64, n2: f64) -> f64 {
    1.0 - fresnel(n1, n2, 0.0)
}

#[test]
fn ice_in_water_in_a_glass_is_right_with_the_surfaces_overlapping() {
    let crossed = passes(1.0, 1.5) * passes(1.5, 1.33) * passes(1.33, 1.31).powi(2) * passes(1.33, 1.0);
    let absorbed = (-(0.1 * 1.0 + 0.2 * (1.0 + 2.0) + 0.3 * 2.0_f64)).exp();
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
        let there = trace(&drink(order, -9.0), [0.2, 0.3, 4.0], DOWN);
        let back = trace(&drink(order, 9.0), [0.2, 0.3, -8.0], [0.0, 0.0, 1.0]);
        // Absorption coefficients are f32.
        close(there.radiance.x, crossed * absorbed, 1e-7);
        close(back.radiance.x, there.radiance.x, 1e-14);
        assert_eq!(there.unmatched_exits.total() + back.unmatched_exits.total(), 0);
    }
}

#[test]
fn a_surface_that_is_not_there_costs_no_depth() {
    // Six surfaces, five boundaries: at depth 5 the lamp is seen (above), at depth 4 it is not.
    let mut scene = drink([0, 1, 2], -9.0);
    scene.settings.max_depth = 4;
    assert_eq!(trace(&scene, [0.2, 0.3, 4.0], DOWN).radiance.x, 0.0);
}

#[test]
fn among_equals_the_smaller_body_fills_the_space_and_of_equal_ones_the_denser() {
    // A short layer of `a` over 0..-4 and one of `b` from -2 down: over -2..-4 one of them is there.
    let seen = |b_ends: f32| {
        let mut scene = empty();
        let a = medium(&mut scene, 1.5, 0.1, 5);
        let b = medium(&mut scene, 1.2, 0.0, 5);
        put(&mut scene, layer(-4.0, 0.0), dielectric(a));
        put(&mut scene, layer(b_ends, -2.0), dielectric(b));
        put(&mut scene, plane(Vec3::Z * -9.0, Vec3::Z), emitter(1.0));
        scene.settings.max_depth = 3;
        radiance(&scene, [0.2, 0.3, 4.0], DOWN)
    };
    let want = passes(1.0, 1.5) * passes(1.5, 1.2) * passes(1.2, 1.0);
    let through_a = |length: f64| want * (-0.1 * length).exp();
    close(seen(-5.0), through_a(2.0), 1e-8);
    close(seen(-6.0), through_a(4.0), 1e-8);
    close(seen(-8.0), through_a(4.0), 1e-8);
}

#[test]
fn leaving_what_was_never_entered_is_counted_and_still_a_boundary() {
    let mut scene = empty();
    let glass = medium(&mut scene, 1.5, 0.0, 0);
    put(&mut scene, sphere(0.0, 0.0, 0.0, 1.0), dielectric(glass));
    scene.camera.medium = Some(0);
    white(&mut scene);
    scene.settings.max_depth = 1;
    let seen = trace(&scene, [0.0; 3], DOWN);
    // Once from the middle, once what the wall sends back.
    assert_eq!(seen.unmatched_exits.worst_first(), [(0, 2)]);
    close(seen.radiance.x, 0.96, 1e-15);
    close(seen.truncated.x, 0.04, 1e-15);
}

/// Water with its surface at y = 0, an eye a unit below it, and a sky that is black upwards and brightens downwards.
fn pool(closed: bool) -> Scene {
    let mut scene = empty();
    let water = medium(&mut scene, 1.33, 0.0, 0);
    let shape = if closed {
        block(Vec3::new(-900.0, -500.0, -900.0), Vec3::new(900.0, 0.0, 900.0))
    } else {
        plane(Vec3::ZERO, Vec3::Y)
    };
    put(&mut scene, shape, dielectric(water));
    scene.environment = Environment::Gradient { nadir: Rgb::ZERO, horizon: Rgb::ZERO, zenith: Rgb::ONE };
    scene.camera.eye = Vec3::new(0.0, -1.0, 0.0);
    scene.settings.max_depth = 1;
    scene
}

#[test]
fn an_eye_under_water_sees_the_sky_through_snells_window_and_nothing_beside_it() {
    let critical = (1.0 / 1.33_f64).asin();
    for closed in [false, true] {
        let scene = pool(closed);
        for angle in [0.0, 0.3, 0.7, critical - 1e-6, critical + 1e-6, 1.2, 1.5] {
            let seen = trace(&scene, [0.0, -1.0, 0.0], [angle.sin(), angle.cos(), 0.0]);
            // What is reflected goes down, where it is black.
            let height = (1.0 - (1.33 * angle.sin()).powi(2)).max(0.0).sqrt();
            close(seen.radiance.x, (1.0 - fresnel(1.33, 1.0, angle)) * height, 1e-12);
            assert_eq!(seen.unmatched_exits.total(), 0);
        }
    }
}

/// Case AB-09 of the catalogue.
#[test]
fn the_media_around_the_eye_are_found_through_what_lies_in_between() {
    // An eye in an air bubble (a medium of its own) in a drop in a tank.
    let mut scene = empty();
    let tank = medium(&mut scene, 1.5, 0.0, 1);
    let drop = medium(&mut scene, 1.33, 0.0, 2);
    let bubble = medium(&mut scene, 1.0, 0.0, 3);
    put(&mut scene, sphere(0.0, 0.0, 0.0, 8.0), dielectric(tank));
    put(&mut scene, sphere(0.0, 0.0, 0.0, 4.0), dielectric(drop));
    put(&mut scene, sphere(0.0, 0.0, 0.0, 1.0), dielectric(bubble));
    // In the way of whoever looks up, and not around the eye.
    put(&mut scene, sphere(1.5, 11.0, 3.0, 2.5), dielectric(tank));
    scene.camera.eye = Vec3::ZERO;
    white(&mut scene);
    scene.settings.max_depth = 3;
    let seen = trace(&scene, [0.0; 3], DOWN);
    assert_eq!(seen.unmatched_exits.total(), 0);
    // Reflected light comes back through the middle and needs more than three steps.
    let want = passes(1.0, 1.33) * passes(1.33, 1.5) * passes(1.5, 1.0);
    close(seen.radiance.x, want, 1e-14);
}

#[test]
fn a_medium_that_the_camera_names_is_believed() {
    let mut scene = empty();
    white(&mut scene);
    let fog = medium(&mut scene, 1.0, 0.5, 0);
    scene.camera.medium = Some(fog);
    put(&mut scene, plane(Vec3::Z * -3.0, Vec3::Z), emitter(1.0));
    close(radiance(&scene, [0.0; 3], DOWN), (-1.5_f64).exp(), 1e-15);
}

#[test]
fn more_than_256_absent_surfaces_in_a_row_end_as_truncated_weight() {
    let mut scene = empty();
    white(&mut scene);
    let glass = medium(&mut scene, 1.5, 0.0, 9);
    let air = medium(&mut scene, 1.0, 0.0, 1);
    put(&mut scene, layer(-400.0, 0.0), dielectric(glass));
    for i in 0..200 {
        let z = -1.0 - i as f32;
        put(&mut scene, layer(z - 0.5, z), dielectric(air));
    }
    scene.settings.max_depth = 1;
    let seen = trace(&scene, [0.2, 0.3, 1.0], DOWN);
    close(seen.radiance.x, 0.04, 1e-15);
    close(seen.truncated.x, 0.96, 1e-15);
    // The camera ray, its mirror image, and what is refracted: once itself and 256 times on.
    assert_eq!(seen.rays.total(), 1 + 1 + 257);
}

#[test]
fn of_equal_media_around_the_eye_the_inner_one_fills_the_space() {
    let mut scene = empty();
    let outer = medium(&mut scene, 1.5, 0.0, 0);
    let inner = medium(&mut scene, 1.2, 0.0, 0);
    put(&mut scene, sphere(0.0, 0.0, 0.0, 4.0), dielectric(outer));
    put(&mut scene, sphere(0.0, 0.0, 0.0, 2.0), dielectric(inner));
    white(&mut scene);
    scene.settings.max_depth = 2;
    close(radiance(&scene, [0.0; 3], DOWN), passes(1.2, 1.5) * passes(1.5, 1.0), 1e-14);
}
