//! The refracted direction by every formula, in both directions through the boundary.

use super::oracle::refract as oracle;
use super::sample::{Rng, bits, critical_angle, widen};
use vitrum::math::{FUSED, Vector3};
use vitrum::optics::{Bec, Boundary, Heckbert, RefractionFormula, SlidesVector, Stable, Trigonometric};

const ULP: f64 = f32::EPSILON as f64;

/// Largest angle to the oracle's direction and largest error of length, and the share of rays whose total reflection
/// was misjudged.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    angle: f64,
    length: f64,
    misjudged: f64,
}

fn refract(f: impl RefractionFormula, n1: f64, n2: f64, i: Vector3<f32>, n: Vector3<f32>) -> Option<Vector3<f32>> {
    let boundary = Boundary::<f32>::new(n1, n2);
    let at = boundary.cross(-i.dot(n));
    let refracted = f.refract(&boundary, i, n, &at);
    let d = refracted.direction;
    assert!(d.x.is_finite() && d.y.is_finite() && d.z.is_finite(), "{i:?} at {n:?}: {d:?}");
    (!refracted.total).then_some(d)
}

fn measure(f: impl RefractionFormula, n1: f64, n2: f64, angle: impl Fn(&mut Rng) -> f64) -> Worst {
    const RAYS: usize = 50_000;
    let mut rng = Rng::new(0x5ee1);
    let mut worst = Worst::default();
    for _ in 0..RAYS {
        let angle = angle(&mut rng);
        let (i, n) = rng.meeting_at(angle);
        match (refract(f, n1, n2, i, n), oracle(i, n, n1, n2)) {
            (Some(got), Some(want)) => {
                worst.angle = worst.angle.max(want.angle_to(got));
                worst.length = worst.length.max((widen(got).length() - 1.0).abs());
            }
            (None, None) => {}
            _ => worst.misjudged += 1.0 / RAYS as f64,
        }
    }
    worst
}

/// A row of the table: indices, angles, bounds in radians for trigonometry, Heckbert, Bec, the slides' vector form and
/// the stable form, and the share of rays that may be misjudged as total.
struct Row {
    name: &'static str,
    n1: f64,
    n2: f64,
    angle: fn(&mut Rng) -> f64,
    bounds: [f64; 5],
    misjudged: f64,
}

fn uniform_cosine(rng: &mut Rng) -> f64 {
    rng.unit().acos()
}

/// Angles below the critical one by at least 1e-3.
fn well_below(rng: &mut Rng, n: f64) -> f64 {
    let limit = (critical_angle(n, 1.0) - 1e-3).cos();
    rng.between(limit, 1.0).acos()
}

fn just_below(rng: &mut Rng, least: f64, most: f64) -> f64 {
    critical_angle(1.5, 1.0) - rng.between(least, most)
}

fn rows() -> Vec<Row> {
    let row = |name, n1, n2, angle, bounds, misjudged| Row { name, n1, n2, angle, bounds, misjudged };
    vec![
        row("1 -> 1.5", 1.0, 1.5, uniform_cosine, [1.5e-5, 2.2e-7, 2.2e-7, 2.2e-7, 2.2e-7], 0.0),
        row("1 -> 1.33", 1.0, 1.33, uniform_cosine, [1.5e-5, 2.2e-7, 2.2e-7, 2.2e-7, 2.2e-7], 0.0),
        row("1 -> 2.42", 1.0, 2.42, uniform_cosine, [1e-5, 1.8e-7, 1.8e-7, 1.8e-7, 1.8e-7], 0.0),
        row("1.5 -> 1, 1e-3 below", 1.5, 1.0, |r| well_below(r, 1.5), [4e-5, 8e-6, 8e-6, 8e-6, 8e-6], 0.0),
        row("2.42 -> 1, 1e-3 below", 2.42, 1.0, |r| well_below(r, 2.42), [1e-4, 2e-5, 2e-5, 2e-5, 2e-5], 0.0),
        row("1 -> 1.5 near normal", 1.0, 1.5, |r| r.between(0.0, 1e-3), [6e-4, 1.5e-7, 1.5e-7, 1.5e-7, 1.5e-7], 0.0),
        row("1 -> 1.5 normal", 1.0, 1.5, |_| 0.0, [6e-4, 1.5e-7, 1.5e-7, 1.5e-7, 1.5e-7], 0.0),
        row(
            "1 -> 1.5 grazing",
            1.0,
            1.5,
            |_| std::f64::consts::FRAC_PI_2 - 1e-6,
            [3e-7, 2.2e-7, 2.2e-7, 2.2e-7, 2.2e-7],
            0.0,
        ),
        row("critical - 1e-3", 1.5, 1.0, |r| just_below(r, 5e-4, 1e-3), [2e-5, 1.8e-5, 1.8e-5, 1.8e-5, 1.8e-5], 0.0),
        row("critical - 1e-5", 1.5, 1.0, |r| just_below(r, 5e-6, 1e-5), [2e-4, 2e-4, 2e-4, 2e-4, 2e-4], 0.0),
        row("critical - 1e-7", 1.5, 1.0, |r| just_below(r, 0.0, 1e-7), [1.4e-3; 5], if FUSED { 0.2 } else { 0.3 }),
        row("1 -> 1 + ulp", 1.0, 1.0 + ULP, uniform_cosine, [1e-4, 6e-5, 2e-4, 6e-5, 1.5e-7], 0.0),
        row("1 + ulp -> 1", 1.0 + ULP, 1.0, uniform_cosine, [5e-4, 3e-4, 6e-4, 3e-4, 3e-7], 1e-3),
        row("1 -> 1.0003", 1.0, 1.0003, uniform_cosine, [3e-5, 6e-6, 6e-6, 6e-6, 1.6e-7], 0.0),
    ]
}

