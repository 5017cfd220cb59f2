//! The Fresnel equations by answers known beforehand and by their laws.

use super::sample::Rng;
use vitrum::math::{FUSED, Real};
use vitrum::optics::{AtNormal, Boundary, Crossing, Exact, FresnelFormula, Schlick, polarised, thin_reflectance};

fn exact<R: Real>(n1: f64, n2: f64, c: R) -> R {
    let boundary = Boundary::new(n1, n2);
    Exact::dielectric(&boundary, &boundary.cross(c))
}

fn cosine(degrees: f64) -> f32 {
    degrees.to_radians().cos() as f32
}

/// Case FR-17 of the catalogue.
#[test]
fn mitsubas_golden_values_come_out() {
    // Mitsuba 3, test_fresnel.py (after hyperphysics.phy-astr.gsu.edu) and test_dielectric.py.
    let golden = [
        (1.0, 1.5, 0.0, 0.04),
        (1.5, 1.0, 0.0, 0.04),
        (1.0, 1.5, 90.0, 1.0),
        (1.5, 1.0, 90.0, 1.0),
        (1.0, 1.5, 45.0, 0.5 * (0.092_013_363_045_524_42_f64.powi(2) + 0.303_337_045_290_423_5_f64.powi(2))),
        (1.5, 1.0, 45.0, 1.0),
        (1.5, 1.0, 10.0, 0.5 * (0.190_467_971_977_794_05_f64.powi(2) + 0.209_494_319_638_520_14_f64.powi(2))),
        (1.0, 1.5, 80.0, 0.387_704_354_691_473),
    ];
    for (n1, n2, degrees, want) in golden {
        let got = exact(n1, n2, cosine(degrees));
        assert!((f64::from(got) - want).abs() <= 1e-6, "{n1} -> {n2} at {degrees}: {got}, not {want}");
        let wide = exact(n1, n2, degrees.to_radians().cos());
        assert!((wide - want).abs() <= 1e-12, "{n1} -> {n2} at {degrees} in f64: {wide}, not {want}");
    }
    // The refracted angles of the same page.
    for (n1, n2, degrees, want) in [(1.0, 1.5, 45.0, 28.125_505_702_055_7), (1.5, 1.0, 10.0, 15.098_086_605_159_006)] {
        let at = Boundary::<f64>::new(n1, n2).cross(f64::to_radians(degrees).cos());
        assert!((at.cos_t.acos().to_degrees() - want).abs() < 1e-9);
    }
}

/// Case FR-03 of the catalogue.
#[test]
fn glass_reflects_four_percent_head_on_and_all_at_grazing() {
    assert!((exact(1.0, 1.5, 1.0_f32) - 0.04).abs() < 1e-8);
    assert!((exact(1.5, 1.0, 1.0_f32) - 0.04).abs() < 1e-8);
    assert!((exact(1.0, 1.33, 1.0_f64) - (0.33_f64 / 2.33).powi(2)).abs() < 1e-16);
    assert_eq!(exact(1.0, 1.5, 0.0_f32), 1.0);
    assert_eq!(exact(1.5, 1.0, 0.0_f32), 1.0);
}

/// Cases FR-03, FR-10 of the catalogue.
#[test]
fn at_brewsters_angle_the_parallel_part_vanishes() {
    for (n1, n2) in [(1.0, 1.5), (1.5, 1.0), (1.0, 1.33), (2.42, 1.0), (1.0, 1.0003)] {
        let brewster = f64::atan2(n2, n1);
        let boundary = Boundary::<f32>::new(n1, n2);
        let r = polarised(&boundary, &boundary.cross(brewster.cos() as f32));
        assert!(r.p <= 1e-12, "{n1} -> {n2}: {}", r.p);
        // s alone: ((n1^2 - n2^2) / (n1^2 + n2^2))^2.
        let want = ((n1 * n1 - n2 * n2) / (n1 * n1 + n2 * n2)).powi(2);
        assert!((f64::from(r.s) - want).abs() <= 1.2e-6 * want);
        let wide = Boundary::<f64>::new(n1, n2);
        assert!(polarised(&wide, &wide.cross(brewster.cos())).p <= 1e-30);
    }
}

/// Case FR-02 of the catalogue.
#[test]
fn equal_indices_reflect_exactly_nothing_by_any_formula() {
    for n in [1.0, 1.33, 1.5, 2.42] {
        let boundary = Boundary::<f32>::new(n, n);
        for k in 0..=1000 {
            let at = boundary.cross(k as f32 / 1000.0);
            assert_eq!(Exact::dielectric(&boundary, &at), 0.0);
            assert_eq!(Schlick::dielectric(&boundary, &at), 0.0);
            assert_eq!(AtNormal::dielectric(&boundary, &at), 0.0);
            assert_eq!((polarised(&boundary, &at).s, polarised(&boundary, &at).p), (0.0, 0.0));
            assert!(!at.total);
        }
    }
}

