//! Walking the trees: the bits of testing everything, and shadows that end where they should.

use glam::Vec3;
use vitrum::geometry::{GeometryMask, Ray};
use vitrum::render::{Observer, Options, reference};
use vitrum::scene::{Colour, Falloff, Light, LightKind, Material, Rgb};

use crate::support::aim::count;
use crate::support::kernels::assert_bits_of_brute_force;
use crate::support::{Rng, scenes, shapes};

/// TR-01, TR-07, TR-08: twenty meshes, from one triangle over geometric series of sizes to thousands in one place, give the
/// bits of testing every triangle, in single and packet traversal.
#[test]
fn every_mesh_of_the_zoo_gives_the_bits_of_testing_everything() {
    let mut rng = Rng::new(41);
    for (name, mesh) in super::build::zoo(300) {
        let bounds = mesh.bounds();
        let (centre, extent) = (bounds.centre(), bounds.extent().max_element());
        let rays: Vec<Ray> = (0..count(400))
            .map(|i| {
                let corners = mesh.corners(rng.below(mesh.triangles.len()));
                let target = match i % 4 {
                    0 => corners[rng.below(3)],
                    1 => corners[0].midpoint(corners[1]),
                    _ => corners[0] * 0.3 + corners[1] * 0.3 + corners[2] * 0.4,
                };
                let own = (corners[1] - corners[0]).abs().max((corners[2] - corners[0]).abs()).max_element();
                let size = if i % 8 < 4 { extent } else { own };
                let origin = if i % 2 == 0 { centre } else { target } + rng.point() * size * 2.0;
                let mut dir = target - origin;
                if i % 5 == 0 {
                    dir = Vec3::AXES[rng.below(3)] * if i % 10 == 0 { 1.0 } else { -1.0 };
                }
                Ray::new(origin, dir)
            })
            .collect();
        let hits = assert_bits_of_brute_force(&[shapes::masked(mesh, GeometryMask::OPAQUE)], &rays);
        assert!(hits > 20 || ["collinear", "denormal"].contains(&name), "{name}: {hits} hits");
    }
}

/// A wall with a lamp `gap` above it in front of a floor that it lights.
fn lamp_on_a_ceiling(gap: f32) -> vitrum::scene::Scene {
    let mut scene = scenes::empty(0.0);
    scene.camera.eye = Vec3::new(0.1, 1.0, 4.0);
    let white = Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() };
    let white = scenes::material(&mut scene, white);
    scenes::cuboid(&mut scene, Vec3::new(-9.0, -1.3, -9.0), Vec3::new(9.0, -1.0, 9.0), white);
    scenes::cuboid(&mut scene, Vec3::new(-9.0, 2.1, -9.0), Vec3::new(9.0, 2.4, 9.0), white);
    scene.lights.push(Light {
        name: "lamp".into(),
        kind: LightKind::Point { position: Vec3::new(0.3, 2.1 - gap, 0.2) },
        intensity: Rgb::splat(10.0),
        falloff: Falloff::None,
        shadows: true,
    });
    scene
}

/// TR-06: a lamp that stands exactly on a ceiling lights the floor as one that hangs a little below: a shadow ray does not
/// meet the surface that its lamp stands on.
#[test]
fn a_lamp_on_a_surface_is_not_shaded_by_it() {
    let floor = |film: &vitrum::image::Film| {
        let half = film.pixels.len() / 2;
        film.pixels[half + 4 * film.width as usize..].iter().map(|p| p[0]).collect::<Vec<f32>>()
    };
    let on = floor(&scenes::native(&lamp_on_a_ceiling(0.0), &Options::default()).film);
    let below = floor(&scenes::native(&lamp_on_a_ceiling(1e-3), &Options::default()).film);
    assert!(below.iter().filter(|x| **x > 0.1).count() > 300);
    let dark = on.iter().zip(&below).filter(|(a, b)| (*a - *b).abs() > 0.01).count();
    assert_eq!(dark, 0, "of {} pixels", on.len());
    let arbiter =
        floor(&reference::render(&lamp_on_a_ceiling(0.0), &Options::default(), &Observer::default()).unwrap().film);
    let dark = on.iter().zip(&arbiter).filter(|(a, b)| (*a - *b).abs() > 0.01).count();
    assert_eq!(dark, 0, "of {} pixels differ from the reference", on.len());
}
