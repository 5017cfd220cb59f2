//! The notes' misprints as negative controls: what they would give, and that our formulas do not.

use vitrum::math::Vector3;
use vitrum::optics::{Boundary, RefractionFormula, SlidesVector, polarised_as_printed};

/// Case FR-01 of the catalogue.
#[test]
fn without_the_half_glass_would_reflect_eight_percent_and_create_light() {
    let boundary = Boundary::<f64>::new(1.0, 1.5);
    let sum = |degrees: f64| {
        let r = polarised_as_printed(&boundary, &boundary.cross(degrees.to_radians().cos()));
        (r.s + r.p, r.unpolarised())
    };
    for (degrees, printed) in [(0.0, 0.08), (85.0, 1.23), (89.9, 1.98)] {
        let (bare, halved) = sum(degrees);
        assert!((bare - printed).abs() < 0.01, "{degrees}: {bare}");
        assert!((halved - printed / 2.0).abs() < 0.005 && halved <= 1.0, "{degrees}: {halved}");
    }
    assert!((sum(0.0).1 - 0.04).abs() < 1e-15);
}

/// Angle and length of `eta (i - (i . n) n) - n sqrt(1 - factor (1 - (i . n)^2))`: step 10 and step 11 of the slides
/// differ in the factor.
fn slides(eta: f64, factor: f64, degrees: f64) -> (f64, f64) {
    let (s, c) = degrees.to_radians().sin_cos();
    let (x, z) = (eta * s, -(1.0 - factor * (1.0 - c * c)).sqrt());
    (x.atan2(-z).to_degrees(), x.hypot(z))
}

#[test]
fn step_ten_of_the_slides_would_bend_light_leaving_glass_too_little() {
    let (n_i, n_t) = (1.5_f64, 1.0_f64);
    let boundary = Boundary::<f64>::new(n_i, n_t);
    for (degrees, typo, length, right) in [
        (15.0_f64, 22.26, 1.02, 22.84),
        (30.0, 43.49, 1.09, 48.59),
        (40.0, 57.40, 1.14, 74.62),
        (41.8, 59.99, 1.15, 88.85),
    ] {
        let (angle, grown) = slides(n_i / n_t, n_i / (n_t * n_t), degrees);
        assert!((angle - typo).abs() < 0.006 && (grown - length).abs() < 0.006, "{degrees}: {angle}, {grown}");
        let (s, c) = degrees.to_radians().sin_cos();
        let (i, n) = (Vector3::new(s, 0.0, -c), Vector3::new(0.0, 0.0, 1.0));
        let t = SlidesVector.refract(&boundary, i, n, &boundary.cross(c));
        assert!(!t.total);
        assert!((t.direction.x.atan2(-t.direction.z).to_degrees() - right).abs() < 0.006, "{degrees}");
        assert!((t.direction.length() - 1.0).abs() < 1e-12);
    }
    // The critical angle by the typo: 1 - 1.5 sin^2 = 0.
    assert!(((1.0_f64 / 1.5).sqrt().asin().to_degrees() - 54.74).abs() < 0.006);
    assert!(boundary.cross(41.82_f64.to_radians().cos()).total && !boundary.cross(41.80_f64.to_radians().cos()).total);
}

#[test]
fn the_typo_of_step_ten_does_not_show_from_air_which_is_why_both_ways_are_tested() {
    for degrees in [0.0, 30.0, 60.0, 89.0] {
        let (eta, typo) = (1.0 / 1.5, 1.0 / (1.5 * 1.5));
        let (angle, length) = slides(eta, typo, degrees);
        assert!((1.5 * angle.to_radians().sin() - degrees.to_radians().sin()).abs() < 1e-12);
        assert!((length - 1.0).abs() < 1e-12);
    }
}
