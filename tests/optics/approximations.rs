//! Errors of the approximations, against tables computed independently in 80-bit arithmetic.

use super::oracle;
use vitrum::math::{Vector3, ulp};
use vitrum::optics::{
    AtNormal, Boundary, Exact, FresnelFormula, Oliveira, RefractionFormula, Schlick, StraightThrough,
};

fn both(boundary: &Boundary<f64>, cos_i: f64) -> (f64, f64) {
    let at = boundary.cross(cos_i);
    (Exact::dielectric(boundary, &at), Schlick::dielectric(boundary, &at))
}

/// Average over the hemisphere, each direction weighted by its cosine.
fn average(reflectance: impl Fn(f64) -> f64) -> f64 {
    const STEPS: i32 = 20_000;
    (0..STEPS).map(|k| reflectance(((f64::from(k) + 0.5) / f64::from(STEPS)).sqrt())).sum::<f64>() / f64::from(STEPS)
}

#[test]
fn schlicks_worst_case_and_average_are_what_theory_says() {
    // Indices, largest error, where [degrees], the exact value there, averages of exact and Schlick.
    let table = [
        (1.0, 1.0003, 0.855, 88.7, 0.038, 0.000_10, 0.0476),
        (1.0, 1.1, 0.211, 83.1, 0.320, 0.0252, 0.0498),
        (1.0, 1.33, 0.0599, 83.8, 0.513, 0.0659, 0.0667),
        (1.0, 1.5, 0.0357, 85.0, 0.611, 0.0918, 0.0857),
        (1.0, 1.8, 0.0345, 85.4, 0.654, 0.1341, 0.1254),
        (1.0, 2.42, 0.0757, 84.5, 0.597, 0.2125, 0.2118),
        (1.33, 1.0, 0.0599, 48.4, 0.513, 0.4720, 0.4724),
        (1.5, 1.0, 0.0357, 41.6, 0.611, 0.5964, 0.5937),
        (2.42, 1.0, 0.0757, 24.3, 0.597, 0.8655, 0.8654),
        (1.33, 1.5, 0.174, 83.0, 0.348, 0.0308, 0.0511),
        (1.5, 1.33, 0.174, 61.6, 0.348, 0.2381, 0.2540),
    ];
    for (n1, n2, worst, degrees, exact_there, exact_average, schlick_average) in table {
        let boundary = Boundary::<f64>::new(n1, n2);
        let at = |degrees: f64| both(&boundary, degrees.to_radians().cos());
        let (angle, off) = (0..90_000)
            .map(|k| f64::from(k) / 1000.0)
            .map(|a| (a, (at(a).1 - at(a).0).abs()))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .expect("not empty");
        println!("Schlick {n1} -> {n2}: {off:.4} at {angle:.1} degrees");
        assert!((off - worst).abs() <= 6e-4, "{n1} -> {n2}: {off}, not {worst}");
        assert!((angle - degrees).abs() <= 0.15, "{n1} -> {n2}: at {angle}, not {degrees}");
        assert!((at(angle).0 - exact_there).abs() <= 2e-3, "{n1} -> {n2}: {}", at(angle).0);
        assert!((average(|c| both(&boundary, c).0) - exact_average).abs() <= 1.5e-4, "{n1} -> {n2}");
        assert!((average(|c| both(&boundary, c).1) - schlick_average).abs() <= 1.5e-4, "{n1} -> {n2}");
    }
}

#[test]
fn schlicks_signed_error_on_glass_is_what_theory_says() {
    let boundary = Boundary::<f64>::new(1.0, 1.5);
    for (degrees, want) in [
        (0.0_f64, 0.0),
        (30.0, -0.0015),
        (45.0, -0.0082),
        (60.0, -0.0192),
        (70.0, -0.0126),
        (75.0, 0.0017),
        (80.0, 0.022),
        (85.0, 0.036),
        (89.0, 0.015),
    ] {
        let (exact, schlick) = both(&boundary, degrees.to_radians().cos());
        assert!((schlick - exact - want).abs() <= 5e-4, "{degrees}: {}", schlick - exact);
    }
}

