//! Every ray/triangle test against answers by hand, its own lanes, and `f64`.

use crate::support;

use std::any::type_name;

use glam::Vec3;
use support::Rng;
use vitrum::geometry::triangle_test::{Certified, MollerTrumbore, PlaneArea, Pluecker, TriangleTest, Watertight};
use vitrum::geometry::{Ray, intersect_triangle};
use vitrum::math::Vector3;
use vitrum::simd::{F32x8, Vec3x8};

fn meet<T: TriangleTest>(origin: Vec3, dir: Vec3, corners: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let ray = T::prepare::<f32>(origin.into(), dir.into());
    let met = T::meet(&ray, &corners.map(Vector3::from));
    met.hit.then_some((met.t, met.u, met.v))
}

fn meet64<T: TriangleTest>(origin: Vec3, dir: Vec3, corners: [Vec3; 3]) -> Option<(f64, f64, f64)> {
    let ray = T::prepare::<f64>(origin.as_dvec3().into(), dir.as_dvec3().into());
    let met = T::meet(&ray, &corners.map(|p| Vector3::from(p.as_dvec3())));
    met.hit.then_some((met.t, met.u, met.v))
}

const FLAT: [Vec3; 3] = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(8.0, 0.0, 2.0), Vec3::new(0.0, 4.0, 2.0)];

fn by_hand<T: TriangleTest>() {
    let name = type_name::<T>();
    // Inside, at half the length of the direction: weights belong to the second and third corner.
    assert_eq!(meet::<T>(Vec3::new(2.0, 0.5, 0.0), Vec3::Z * 0.5, FLAT), Some((4.0, 0.25, 0.125)), "{name}");
    // From the other face, and behind: the line counts, the caller looks at t.
    assert_eq!(meet::<T>(Vec3::new(2.0, 0.5, 4.0), -Vec3::Z, FLAT), Some((2.0, 0.25, 0.125)), "{name}");
    assert_eq!(meet::<T>(Vec3::new(2.0, 0.5, 4.0), Vec3::Z, FLAT), Some((-2.0, 0.25, 0.125)), "{name}");
    // Corners and edges count as inside where the numbers are exact.
    for (k, weights) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].into_iter().enumerate() {
        assert_eq!(meet::<T>(FLAT[k] - Vec3::Z, Vec3::Z, FLAT), Some((1.0, weights.0, weights.1)), "{name}");
        let middle = (FLAT[k] + FLAT[(k + 1) % 3]) * 0.5;
        assert!(meet::<T>(middle - Vec3::Z, Vec3::Z, FLAT).is_some(), "{name}: edge {k}");
    }
    // Beside it.
    for aside in [Vec3::new(-0.01, 1.0, 0.0), Vec3::new(1.0, -0.01, 0.0), Vec3::new(4.1, 2.0, 0.0)] {
        assert_eq!(meet::<T>(aside, Vec3::Z, FLAT), None, "{name} at {aside}");
    }
    // Within its plane, and parallel to it.
    assert_eq!(meet::<T>(Vec3::new(-1.0, 1.0, 2.0), Vec3::X, FLAT), None, "{name}");
    assert_eq!(meet::<T>(Vec3::new(-1.0, 1.0, 1.0), Vec3::X, FLAT), None, "{name}");
    // Grazing: a slope of a thousandth, exactly through (2, 1, 2).
    let grazing = meet::<T>(Vec3::new(-1022.0, 1.0, 1.0), Vec3::new(1024.0, 0.0, 1.0), FLAT);
    let (t, u, v) = grazing.expect("through the middle");
    assert!((t - 1.0).abs() < 1e-6 && (u - 0.25).abs() < 1e-4 && (v - 0.25).abs() < 1e-4, "{name}: {t} {u} {v}");
    // Corners that coincide.
    let [a, b, _] = FLAT;
    for corners in [[a, a, b], [a, b, a], [b, a, a], [a, a, a]] {
        assert_eq!(meet::<T>(Vec3::new(3.0, 0.0, 0.0), Vec3::Z, corners), None, "{name}: {corners:?}");
    }
    // Empty slots of a leaf.
    assert_eq!(meet::<T>(Vec3::ZERO, Vec3::Z, [Vec3::NAN; 3]), None, "{name}");
}

#[test]
fn every_test_gives_the_answers_by_hand() {
    by_hand::<PlaneArea>();
    by_hand::<MollerTrumbore>();
    by_hand::<Pluecker>();
    by_hand::<Watertight>();
    by_hand::<Certified>();
}

