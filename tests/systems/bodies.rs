//! Refraction that ends in maps of a body's surroundings.

use glam::Vec3;
use vitrum::optics::RefractionModel;
use vitrum::render::{Observer, Options, reference};
use vitrum::scene::{
    Colour, Dispersion, Environment, Falloff, FresnelRule, Interface, Light, LightKind, Material, Medium, Rgb, Scene,
};

use super::{difference, outcomes};
use crate::support::scenes::{bare, cuboid, empty, material, native, plane, sphere};

fn by(refraction: RefractionModel) -> Options {
    Options { refraction, ..Options::default() }
}

/// A material of a clear body that lets everything through.
fn clear(scene: &mut Scene, ior: f64, absorption: Rgb) -> u32 {
    scene.media.push(Medium {
        name: String::from("clear"),
        ior,
        dispersion: Dispersion::None,
        absorption,
        priority: 0,
    });
    let medium = scene.media.len() as u32 - 1;
    material(scene, bare(Interface::Dielectric { medium, rule: FresnelRule::Fixed(Rgb::ZERO), tint: Rgb::ONE }))
}

/// A sky whose light depends on the direction alone.
fn sky(scene: &mut Scene) {
    scene.environment = Environment::Gradient {
        nadir: Rgb::new(0.9, 0.2, 0.1),
        horizon: Rgb::new(0.3, 0.8, 0.2),
        zenith: Rgb::new(0.1, 0.2, 0.9),
    };
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (48, 48, 1);
}

fn most(a: &vitrum::image::Film, b: &vitrum::image::Film) -> f32 {
    (0..a.pixels.len()).map(|p| difference(a, b, p)).fold(0.0, f32::max)
}

#[test]
fn one_bend_under_a_sky_is_the_sky_in_the_bent_direction() {
    let mut scene = empty(0.0);
    sky(&mut scene);
    let ball = clear(&mut scene, 1.5, Rgb::ZERO);
    sphere(&mut scene, Vec3::ZERO, 0.9, ball);
    let eye = scene.camera.eye.as_dvec3();
    for (name, outcome) in outcomes(&scene, &by(RefractionModel::MapOne)) {
        // By hand: towards the middle light is not bent, and sees the sky behind the ball.
        let report = outcome.body_maps.as_ref().expect("it was asked for");
        assert_eq!((report.maps.list.len(), report.traced), (1, 0), "{name}");
        let towards = (-eye).normalize();
        let straight = match scene.environment {
            Environment::Gradient { nadir, horizon, zenith } => {
                let end = if towards.y > 0.0 { zenith } else { nadir };
                horizon.lerp(end, towards.y.abs() as f32)
            }
            _ => unreachable!("it is a gradient"),
        };
        let middle = 24 * 48 + 24;
        let off = outcome.film.pixels[middle].iter().zip(straight.to_array()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f32::max) < 0.03, "{name}: {:?} and {straight}", outcome.film.pixels[middle]);
    }
}

#[test]
fn two_bends_in_a_slab_under_a_sky_are_none() {
    // Light leaves a slab as it came, so that the sky behind it is seen as without it.
    let mut scene = empty(0.0);
    sky(&mut scene);
    let bare_sky = native(&scene, &Options::default()).film;
    let slab = clear(&mut scene, 1.5, Rgb::ZERO);
    cuboid(&mut scene, Vec3::new(-4.0, -4.0, -0.2), Vec3::new(4.0, 4.0, 0.2), slab);
    for (name, outcome) in outcomes(&scene, &by(RefractionModel::MapTwo)) {
        // The second interface reflects 4 to 5 % back, which is counted as truncated.
        let film = &outcome.film;
        for p in 0..film.pixels.len() {
            let [r, want] = [film.pixels[p], bare_sky.pixels[p]];
            let ended = outcome.truncated.pixels[p];
            for c in 0..3 {
                assert!((0.03..0.06).contains(&ended[c]), "{name}: {ended:?}");
                let whole = r[c] / (1.0 - ended[c]);
                assert!((whole - want[c]).abs() < 0.01, "{name}: pixel {p}: {r:?} for {want:?}");
            }
        }
    }
}