/// Case FR-07 of the catalogue.
#[test]
fn schlick_with_the_incident_cosine_on_the_way_out_would_be_off_by_nearly_one() {
    for (n1, n2, want, degrees) in
        [(1.33, 1.0, 0.967, 48.75), (1.5, 1.0, 0.955, 41.81), (2.42, 1.0, 0.814, 24.41), (1.5, 1.33, 0.945, 62.46)]
    {
        let boundary = Boundary::<f64>::new(n1, n2);
        let c = f64::to_radians(degrees).cos();
        let with_cos_i = boundary.r0 + (1.0 - boundary.r0) * (1.0 - c).powi(5);
        // In the limit of the critical angle all is reflected; the table stops a hundredth of a degree short of it.
        assert!((1.0 - with_cos_i - want).abs() <= 0.015, "{n1} -> {n2}: {}", 1.0 - with_cos_i);
        let critical = super::sample::critical_angle(n1, n2);
        let (exact, schlick) = both(&boundary, (critical - 1e-9).cos());
        assert!((exact - schlick).abs() < 1e-3, "the rule with cos_t agrees there");
    }
}

#[test]
fn schlick_in_f32_is_within_eight_ulp_of_itself() {
    let mut worst = 0.0_f64;
    for (n1, n2) in [(1.0, 1.33), (1.0, 1.5), (1.0, 2.42), (1.33, 1.5)] {
        let boundary = Boundary::<f32>::new(n1, n2);
        let r0 = ((n1 - n2) / (n1 + n2)).powi(2);
        for k in 0..=100_000 {
            let c = k as f32 / 100_000.0;
            let want = r0 + (1.0 - r0) * (1.0 - f64::from(c)).powi(5);
            let got = Schlick::dielectric(&boundary, &boundary.cross(c));
            worst = worst.max((f64::from(got) - want).abs() / f64::from(ulp(want as f32)));
            assert!(got <= 1.0);
        }
    }
    println!("Schlick in f32: {worst:.1} ulp");
    assert!(worst <= 8.0, "{worst}");
}

#[test]
fn reflectance_off_is_the_one_at_normal_incidence_for_every_angle() {
    for (n1, n2) in [(1.0, 1.5), (1.5, 1.0)] {
        let boundary = Boundary::<f32>::new(n1, n2);
        for k in 0..=100 {
            let at = boundary.cross(k as f32 / 100.0);
            let want = if at.total { 1.0 } else { boundary.r0 };
            assert_eq!(AtNormal::dielectric(&boundary, &at), want);
        }
        assert!((boundary.r0 - 0.04).abs() < 1e-8);
    }
}

/// Refracted angle by Oliveira's formula, in degrees.
fn oliveira(c: f64, n1: f64, n2: f64, degrees: f64) -> Option<f64> {
    let (s, cos) = degrees.to_radians().sin_cos();
    let boundary = Boundary::<f64>::new(n1, n2);
    let (i, n) = (Vector3::new(s, 0.0, -cos), Vector3::new(0.0, 0.0, 1.0));
    let t = Oliveira { c }.refract(&boundary, i, n, &boundary.cross(-i.dot(n)));
    assert!((t.direction.length() - 1.0).abs() < 1e-12);
    (!t.total).then(|| t.direction.x.atan2(-t.direction.z).to_degrees())
}

fn snell(n1: f64, n2: f64, degrees: f64) -> f64 {
    let c = oracle::d(degrees.to_radians().cos());
    oracle::narrow(oracle::cos2_t(c, n1, n2)).sqrt().acos().to_degrees()
}