/// Cases RF-01, RF-04, RF-05, RF-06 of the catalogue.
#[test]
fn every_formula_keeps_its_bound_in_every_case() {
    println!("largest angle to the oracle [rad]     trig     Heckbert Bec      slides   stable   (length)  misjudged");
    for row in rows() {
        let worst = [
            measure(Trigonometric, row.n1, row.n2, row.angle),
            measure(Heckbert, row.n1, row.n2, row.angle),
            measure(Bec, row.n1, row.n2, row.angle),
            measure(SlidesVector, row.n1, row.n2, row.angle),
            measure(Stable, row.n1, row.n2, row.angle),
        ];
        let angles: Vec<String> = worst.iter().map(|w| format!("{:.1e}", w.angle)).collect();
        let misjudged: Vec<String> = worst.iter().map(|w| format!("{:.1}%", 100.0 * w.misjudged)).collect();
        println!("{:36}  {}  ({:.1e})  {}", row.name, angles.join("  "), worst[4].length, misjudged.join(" "));
        for (k, (w, bound)) in worst.iter().zip(row.bounds).enumerate() {
            assert!(w.angle <= bound, "{}, formula {k}: {:e} is above {bound:e}", row.name, w.angle);
            assert!(w.misjudged <= row.misjudged, "{}, formula {k}: {} misjudged", row.name, w.misjudged);
        }
    }
}

/// Both ways through water, glass and diamond, and through nothing much.
const PAIRS: [(f64, f64); 8] =
    [(1.0, 1.33), (1.33, 1.0), (1.0, 1.5), (1.5, 1.0), (1.0, 2.42), (2.42, 1.0), (1.5, 1.33), (1.0, 1.0003)];

/// Rays of every angle that get through by 1e-3 rad, with their normals and refracted directions.
fn for_refracted_rays(mut check: impl FnMut(f64, f64, Vector3<f32>, Vector3<f32>, Vector3<f32>)) {
    let mut rng = Rng::new(0xbe4d);
    for (n1, n2) in PAIRS {
        let limit = if n1 > n2 { critical_angle(n1, n2) - 1e-3 } else { std::f64::consts::FRAC_PI_2 };
        for _ in 0..20_000 {
            let angle = rng.between(0.0, limit);
            let (i, n) = rng.meeting_at(angle);
            let t = refract(Stable, n1, n2, i, n).expect("below the critical angle");
            check(n1, n2, i, n, t);
        }
    }
}

/// Cases RF-11, RF-12 of the catalogue.
#[test]
fn snell_holds_and_the_three_vectors_lie_in_one_plane() {
    let (mut residual, mut out_of_plane) = (0.0_f64, 0.0_f64);
    for_refracted_rays(|n1, n2, i, n, t| {
        let (i, n, t) = (widen(i).normalized(), widen(n).normalized(), widen(t));
        let (sin_i, sin_t) = (i.cross(n).length(), t.cross(n).length());
        residual = residual.max((n1 * sin_i - n2 * sin_t).abs());
        out_of_plane = out_of_plane.max(i.cross(n).dot(t).abs());
        assert!(t.dot(n) < 0.0, "it goes on, below the surface");
    });
    println!("stable form: Snell residual {residual:.1e}, out of plane {out_of_plane:.1e}");
    assert!(residual <= 5e-7, "n1 sin i - n2 sin t = {residual:e}");
    assert!(out_of_plane <= 3e-7, "det(i, n, t) = {out_of_plane:e}");
}

