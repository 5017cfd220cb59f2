//! The tables of formulas: they show again what was measured elsewhere, or say why not.

use crate::support;

use glam::Vec3;
use support::{Rng, shapes};
use vitrum::math::FUSED;
use vitrum::study::formulas::{Formula, FormulaKind, FormulaPlan, csv, measure, text};

fn measured(kinds: &[FormulaKind], count: usize) -> Vec<Formula> {
    measure(&FormulaPlan { count, time: false, kinds: kinds.to_vec() }, || true).expect("nobody interrupts a test")
}

fn worst(formulas: &[Formula], name: &str, range: &str) -> f64 {
    let formula = formulas.iter().find(|f| f.name == name).expect("a formula");
    formula.ranges.iter().find(|e| e.range == range).expect("a range").worst.absolute
}

#[test]
fn figures_noted_elsewhere_come_out_within_a_factor_of_two_or_the_reason_is_given() {
    let formulas = measured(
        &[FormulaKind::Refraction, FormulaKind::Fresnel, FormulaKind::Reflection, FormulaKind::Reciprocal],
        3000,
    );
    let (mut agree, mut differ) = (0, 0);
    for formula in &formulas {
        for errors in &formula.ranges {
            let Some(noted) = errors.noted else { continue };
            assert_eq!(noted.agrees(), noted.why.is_empty(), "{}, {}: {noted:?}", formula.name, errors.range);
            if noted.agrees() {
                agree += 1;
            } else {
                differ += 1;
                println!(
                    "{}, {}: {:.1e} for {:.1e}: {}",
                    formula.name, errors.range, noted.ours, noted.value, noted.why
                );
            }
            // Whatever the reason, none is an order of magnitude worse.
            assert!(noted.ours <= 8.0 * noted.value, "{}, {}: {noted:?}", formula.name, errors.range);
        }
    }
    println!("{agree} agree, {differ} do not");
    assert!(agree >= 3 * differ, "{agree} agree, {differ} do not");
}

#[test]
fn formulas_differ_where_theory_says_and_by_as_much() {
    let formulas = measured(&[FormulaKind::Refraction, FormulaKind::Fresnel], 4000);
    // The stable form keeps its digits one ulp from matched indices, where the others lose them.
    let beside = "1 to 1 + an ulp";
    if FUSED {
        assert!(worst(&formulas, "stable", beside) < 1.5e-7);
    }
    assert!(worst(&formulas, "bec", beside) > 1e-5 && worst(&formulas, "heckbert", beside) > 5e-6);
    // Angles lose half of theirs near the normal.
    assert!(worst(&formulas, "trigonometric", "air to glass, near normal") > 1e-5);
    assert!(worst(&formulas, "heckbert", "air to glass, near normal") < 1.5e-7);
    // Oliveira's printed constant halves the angle: 7.08 degrees off at 30 in water.
    let off = worst(&formulas, "oliveira=1", "air to water at 30 degrees").to_degrees();
    assert!((off - 7.08).abs() < 0.01, "{off}");
    // Schlick's worst cases.
    for (range, off) in [("air to glass, all angles", 0.0357), ("water to glass, all angles", 0.174)] {
        let got = worst(&formulas, "schlick", range);
        assert!((got - off).abs() < 0.02 * off, "{range}: {got}");
    }
}

#[test]
fn tight_triangle_tests_lose_no_ray_and_the_others_do_where_they_are_aimed() {
    let formulas = measured(&[FormulaKind::Triangle], 400);
    for formula in &formulas {
        for errors in &formula.ranges {
            let lost = errors.misjudged;
            match formula.name.as_str() {
                "watertight" | "certified" => assert_eq!(lost, 0.0, "{} in {}", formula.name, errors.range),
                "pluecker" => assert!(lost < 0.01, "{lost} in {}", errors.range),
                _ => {}
            }
        }
    }
    let lost = |name: &str, range: &str| {
        let formula = formulas.iter().find(|f| f.name == name).expect("a test");
        formula.ranges.iter().find(|e| e.range == range).expect("a range").misjudged
    };
    for name in ["moller-trumbore", "plane-area"] {
        assert_eq!(lost(name, "bumps, random"), 0.0);
        assert!(lost(name, "bumps, edges") > 0.02 && lost(name, "ball, corners") > 0.02, "{name}");
    }
    // Aimed rays are settled in f64, random ones hardly ever.
    let certified = formulas.iter().find(|f| f.name == "certified").expect("a test");
    assert!(certified.ranges[0].settled < 0.01 && certified.ranges[1].settled > 0.9);
}

#[test]
fn the_tables_are_the_same_in_every_run_fit_eighty_columns_and_hold_every_range() {
    let formulas = measured(&FormulaKind::ALL, 64);
    let table = text(&formulas);
    assert_eq!(table, text(&measured(&FormulaKind::ALL, 64)));
    for line in table.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    let lines = csv(&formulas).lines().count();
    assert_eq!(lines, 1 + formulas.iter().map(|f| f.ranges.len()).sum::<usize>());
}

#[test]
fn what_is_timed_takes_some_time() {
    let plan = FormulaPlan { count: 8, time: true, kinds: vec![FormulaKind::Reciprocal] };
    for formula in measure(&plan, || true).expect("nobody interrupts a test") {
        let time = formula.time.expect("it was timed");
        assert!(time.eight > 0.0 && time.one > 0.0 && time.double > 0.0, "{}: {time:?}", formula.name);
    }
    assert!(measure(&plan, || false).is_err(), "and it can be stopped");
}

/// Möller and Trumbore's test, its dot products fused or not.
fn moller_trumbore(fused: bool, origin: Vec3, dir: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let dot = |p: Vec3, q: Vec3| match fused {
        true => p.x.mul_add(q.x, p.y.mul_add(q.y, p.z * q.z)),
        false => p.x * q.x + p.y * q.y + p.z * q.z,
    };
    let cross = |p: Vec3, q: Vec3| Vec3::new(p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x);
    let (first, second, from) = (b - a, c - a, origin - a);
    let (p, q) = (cross(dir, second), cross(from, first));
    let scale = 1.0 / dot(first, p);
    let (u, v, t) = (dot(from, p) * scale, dot(dir, q) * scale, dot(second, q) * scale);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0
}

/// The reason given for figures beyond those noted, tried: without fused products they come out as noted, 5 to 6 %.
#[test]
fn fused_products_are_why_moller_trumbore_loses_more_rays_at_corners_than_noted() {
    let ball = shapes::closed_sphere(20, 0.1, 1.0, Vec3::ZERO);
    let corners: Vec<[Vec3; 3]> = (0..ball.triangles.len()).map(|i| ball.corners(i)).collect();
    let mut rng = Rng::new(73);
    let rays: Vec<(Vec3, Vec3)> = (0..2000)
        .map(|_| {
            let origin = rng.direction() * rng.unit() * 0.5;
            (origin, corners[rng.below(corners.len())][0] - origin)
        })
        .collect();
    let [plain, fused] = [false, true].map(|fused| {
        let lost = |&&(origin, dir): &&(Vec3, Vec3)| !corners.iter().any(|&c| moller_trumbore(fused, origin, dir, c));
        rays.iter().filter(lost).count() as f64 / rays.len() as f64
    });
    assert!((0.03..0.11).contains(&plain) && fused > 0.15, "{plain} without, {fused} with");
}