#[test]
fn two_bends_in_a_ball_are_nearer_to_the_traced_picture_than_one() {
    let mut scene = empty(0.0);
    sky(&mut scene);
    let ball = clear(&mut scene, 1.5, Rgb::new(0.3, 0.1, 0.05));
    sphere(&mut scene, Vec3::ZERO, 0.9, ball);
    let squares = |a: &vitrum::image::Film, b: &vitrum::image::Film| {
        (0..a.pixels.len()).map(|p| f64::from(difference(a, b, p)).powi(2)).sum::<f64>()
    };
    let traced = native(&scene, &Options::default()).film;
    for ((name, one), (_, two)) in
        outcomes(&scene, &by(RefractionModel::MapOne)).iter().zip(outcomes(&scene, &by(RefractionModel::MapTwo)))
    {
        let (one, two) = (squares(&one.film, &traced), squares(&two.film, &traced));
        assert!(two < 0.3 * one, "{name}: {two} by two bends, {one} by one");
    }
}

#[test]
fn renderers_agree_on_bodies_in_maps_and_rays_without_one_are_counted() {
    let mut scene = empty(0.0);
    sky(&mut scene);
    let grey = Colour::Constant(Rgb::splat(0.6));
    let floor = material(&mut scene, Material { diffuse: grey, ..Material::default() });
    plane(&mut scene, Vec3::new(0.0, -1.0, 0.0), Vec3::Y, floor);
    let glass = clear(&mut scene, 1.5, Rgb::ZERO);
    sphere(&mut scene, Vec3::new(-0.6, -0.2, 0.0), 0.7, glass);
    cuboid(&mut scene, Vec3::new(0.4, -0.9, -0.5), Vec3::new(1.2, 0.2, 0.4), glass);
    let water = clear(&mut scene, 1.33, Rgb::ZERO);
    plane(&mut scene, Vec3::new(0.0, -0.95, 0.0), Vec3::Y, water);
    scene.lights.push(Light {
        name: String::from("lamp"),
        kind: LightKind::Point { position: Vec3::new(1.0, 4.0, 3.0) },
        intensity: Rgb::splat(14.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    for model in [RefractionModel::MapOne, RefractionModel::MapTwo] {
        let all = outcomes(&scene, &by(model));
        let (_, first) = &all[0];
        for (name, outcome) in &all {
            let report = outcome.body_maps.as_ref().expect("it was asked for");
            // The surface of the water has no centre.
            assert_eq!(report.maps.without, [(3, "has no centre")], "{name}");
            assert!(report.traced > 0, "{name}");
            let far = (0..48 * 48).filter(|&p| difference(&outcome.film, &first.film, p) > 1e-3).count();
            assert!(far <= 12, "{name}: {far} pixels differ by up to {}", most(&outcome.film, &first.film));
        }
    }
}

#[test]
fn a_body_that_disperses_light_is_traced_or_refused_by_name() {
    let mut scene = empty(0.0);
    sky(&mut scene);
    let prism = clear(&mut scene, 1.6, Rgb::ZERO);
    scene.media.last_mut().expect("just added").dispersion = Dispersion::Cauchy([1.5626, 0.013, 0.0]);
    sphere(&mut scene, Vec3::ZERO, 0.9, prism);
    let error =
        reference::render(&scene, &by(RefractionModel::MapOne), &Observer::default()).expect_err("it disperses");
    let told = error.to_string();
    assert!(told.contains("--refraction map-one: `object 0` disperses light"), "{told}");
    // Beside a body with a map it is traced.
    let glass = clear(&mut scene, 1.5, Rgb::ZERO);
    sphere(&mut scene, Vec3::new(3.0, 0.0, -3.0), 0.5, glass);
    for (name, outcome) in outcomes(&scene, &by(RefractionModel::MapOne)) {
        let report = outcome.body_maps.as_ref().expect("it was asked for");
        assert_eq!((report.maps.list.len(), report.maps.without.clone()), (1, vec![(0, "disperses light")]), "{name}");
    }
}