/// Case RF-10 of the catalogue.
#[test]
fn light_goes_back_the_way_it_came() {
    let mut worst = 0.0_f64;
    for_refracted_rays(|n1, n2, i, n, t| {
        // Going back multiplies the error of `t` by this much, whichever way it is computed.
        let condition = (n2 / n1).max(1.0) / widen(i).dot(widen(n)).abs();
        if let Some(back) = refract(Stable, n2, n1, -t, -n) {
            let off = (widen(back) + widen(i)).length();
            assert!(off <= 6e-7 * condition, "{n1} -> {n2}: {off:e} at condition {condition}");
            if condition < 2.5 {
                worst = worst.max(off);
            }
        } else {
            assert!(condition > 1e3, "what came in can leave");
        }
    });
    println!("stable form: reversed {worst:.1e} rad");
    assert!(worst <= if FUSED { 1e-6 } else { 1.5e-6 }, "{worst:e}");
}

/// Case RF-07 of the catalogue.
#[test]
fn equal_indices_bend_nothing_to_the_bit() {
    let mut rng = Rng::new(4);
    for n in [1.0, 1.33, 1.5, 2.42, 1.0 + ULP] {
        for k in 0..1000 {
            let angle = if k == 0 { std::f64::consts::FRAC_PI_2 } else { rng.unit().acos() };
            let (i, normal) = rng.meeting_at(angle);
            assert_eq!(refract(Stable, n, n, i, normal).map(bits), Some(bits(i)));
        }
        // Exactly grazing, where the bend is 0/0 without a guard.
        let (along, up) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
        assert_eq!(refract(Stable, n, n, along, up), Some(along));
    }
}

#[test]
fn thirty_degrees_into_glass_and_out_of_it_are_the_textbook_angles() {
    type Formula = fn(f64, f64, Vector3<f32>, Vector3<f32>) -> Option<Vector3<f32>>;
    let angle = |f: Formula, n1, n2| {
        let (s, c) = 30.0_f64.to_radians().sin_cos();
        let t = f(n1, n2, Vector3::new(s as f32, 0.0, -c as f32), Vector3::new(0.0, 0.0, 1.0));
        t.map(|t| f64::from(t.x).atan2(f64::from(-t.z)).to_degrees())
    };
    for f in [
        |a, b, i, n| refract(Stable, a, b, i, n),
        |a, b, i, n| refract(Trigonometric, a, b, i, n),
        |a, b, i, n| refract(Heckbert, a, b, i, n),
        |a, b, i, n| refract(Bec, a, b, i, n),
        |a, b, i, n| refract(SlidesVector, a, b, i, n),
    ] {
        assert!((angle(f, 1.0, 1.5).expect("no total reflection") - 19.471_220_6).abs() < 1e-4);
        assert!((angle(f, 1.5, 1.0).expect("no total reflection") - 48.590_377_9).abs() < 1e-4);
        assert_eq!(angle(f, 2.42, 1.0), None, "30 degrees is beyond diamond's 24.4");
    }
}

/// Cases RF-02, RF-03 of the catalogue.
#[test]
fn head_on_goes_straight_even_where_the_cosine_rounds_above_one() {
    let mut rng = Rng::new(5);
    let mut above = 0;
    for _ in 0..20_000 {
        let (i, n) = rng.meeting_at(0.0);
        above += usize::from(-i.dot(n) > 1.0);
        for (n1, n2) in PAIRS {
            let off = |t: Option<Vector3<f32>>| (widen(t.expect("no total reflection")) - widen(i)).length();
            let (stable, angles) = (off(refract(Stable, n1, n2, i, n)), off(refract(Trigonometric, n1, n2, i, n)));
            assert!(stable < 1e-6, "{n1} -> {n2}: {i:?} moves by {stable:e}");
            // Half the digits of the angle are lost in its cosine.
            assert!(angles < 2e-3, "{n1} -> {n2}: {i:?} moves by {angles:e}");
        }
    }
    assert!(above > 500, "the case must occur: {above}");
}

/// Cases RF-05, LN-10 of the catalogue.
#[test]
fn whether_reflection_is_total_is_decided_exactly_where_products_are_fused() {
    for (n1, n2) in [(1.5, 1.0), (1.33, 1.0), (2.42, 1.0), (1.5, 1.33), (1.000_293, 1.000_277), (1.0 + ULP, 1.0)] {
        let boundary = Boundary::<f32>::new(n1, n2);
        let critical = critical_angle(n1, n2).cos() as f32;
        let nearest = i64::from(critical.to_bits());
        for k in -2000..=2000 {
            let c = f32::from_bits((nearest + k) as u32);
            let want = super::oracle::cos2_t(super::oracle::d(c), n1, n2) < 0.0;
            if FUSED || k.abs() > 4 {
                assert_eq!(boundary.cross(c).total, want, "{n1} -> {n2} at cosine {c}, {k} ulp from critical");
            }
        }
    }
}
