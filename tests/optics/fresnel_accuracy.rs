//! The Fresnel equations against the oracle: relative error over every angle and pair of indices.

use super::oracle::{reflectance, reflectances};
use super::sample::{Rng, critical_angle};
use vitrum::math::FUSED;
use vitrum::optics::{Boundary, Exact, FresnelFormula, polarised, polarised_as_printed};
use vitrum::trial::verify::INDEX_PAIRS;

/// The pairs of indices of the promise, as `vitrum verify` has them, and those that go the other way.
pub fn pairs() -> impl Iterator<Item = (f64, f64)> {
    INDEX_PAIRS.into_iter().chain([(1.0003, 1.0), (1.000_277, 1.000_293)])
}

/// The stated relative error. Without fused products `cos_i^2` is rounded before the critical cosine is taken from it.
fn bound(distance_to_critical: f64) -> f64 {
    if FUSED { 1.2e-6 } else { 1.2e-6 + 4e-7 / distance_to_critical.max(1e-7).sqrt() }
}

/// A cosine from one of four crowds: all angles, near normal, grazing, near critical.
fn cosine(rng: &mut Rng, k: usize, critical: f64) -> f32 {
    let small = 10.0_f64.powf(rng.between(-8.0, -3.0));
    let c = match k % 4 {
        0 => rng.unit(),
        1 => 1.0 - small,
        2 => small,
        _ => critical + small,
    };
    c.min(1.0) as f32
}

fn critical_cosine(n1: f64, n2: f64) -> f64 {
    if n1 > n2 { critical_angle(n1, n2).cos() } else { 0.0 }
}

/// Cases FR-05, LN-10 of the catalogue.
#[test]
fn unpolarised_reflectance_is_within_its_bound_of_itself_everywhere() {
    println!("relative error of R    stable   as printed, halved");
    let mut rng = Rng::new(0xf2e5);
    for (n1, n2) in pairs() {
        let boundary = Boundary::<f32>::new(n1, n2);
        let critical = critical_cosine(n1, n2);
        let (mut stable, mut printed) = (0.0_f64, 0.0_f64);
        for k in 0..100_000 {
            let c = cosine(&mut rng, k, critical);
            let at = boundary.cross(c);
            let got = Exact::dielectric(&boundary, &at);
            let want = reflectance(c, n1, n2);
            assert!((0.0..=1.0).contains(&got), "{n1} -> {n2} at {c}: {got}");
            if at.total {
                assert_eq!(got, 1.0);
            }
            let error = (f64::from(got) - want).abs() / want;
            assert!(error <= bound(f64::from(c) - critical), "{n1} -> {n2} at {c}: {got}, not {want}: {error:e}");
            stable = stable.max(error);
            let notes = polarised_as_printed(&boundary, &at).unpolarised();
            assert!((0.0..=1.0).contains(&notes), "{n1} -> {n2} at {c}: {notes}");
            printed = printed.max((f64::from(notes) - want).abs() / want);
        }
        println!("{n1:8} -> {n2:8}   {stable:.1e}  {printed:.1e}");
    }
}

/// Case FR-06 of the catalogue.
#[test]
fn the_rows_near_the_critical_angle_keep_their_digits() {
    let mut rng = Rng::new(0xc417);
    for (n1, from, to) in [(1.5, 1e-7, 1e-5), (1.5, 1e-3, 0.2), (2.42, 1e-3, 0.08)] {
        let boundary = Boundary::<f32>::new(n1, 1.0);
        let critical = critical_cosine(n1, 1.0);
        let (mut stable, mut printed) = (0.0_f64, 0.0_f64);
        for _ in 0..50_000 {
            let c = (critical + rng.between(from, to)) as f32;
            let at = boundary.cross(c);
            let want = reflectance(c, n1, 1.0);
            stable = stable.max((f64::from(Exact::dielectric(&boundary, &at)) - want).abs() / want);
            printed = printed.max((f64::from(polarised_as_printed(&boundary, &at).unpolarised()) - want).abs() / want);
        }
        println!("{n1} -> 1, cosine {from:e}..{to:e} above critical: stable {stable:.1e}, as printed {printed:.1e}");
        assert!(stable <= if FUSED { 1.2e-6 } else { 6e-4 }, "{stable:e}");
        if FUSED {
            assert!(stable < printed, "the stable form is the better one");
        }
    }
}

#[test]
fn each_polarisation_is_within_its_bound() {
    let mut rng = Rng::new(0x901);
    let (mut s, mut p) = (0.0_f64, 0.0_f64);
    for (n1, n2) in pairs() {
        let boundary = Boundary::<f32>::new(n1, n2);
        let critical = critical_cosine(n1, n2);
        for k in 0..20_000 {
            let c = cosine(&mut rng, k, critical);
            let got = polarised(&boundary, &boundary.cross(c));
            let (want_s, want_p) = reflectances(c, n1, n2);
            let off_s = (f64::from(got.s) - want_s).abs() / want_s;
            let off_p = (f64::from(got.p) - want_p).abs() / want_s;
            let looser = bound(f64::from(c) - critical) / 1.2e-6;
            assert!(off_s <= 1.2e-6 * looser && off_p <= 1.2e-6 * looser, "{n1} -> {n2} at {c}: {off_s:e}, {off_p:e}");
            (s, p) = (s.max(off_s), p.max(off_p));
            let together = Exact::dielectric(&boundary, &boundary.cross(c));
            assert!((got.unpolarised() - together).abs() <= 4e-7 * together, "{n1} -> {n2} at {c}");
        }
    }
    println!("polarised: R_s {s:.1e} of itself, R_p {p:.1e} of R_s");
}

#[test]
fn refraction_and_fresnel_share_their_cosine_with_the_oracle() {
    let mut rng = Rng::new(0xb);
    let mut worst = 0.0_f64;
    for (n1, n2) in pairs() {
        let boundary = Boundary::<f32>::new(n1, n2);
        let critical = critical_cosine(n1, n2);
        for k in 0..5_000 {
            let c = cosine(&mut rng, k, critical);
            let at = boundary.cross(c);
            let want = super::oracle::cos2_t(super::oracle::d(c), n1, n2);
            // Next to the critical angle, products that are not fused may take a total crossing for another.
            if !at.total && (FUSED || want > 0.0) {
                let want = super::oracle::narrow(want.sqrt());
                let off = (f64::from(at.cos_t) - want).abs() / want;
                // Where products are not fused, `cos_i^2` is rounded before the far smaller `b^2` is taken from it.
                let b = want * n2 / n1;
                let rounded = if FUSED { 0.0 } else { 2.0_f64.powi(-24) * f64::from(c * c) / (b * b) };
                assert!(off <= 4e-7 + rounded, "{n1} -> {n2} at {c}: {off:e}");
                worst = worst.max(off);
            }
        }
    }
    println!("cos_t: {worst:.1e} of itself");
}