/// Triangles and rays at their insides, edges, corners, or anywhere.
fn drawn(rng: &mut Rng, i: usize) -> (Vec3, Vec3, [Vec3; 3]) {
    let corners = [rng.point(), rng.point(), rng.point()];
    let origin = rng.point() * 3.0;
    let [a, b, c] = corners;
    let target = match i % 4 {
        0 => a + (b - a) * rng.unit(),
        1 => c,
        2 => a * 0.5 + b * 0.25 + c * 0.25,
        _ => rng.point(),
    };
    (origin, target - origin, corners)
}

fn eight_lanes_agree<T: TriangleTest>() {
    let mut rng = Rng::new(11);
    for i in 0..2000 {
        let eight: [_; 8] = std::array::from_fn(|k| drawn(&mut rng, i + k));
        let pack = |f: &dyn Fn(usize) -> Vec3| {
            let mut v = Vec3x8::splat(Vec3::ZERO);
            (0..8).for_each(|k| v.set_lane(k, f(k)));
            v
        };
        let ray = T::prepare::<F32x8>(pack(&|k| eight[k].0), pack(&|k| eight[k].1));
        let corners: [Vec3x8; 3] = std::array::from_fn(|c| pack(&|k| eight[k].2[c]));
        let met = T::meet(&ray, &corners);
        for (k, &(origin, dir, corners)) in eight.iter().enumerate() {
            let one = meet::<T>(origin, dir, corners);
            assert_eq!(met.hit.lane(k), one.is_some(), "{}: lane {k}", type_name::<T>());
            if let Some((t, u, v)) = one {
                let lane = (F32x8::lane(&met.t, k), F32x8::lane(&met.u, k), F32x8::lane(&met.v, k));
                assert_eq!(lane, (t, u, v), "{}: lane {k}", type_name::<T>());
            }
        }
    }
}

#[test]
fn one_lane_gives_the_bits_of_eight() {
    eight_lanes_agree::<PlaneArea>();
    eight_lanes_agree::<MollerTrumbore>();
    eight_lanes_agree::<Pluecker>();
    eight_lanes_agree::<Watertight>();
    eight_lanes_agree::<Certified>();
}

#[test]
fn the_watertight_type_is_the_renderers_own_test() {
    let mut rng = Rng::new(12);
    let mut hits = 0;
    for i in 0..100_000 {
        let (origin, dir, corners) = drawn(&mut rng, i);
        let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, dir) };
        let own = intersect_triangle(&ray, corners);
        assert_eq!(meet::<Watertight>(origin, dir, corners), own);
        hits += usize::from(own.is_some());
    }
    assert!(hits > 30_000, "{hits}");
}

#[test]
fn the_certified_verdict_is_that_of_f64_wherever_a_ray_is_aimed() {
    let mut rng = Rng::new(13);
    let (mut hits, mut others) = (0, 0);
    for i in 0..100_000 {
        let (origin, dir, corners) = drawn(&mut rng, i);
        let exact = meet64::<Watertight>(origin, dir, corners);
        let certified = meet::<Certified>(origin, dir, corners);
        assert_eq!(certified.is_some(), exact.is_some(), "{origin} {dir} {corners:?}");
        hits += usize::from(certified.is_some());
        others += usize::from(meet::<MollerTrumbore>(origin, dir, corners).is_some() != exact.is_some());
        if let Some((t, u, v)) = certified {
            let along = corners.map(|p| (p - origin).dot(dir) / dir.length_squared());
            let (low, high) = (along.into_iter().fold(f32::MAX, f32::min), along.into_iter().fold(f32::MIN, f32::max));
            let slack = 4e-6 * low.abs().max(high.abs());
            assert!(low - slack <= t && t <= high + slack, "{t}, not in {low} to {high}");
            assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 4e-7, "{u} {v}");
        }
    }
    assert!(hits > 30_000 && others > 1000, "{hits} hits; the control differs {others} times");
}

#[test]
fn triangles_too_small_for_f32_products_are_still_certified() {
    for exponent in [-30, -20, -10, 0, 10] {
        let s = 10_f32.powi(exponent);
        let corners = [Vec3::new(-s, -s, s), Vec3::new(s, -s, s), Vec3::new(0.0, s, s)];
        let (t, u, v) = meet::<Certified>(Vec3::ZERO, Vec3::Z, corners).expect("straight ahead");
        assert!((t / s - 1.0).abs() < 1e-6 && (u - 0.25).abs() < 1e-6 && (v - 0.5).abs() < 1e-6, "1e{exponent}");
        assert_eq!(meet::<Certified>(Vec3::ZERO, Vec3::new(1.01, 1.0, 1.0), corners), None);
    }
}
