//! Beer-Lambert absorption.

use vitrum::math::Vector3;
use vitrum::optics::{absorption_from_colour, transmittance};

#[test]
fn a_colour_at_a_distance_comes_back_at_that_distance_and_squared_at_twice_it() {
    let colour = glam::Vec3::new(0.25, 0.9, 1.0);
    for distance in [1e-3_f32, 0.5, 1.0, 40.0] {
        let sigma = Vector3::from(absorption_from_colour(colour, distance));
        let once = transmittance(sigma, distance);
        let twice = transmittance(sigma, 2.0 * distance);
        for (t, c) in [(once.x, 0.25_f32), (once.y, 0.9), (once.z, 1.0)] {
            assert!((t - c).abs() <= 4e-7, "{t}, not {c}");
        }
        for (t, c) in [(twice.x, 0.0625_f32), (twice.y, 0.81), (twice.z, 1.0)] {
            assert!((t - c).abs() <= 8e-7, "{t}, not {c}");
        }
    }
}

/// Case AB-01 of the catalogue.
#[test]
fn an_infinite_distance_leaves_nothing_or_everything_and_never_nan() {
    let t = transmittance(Vector3::new(0.0_f32, 1e-30, 7.0), f32::INFINITY);
    assert_eq!(t, Vector3::new(1.0, 0.0, 0.0));
    let t = transmittance(Vector3::new(0.0_f64, 1e-30, 7.0), f64::INFINITY);
    assert_eq!(t, Vector3::new(1.0, 0.0, 0.0));
}

/// Case AB-03 of the catalogue.
#[test]
fn black_and_white_and_extreme_distances_give_finite_coefficients() {
    for distance in [1e-45_f32, 1.0, f32::MAX] {
        let sigma = absorption_from_colour(glam::Vec3::new(0.0, 1.0, f32::NAN), distance);
        assert!(sigma.is_finite() && sigma.min_element() >= 0.0, "{sigma} at {distance}");
        assert_eq!(sigma.y, 0.0);
    }
    let black = transmittance(Vector3::from(absorption_from_colour(glam::Vec3::ZERO, 2.0)), 2.0_f32);
    assert!(black.x > 0.0 && black.x <= 6.1e-8, "{}", black.x);
}
