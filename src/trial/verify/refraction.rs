//! Refracted direction against Snell's law, in both directions through boundaries, well below the critical angle and
//! next to it.

use std::f64::consts::FRAC_PI_2;

use super::VerifyPlan;
use super::tally::CaseCounts;
use crate::math::FUSED;
use crate::measure::sample::Rng;
use crate::optics::{Boundary, oracle};

const ULP: f64 = f32::EPSILON as f64;

/// Distribution of angles of incidence.
#[derive(Clone, Copy)]
enum Angles {
    /// Cosines uniform over 0..1.
    All,
    /// Within 1e-3 rad of the normal.
    NearNormal,
    /// Exactly along the normal.
    Normal,
    /// 1e-6 rad below grazing.
    Grazing,
    /// From the normal to 1e-3 rad below the critical angle.
    WellBelow,
    /// Within this range of radians below the critical angle.
    Just(f64, f64),
}

/// Indices, angles, bound on the error in radians, and share of rays whose total reflection may be misjudged because
/// the arguments, and thus the critical angle, are rounded.
const ROWS: [(f64, f64, Angles, f64, f64); 14] = [
    (1.0, 1.5, Angles::All, 2.2e-7, 0.0),
    (1.0, 1.33, Angles::All, 2.2e-7, 0.0),
    (1.0, 2.42, Angles::All, 2.2e-7, 0.0),
    (1.33, 1.5, Angles::All, 3e-7, 0.0),
    (1.0, 1.5, Angles::NearNormal, 1.5e-7, 0.0),
    (1.0, 1.5, Angles::Normal, 1.5e-7, 0.0),
    (1.0, 1.5, Angles::Grazing, 2.2e-7, 0.0),
    (1.0, 1.0 + ULP, Angles::All, 1.5e-7, 0.0),
    (1.0 + ULP, 1.0, Angles::WellBelow, 3e-7, 0.0),
    (1.0, 1.0003, Angles::All, 2.2e-7, 0.0),
    (1.5, 1.0, Angles::WellBelow, 8e-6, 0.0),
    (2.42, 1.0, Angles::WellBelow, 2e-5, 0.0),
    (1.5, 1.0, Angles::Just(5e-6, 1e-5), 2e-4, 0.0),
    // Without fused multiply-add, rounding `cos_i^2` moves the critical angle by up to 1.7e-8 rad more.
    (1.5, 1.0, Angles::Just(0.0, 1e-7), 1.4e-3, if FUSED { 0.2 } else { 0.3 }),
];

const PARTS: usize = 4;

pub(super) fn batches(_plan: &VerifyPlan) -> usize {
    ROWS.len() * PARTS
}

fn angle(rng: &mut Rng, kind: Angles, n1: f64, n2: f64) -> f64 {
    let critical = (n2 / n1).min(1.0).asin();
    match kind {
        Angles::All => rng.unit().acos(),
        Angles::NearNormal => rng.between(0.0, 1e-3),
        Angles::Normal => 0.0,
        Angles::Grazing => FRAC_PI_2 - 1e-6,
        Angles::WellBelow => rng.between((critical - 1e-3).cos(), 1.0).acos(),
        Angles::Just(least, most) => critical - rng.between(least, most),
    }
}

pub(super) fn batch(plan: &VerifyPlan, i: usize) -> CaseCounts {
    let (n1, n2, kind, bound, may_misjudge) = ROWS[i / PARTS];
    let boundary = Boundary::<f32>::new(n1, n2);
    let mut rng = Rng::new("refraction", i);
    let mut tally = CaseCounts::default();
    let mut misjudged = 0;
    let rays = plan.sized(250_000, 8_000) / PARTS as u64;
    for _ in 0..rays {
        let angle = angle(&mut rng, kind, n1, n2);
        let (incident, normal) = rng.meeting_at(angle);
        let at = boundary.cross(-incident.dot(normal));
        let got = boundary.refract(incident, normal, &at);
        match (oracle::refract(incident, normal, n1, n2), at.total) {
            (Some(want), false) => {
                let off = want.angle_to(got);
                tally.measure("angle to Snell's direction, rad", off, bound, || {
                    format!("{n1} to {n2} at {angle} rad: {off:e} rad off")
                });
                let length = f64::from(got.dot(got)).sqrt();
                if (length - 1.0).abs() > 1e-6 {
                    tally.fail(|| format!("{n1} to {n2} at {angle} rad: length {length}"));
                }
            }
            (None, true) => tally.pass(),
            _ => {
                tally.pass();
                misjudged += 1;
            }
        }
    }
    if misjudged as f64 > may_misjudge * rays as f64 {
        tally.fail(|| format!("{n1} to {n2}: total reflection misjudged for {misjudged} of {rays} rays"));
    }
    tally
}
