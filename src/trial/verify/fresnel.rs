//! Unpolarised reflectance in eight lanes, as the renderer computes it, against the oracle.

use super::VerifyPlan;
use super::tally::CaseCounts;
use crate::math::FUSED;
use crate::measure::sample::Rng;
use crate::optics::{Boundary, Exact, FresnelFormula, oracle};
use crate::simd::F32x8;

const ULP: f64 = f32::EPSILON as f64;

/// Pairs of indices, incident before transmitted: into and out of glass, water and diamond, between glass and water,
/// and nearly equal ones.
pub const INDEX_PAIRS: [(f64, f64); 12] = [
    (1.0, 1.5),
    (1.5, 1.0),
    (1.0, 1.33),
    (1.33, 1.0),
    (1.0, 2.42),
    (2.42, 1.0),
    (1.33, 1.5),
    (1.5, 1.33),
    (1.0, 1.0003),
    (1.000_293, 1.000_277),
    (1.0, 1.0 + ULP),
    (1.0 + ULP, 1.0),
];

/// Number of batches per pair of indices.
const PARTS: usize = 4;

/// Returns the documented relative error. Without fused multiply-add, `cos_i^2` is rounded before the critical cosine
/// is subtracted.
pub(super) fn bound(past_critical: f64) -> f64 {
    if FUSED { 1.2e-6 } else { 1.2e-6 + 4e-7 / past_critical.max(1e-7).sqrt() }
}

/// Returns the cosine below which reflection is total, or 0 if it never is.
pub(super) fn critical_cosine(n1: f64, n2: f64) -> f64 {
    let sine = n2 / n1;
    if sine < 1.0 { (1.0 - sine * sine).sqrt() } else { 0.0 }
}

/// Returns a cosine from one of four distributions: all angles, near normal, grazing, near critical.
pub(super) fn cosine(rng: &mut Rng, critical: f64) -> f32 {
    let small = 10.0_f64.powf(rng.between(-8.0, -3.0));
    let c = match rng.below(4) {
        0 => rng.unit(),
        1 => 1.0 - small,
        2 => small,
        _ => critical + small,
    };
    c.min(1.0) as f32
}

pub(super) fn batches(_plan: &VerifyPlan) -> usize {
    INDEX_PAIRS.len() * PARTS
}

pub(super) fn batch(plan: &VerifyPlan, i: usize) -> CaseCounts {
    let (n1, n2) = INDEX_PAIRS[i / PARTS];
    let boundary = Boundary::<F32x8>::new(n1, n2);
    let critical = critical_cosine(n1, n2);
    let mut rng = Rng::new("fresnel", i);
    let mut tally = CaseCounts::default();
    for _ in 0..plan.sized(1_000_000, 20_000) / PARTS as u64 / 8 {
        let cosines = F32x8::from_fn(|_| cosine(&mut rng, critical));
        let at = boundary.cross(cosines);
        let got = Exact::dielectric(&boundary, &at);
        for lane in 0..8 {
            let (c, got) = (cosines.lane(lane), got.lane(lane));
            let want = oracle::reflectance(c, n1, n2);
            let error = (f64::from(got) - want).abs() / want;
            let allowed = bound(f64::from(c) - critical);
            tally.measure("relative error of R", error, allowed, || {
                format!("{n1} to {n2} at cosine {c:e}: reflects {got:e}, not {want:e}")
            });
            if !(0.0..=1.0).contains(&got) {
                tally.fail(|| format!("{n1} to {n2} at cosine {c:e}: reflects {got:e}, outside 0 to 1"));
            }
        }
    }
    tally
}
