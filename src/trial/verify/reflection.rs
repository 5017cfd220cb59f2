//! Mirror direction against the same formula with many digits, at all angles, near the normal and grazing.

use std::f64::consts::FRAC_PI_2;

use super::VerifyPlan;
use super::tally::CaseCounts;
use crate::measure::sample::Rng;
use crate::optics::{oracle, reflect};

/// Largest error in radians.
const BOUND: f64 = 3e-7;

pub(super) const BATCHES: usize = 16;

pub(super) fn batch(plan: &VerifyPlan, i: usize) -> CaseCounts {
    let mut rng = Rng::new("reflection", i);
    let mut tally = CaseCounts::default();
    for _ in 0..plan.sized(4_000_000, 200_000) / BATCHES as u64 {
        let angle = match rng.below(3) {
            0 => rng.unit().acos(),
            1 => 10.0_f64.powf(rng.between(-9.0, -1.0)),
            _ => FRAC_PI_2 - 10.0_f64.powf(rng.between(-9.0, -1.0)),
        };
        let (incident, normal) = rng.meeting_at(angle);
        let got = reflect(incident, normal);
        let off = oracle::mirror(incident, normal).angle_to(got);
        tally.measure("angle to the mirror direction, rad", off, BOUND, || format!("at {angle} rad: {off:e} rad off"));
    }
    tally
}