/// Case FR-12 of the catalogue.
#[test]
fn reflectance_and_transmittance_add_up_to_one_to_the_bit() {
    let mut rng = Rng::new(7);
    for _ in 0..200_000 {
        let r = rng.unit().powi(4) as f32;
        assert_eq!(r + (1.0 - r), 1.0, "{r:e}");
    }
    for (n1, n2) in super::fresnel_accuracy::pairs() {
        let boundary = Boundary::<f32>::new(n1, n2);
        for k in 0..20_000 {
            let at = boundary.cross(k as f32 / 20_000.0);
            for r in [Exact::dielectric(&boundary, &at), Schlick::dielectric(&boundary, &at)] {
                assert!((0.0..=1.0).contains(&r));
                assert_eq!(r + (1.0 - r), 1.0);
                let thin = thin_reflectance(r);
                assert!((r..=1.0).contains(&thin), "a pane reflects no less than one face of it: {r}, {thin}");
            }
        }
    }
}

/// Case FR-11 of the catalogue.
#[test]
fn reflectance_is_the_same_from_both_sides() {
    let mut worst = 0.0_f64;
    for (n1, n2) in [(1.0, 1.5), (1.0, 1.33), (1.0, 2.42), (1.33, 1.5), (1.0, 1.0003)] {
        let there = Boundary::<f32>::new(n1, n2);
        let critical = (1.0 - (n1 / n2) * (n1 / n2)).sqrt();
        for k in 100..=10_000 {
            let at = there.cross(k as f32 / 10_000.0);
            // Near the critical angle of the way back the reflectance changes faster than an f32 cosine can say.
            if at.cos_i < 0.02 {
                continue;
            }
            let r = f64::from(Exact::dielectric(&there, &at));
            let back = f64::from(exact(n2, n1, at.cos_t));
            // A rounding of cos_t moves the way back by this much.
            let slope =
                (f64::from(exact(n2, n1, at.cos_t.next_up())) - f64::from(exact(n2, n1, at.cos_t.next_down()))).abs();
            let off = (r - back).abs() / r;
            // And so does rounding the square of it, where products are not fused.
            let past_critical = (f64::from(at.cos_t) - critical).max(1e-7);
            let unfused = if FUSED { 0.0 } else { 4e-7 / past_critical.sqrt() };
            assert!(off <= 2e-6 + slope / r + unfused, "{n1}, {n2} at {}: {r} and {back}", at.cos_i);
            if at.cos_i > 0.6 && n2 / n1 > 1.3 {
                worst = worst.max(off);
            }
        }
    }
    println!("reciprocity: {worst:.1e}");
    assert!(worst <= 2e-6, "{worst:e}");
}

/// Case FR-09 of the catalogue.
#[test]
fn reflectance_rises_with_the_angle_up_to_index_ratio_three_point_seven() {
    let sweep = |n: f64| (0..=20_000).map(move |k| exact(1.0, n, 1.0 - f64::from(k) / 20_000.0));
    for n in [1.0003, 1.1, 1.33, 1.5, 2.0, 2.42, 3.0, 3.5, 3.7] {
        let rises = sweep(n).zip(sweep(n).skip(1)).all(|(a, b)| b >= a - 1e-15);
        assert!(rises, "index {n}");
    }
    // Beyond 2 + sqrt(3) it dips first; minima by an independent scan in 80-bit arithmetic.
    for (n, least, degrees) in [(3.8, 0.3401, 43.6), (4.0, 0.3578, 57.5), (5.0, 0.4132, 73.0), (6.0, 0.4412, 77.8)] {
        let (angle, r) = (0..9000)
            .map(|k| f64::from(k) / 100.0)
            .map(|a| (a, exact(1.0, n, a.to_radians().cos())))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("not empty");
        assert!((r - least).abs() < 6e-5 && (angle - degrees).abs() < 0.1, "index {n}: {r} at {angle}");
    }
}

/// Case FR-04 of the catalogue.
#[test]
fn cosines_that_rounding_put_outside_count_as_the_nearer_end() {
    for (n1, n2) in super::fresnel_accuracy::pairs() {
        for (outside, end) in [(1.0_f32 + 2.0 * f32::EPSILON, 1.0_f32), (1.001, 1.0_f32), (-1e-8, 0.0), (-0.5, 0.0)] {
            assert_eq!(exact(n1, n2, outside).to_bits(), exact(n1, n2, end).to_bits(), "{n1} -> {n2} at {outside}");
        }
        // What is not a number reflects everything rather than spreading.
        assert!(exact(n1, n2, f32::NAN) >= 1.0 - 3e-7);
    }
}

/// Case FR-08 of the catalogue.
#[test]
fn reflectance_reaches_one_without_a_step_at_the_critical_angle() {
    for n1 in [1.33, 1.5, 2.42] {
        let critical = super::sample::critical_angle(n1, 1.0);
        let boundary = Boundary::<f64>::new(n1, 1.0);
        let at = |below: f64| boundary.cross((critical - below).cos());
        type Reflectance = fn(&Boundary<f64>, &Crossing<f64>) -> f64;
        for formula in [Exact::dielectric as Reflectance, Schlick::dielectric as Reflectance] {
            assert!(formula(&boundary, &at(1e-4)) >= 0.75);
            assert!(formula(&boundary, &at(1e-8)) >= 0.99);
            let mut last = 0.0;
            for k in (0..1000).rev() {
                let r = formula(&boundary, &at(1e-2 * f64::from(k) / 1000.0));
                assert!(r >= last, "index {n1}");
                last = r;
            }
        }
        assert_eq!(exact(n1, 1.0, (critical + 1e-6).cos()), 1.0);
    }
}
