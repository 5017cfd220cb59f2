//! Upper bounds on the rays of a picture.

use glam::Vec3;
use vitrum::effects::{self, EffectPlan};
use vitrum::render::Options;
use vitrum::scene::{Dispersion, Rgb, Scene, Settings};

use super::{grey, lamp, mirror, mirror_of};
use crate::support::scenes::{cuboid, empty, glass, material, native, plane, sphere};
use crate::support::{Rng, random};

#[test]
fn a_picture_never_takes_more_rays_or_deeper_ones_than_was_said_before() {
    for seed in 0..200 {
        let (scene, fresnel) = random::scene(seed);
        let options = Options { fresnel, ..Options::default() };
        let bound = EffectPlan::resolve(&scene, &options.effects).rays;
        let rays = native(&scene, &options).rays;
        let pixels = f64::from(scene.settings.width * scene.settings.height);
        assert!(rays.total() as f64 <= bound.per_pixel * pixels, "scene {seed}: {} of {bound:?}", rays.total());
        assert!(rays.by_depth.len() as u32 <= bound.depth + 1, "scene {seed}: {bound:?}");
    }
}

/// Rays of a scene of one camera ray to a pixel: what was said before, and the most that a pixel took.
fn said_and_taken(scene: &mut Scene) -> (effects::RayBound, f64) {
    let said = EffectPlan::resolve(scene, &effects::Options::default()).rays;
    let mut most = 0;
    let (width, height) = (scene.settings.width, scene.settings.height);
    (scene.settings.width, scene.settings.height) = (1, 1);
    let (eye, target) = (scene.camera.eye, scene.camera.target);
    for i in 0..width * height {
        // One pixel at a time, looking all over the scene.
        let off = Vec3::new((i % width) as f32 / width as f32 - 0.5, (i / width) as f32 / height as f32 - 0.5, 0.0);
        scene.camera.target = target + off * 2.0;
        most = most.max(native(scene, &Options::default()).rays.total());
    }
    (scene.settings.width, scene.settings.height) = (width, height);
    (scene.camera.eye, scene.camera.target) = (eye, target);
    (said, most as f64)
}

#[test]
fn the_bound_on_rays_is_reached_where_it_can_be_counted_by_hand() {
    let base = || {
        let mut scene = empty(1.0);
        scene.settings = Settings { width: 8, height: 8, max_depth: 6, cutoff: 0.0, ..Settings::default() };
        (scene.camera.eye, scene.camera.target) = (Vec3::new(0.0, 0.1, 4.0), Vec3::ZERO);
        scene
    };
    // A ball of glass: one ray outside and one inside at each level after the first.
    let mut scene = base();
    let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::ZERO, 1.0, clear);
    let (said, taken) = said_and_taken(&mut scene);
    assert_eq!((said.depth, said.per_pixel, taken), (6, 1.0 + 2.0 * 6.0, 13.0));
    // A box of glass alone, which a ray can leave on any side.
    let mut scene = base();
    let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    cuboid(&mut scene, Vec3::new(-0.9, -0.7, -0.5), Vec3::new(0.8, 0.6, 0.4), clear);
    let (said, taken) = said_and_taken(&mut scene);
    assert!(said.per_pixel == 13.0 && taken <= 13.0, "{said:?} {taken}");
    // One plane of a mirror: a ray and its reflection. With a lamp over a floor that answers, shadow rays from the end.
    let mut scene = base();
    let mirror = material(&mut scene, mirror());
    plane(&mut scene, Vec3::Z * -1.0, Vec3::Z, mirror);
    let grey = material(&mut scene, grey());
    plane(&mut scene, Vec3::Z * 5.0, -Vec3::Z, grey);
    scene.lights.push(lamp(Vec3::new(0.0, 3.0, 0.0)));
    let (said, taken) = said_and_taken(&mut scene);
    assert_eq!((said.depth, said.per_pixel, taken), (1, 3.0, 3.0));
    // Two facing mirrors that keep 0.9: 0.9 to the 65th is the last that is not below 1/1024.
    let mut scene = base();
    (scene.settings.max_depth, scene.settings.cutoff) = (500, 1.0 / 1024.0);
    let mirror = material(&mut scene, mirror_of(0.9));
    plane(&mut scene, Vec3::Z * -1.0, Vec3::Z, mirror);
    plane(&mut scene, Vec3::Z * 5.0, -Vec3::Z, mirror);
    let (said, taken) = said_and_taken(&mut scene);
    assert_eq!((said.depth, said.per_pixel, taken), (65, 66.0, 66.0));
}

#[test]
fn scenes_that_disperse_keep_to_their_bound_on_rays() {
    let mut rng = Rng::new(12);
    for k in 0..12 {
        let mut scene = empty(1.0);
        scene.settings = Settings { width: 12, height: 12, max_depth: 5, wavelengths: 7, ..Settings::default() };
        scene.settings.cutoff = [0.0, 1e-3, 0.05, 0.2][k % 4];
        let clear = glass(&mut scene, 1.7, 0, Rgb::ZERO);
        scene.media.last_mut().expect("just added").dispersion = Dispersion::Cauchy([1.7, 0.02, 0.0]);
        for _ in 0..=k / 4 {
            sphere(&mut scene, rng.point() * 0.8, 0.5 + 0.3 * rng.unit(), clear);
        }
        (scene.camera.eye, scene.camera.target) = (rng.direction().normalize() * 4.0, Vec3::ZERO);
        let (said, taken) = said_and_taken(&mut scene);
        assert!(taken <= said.per_pixel, "scene {k}: {taken} of {said:?}");
    }
}