/// Case RF-13 of the catalogue.
#[test]
fn oliveiras_error_is_what_theory_says() {
    // Angle of incidence; errors in degrees for water with c = 1, 0.33, 0.46 and glass with c = 1, 0.5, 0.6645.
    let table = [
        (10.0, [-2.50, 0.02, -0.65, -1.65, 0.02, -0.64]),
        (20.0, [-4.90, 0.18, -1.17, -3.18, 0.18, -1.15]),
        (30.0, [-7.08, 0.61, -1.42, -4.47, 0.63, -1.38]),
        (45.0, [-9.62, 2.17, -0.91, -5.63, 2.24, -0.85]),
        (60.0, [-10.63, 5.59, 1.43, -5.26, 5.63, 1.37]),
        (75.0, [-9.07, 12.1, 6.8, -2.59, 11.8, 6.2]),
        (85.0, [-6.0, 18.8, 12.7, 0.88, 17.9, 11.3]),
    ];
    let water = [Oliveira::AS_PRINTED.c, Oliveira::first_order(1.0, 1.33).c, Oliveira::WATER.c];
    let glass = [Oliveira::AS_PRINTED.c, Oliveira::first_order(1.0, 1.5).c, Oliveira::GLASS.c];
    for (degrees, errors) in table {
        let cases = water.map(|c| (c, 1.33)).into_iter().chain(glass.map(|c| (c, 1.5)));
        for ((c, n), want) in cases.zip(errors) {
            let off = oliveira(c, 1.0, n, degrees).expect("never total on the way in") - snell(1.0, n, degrees);
            // Large errors are given to a tenth.
            let rounding = if degrees > 70.0 { 0.06 } else { 0.011 };
            assert!((off - want).abs() <= rounding, "c = {c}, index {n}, {degrees}: {off}, not {want}");
        }
    }
}

#[test]
fn oliveiras_printed_constant_halves_the_angle() {
    for degrees in [1.0, 10.0, 33.0, 60.0, 89.0] {
        let t = oliveira(Oliveira::AS_PRINTED.c, 1.0, 1.33, degrees).expect("never total on the way in");
        assert!((t - degrees / 2.0).abs() < 1e-10);
    }
}

#[test]
fn oliveiras_minimax_constants_have_their_largest_errors_equal() {
    for (Oliveira { c }, n) in [(Oliveira::WATER, 1.33), (Oliveira::GLASS, 1.5)] {
        let off = |k: i32| {
            let degrees = f64::from(k) / 10.0;
            oliveira(c, 1.0, n, degrees).expect("never total on the way in") - snell(1.0, n, degrees)
        };
        let least = (0..=600).map(off).fold(0.0, f64::min);
        let most = (0..=600).map(off).fold(0.0, f64::max);
        assert!((least + most).abs() < 0.02 && most < 1.45, "c = {c}: {least} to {most}");
    }
}

#[test]
fn oliveira_on_the_way_out_undoes_the_way_in_at_small_angles_and_never_turns_back() {
    for (n, c) in [(1.33, 0.33), (1.33, 1.0), (1.5, 0.5)] {
        let inside = oliveira(c, 1.0, n, 1.0).expect("never total on the way in");
        let outside = oliveira(c, n, 1.0, inside).expect("far from grazing");
        assert!((outside - 1.0).abs() < 1e-3, "{outside}");
        for k in 0..=900 {
            if let Some(t) = oliveira(c, n, 1.0, f64::from(k) / 10.0) {
                assert!((0.0..=90.0).contains(&t), "{t}");
            }
        }
        assert_eq!(oliveira(c, n, 1.0, 89.0), None, "it would come back out of the surface");
    }
    // Equal indices: as it was.
    let boundary = Boundary::<f32>::new(1.5, 1.5);
    let i = Vector3::new(0.6_f32, 0.0, -0.8);
    let t = Oliveira::AS_PRINTED.refract(&boundary, i, Vector3::new(0.0, 0.0, 1.0), &boundary.cross(0.8));
    assert!(t.direction == i && !t.total);
}

#[test]
fn no_refraction_at_all_is_the_incident_direction() {
    let i = Vector3::new(0.6_f32, 0.0, -0.8);
    let n = Vector3::new(0.0, 0.0, 1.0);
    for (n1, n2) in [(1.0, 1.5), (2.42, 1.0)] {
        let boundary = Boundary::<f32>::new(n1, n2);
        let t = StraightThrough.refract(&boundary, i, n, &boundary.cross(0.8));
        assert!(t.direction == i && !t.total);
    }
}
