//! Refraction where formulas have no direction to give.

use glam::Vec3;
use vitrum::math::Vector3;
use vitrum::optics::{Boundary, Oliveira, RefractionFormula};
use vitrum::render::{Options, RayKind};
use vitrum::scene::{Environment, Rgb};

use crate::support::{Rng, scenes};

/// RF-13: Oliveira's `i - c n` is no direction for c = -1 at normal incidence, and his constant for leaving, `-c / (1 +
/// c)`, has a pole there. For any constant the direction must be a number of unit length.
#[test]
fn oliveiras_formula_never_gives_nan_whatever_its_constant() {
    let mut rng = Rng::new(61);
    for (n1, n2) in [(1.0, 1.33), (1.33, 1.0), (1.0, 1.0), (2.42, 1.0), (1.0, 2.42)] {
        let boundary = Boundary::<f32>::new(n1, n2);
        for c in [-1.0, -0.999_999, -0.5, -0.25, 0.0, 0.33, 1.0, 2.0, -2.0, 1e6] {
            for k in 0..200 {
                let n = rng.direction();
                let i = if k % 4 == 0 { -n } else { -(n + rng.point() * 0.9).normalize() };
                let (n, i): (Vector3<f32>, Vector3<f32>) = (n.into(), i.into());
                let t = Oliveira { c }.refract(&boundary, i, n, &boundary.cross(-i.dot(n))).direction;
                assert!((t.length() - 1.0).abs() < 1e-3, "c = {c}, {n1} -> {n2}: {t:?} of {i:?} at {n:?}");
            }
        }
    }
}

/// RF-08, yocto-gl #452: total reflection has no refracted ray, not one of length zero: an eye inside glass beyond the
/// critical angle gets all its light from one reflected ray, and none is transmitted.
#[test]
fn beyond_the_critical_angle_nothing_is_transmitted_and_nothing_lost() {
    for fresnel in [vitrum::optics::FresnelModel::Exact, vitrum::optics::FresnelModel::Schlick] {
        let mut scene = scenes::empty(0.0);
        scene.environment = Environment::Constant(Rgb::ONE);
        let water = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
        scenes::plane(&mut scene, Vec3::ZERO, Vec3::Y, water);
        scene.camera.eye = Vec3::new(0.0, -1.0, 0.0);
        // 41.8 degrees off the vertical is critical; this looks 50 to 70 degrees off.
        scene.camera.target = scene.camera.eye + Vec3::new(0.0, 0.5, -(0.75_f32.sqrt()));
        scene.camera.projection = vitrum::scene::Projection::Pinhole { vfov: 20.0 };
        scene.camera.up = Vec3::Y;
        (scene.settings.width, scene.settings.height) = (16, 16);
        let outcome = scenes::native(&scene, &Options { fresnel, ..Options::default() });
        assert_eq!((outcome.rays.of(RayKind::Transmitted), outcome.rays.of(RayKind::Reflected)), (0, 256));
        // What is reflected runs down through water without end, and water that absorbs nothing shows the room.
        assert!(outcome.film.pixels.iter().all(|p| *p == [1.0; 3]));
        assert!(outcome.truncated.pixels.iter().all(|p| *p == [0.0; 3]));
    }
}
