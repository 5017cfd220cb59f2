//! Fresnel's equations in pictures that other renderers got wrong.

use glam::Vec3;
use vitrum::optics::{Boundary, FresnelFormula, FresnelModel, Schlick, conductor_schlick};
use vitrum::render::Options;
use vitrum::scene::{Environment, Rgb};

use crate::support::scenes;

/// FR-04, FR-16: a cosine that rounding put above 1 or below 0 gives Schlick's fifth power no negative base and no NaN, for
/// dielectrics and metals.
#[test]
fn schlicks_power_takes_cosines_from_outside_their_range() {
    for c in [1.0 + f32::EPSILON, 1.001, 2.0, -f32::EPSILON, -1e-8, -0.5] {
        for (n1, n2) in [(1.0, 1.5), (1.5, 1.0), (1.0, 1.0003)] {
            let boundary = Boundary::<f32>::new(n1, n2);
            let r = Schlick::dielectric(&boundary, &boundary.cross(c));
            assert!((0.0..=1.0).contains(&r), "{n1} -> {n2} at {c}: {r}");
        }
        assert!(c < 0.0 || (0.0..=1.0).contains(&conductor_schlick(c, 0.2, 3.9)));
        assert!((0.0..=1.0).contains(&<vitrum::optics::Exact as FresnelFormula>::conductor(c, 0.2, 3.9)));
    }
}

/// FR-02, FR-05, three-gpu-pathtracer #429: glass of index 1.0 came out black where 1.0000001 did not. Indices at and a
/// few ulp around that of the room leave the picture as it is, by every formula.
#[test]
fn an_index_of_one_or_nearly_so_is_invisible() {
    let mut empty = scenes::empty(0.0);
    empty.environment =
        Environment::Gradient { nadir: Rgb::X, horizon: Rgb::new(0.2, 0.9, 0.4), zenith: Rgb::new(0.3, 0.1, 1.0) };
    let bare = scenes::native(&empty, &Options::default()).film;
    let ulp = f64::from(f32::EPSILON);
    for ior in [1.0, 1.0 + 1e-15, 1.000_000_1, 1.0 + ulp, 1.0 - ulp, 1.0 - 1e-12] {
        for fresnel in [FresnelModel::Exact, FresnelModel::Off] {
            let mut scene = empty.clone();
            let same = scenes::glass(&mut scene, ior, 0, Rgb::ZERO);
            scenes::sphere(&mut scene, Vec3::ZERO, 0.9, same);
            scenes::cuboid(&mut scene, Vec3::new(1.0, -0.5, -0.5), Vec3::new(1.9, 0.5, 0.5), same);
            let outcome = scenes::native(&scene, &Options { fresnel, ..Options::default() });
            assert_eq!((outcome.non_finite, outcome.unmatched_exits), (0, 0), "{ior}");
            for (a, b) in outcome.film.pixels.iter().zip(&bare.pixels) {
                for k in 0..3 {
                    assert!((a[k] - b[k]).abs() <= 5e-4, "{ior} {fresnel:?}: {a:?} for {b:?}");
                }
            }
        }
    }
}
