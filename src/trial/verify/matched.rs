//! Exact properties of the optics: equal indices, division of light, and one lane against eight.

use super::VerifyPlan;
use super::fresnel::{INDEX_PAIRS, cosine, critical_cosine};
use super::tally::CaseCounts;
use crate::math::{Real, Vector3};
use crate::measure::sample::Rng;
use crate::optics::{AtNormal, Boundary, Exact, FresnelFormula, Schlick, reflect};
use crate::simd::{F32x8, Vec3x8};

pub(super) const BATCHES: usize = 16;

pub(super) fn batch(plan: &VerifyPlan, i: usize) -> CaseCounts {
    let mut rng = Rng::new("matched", i);
    let mut tally = CaseCounts::default();
    let rounds = plan.sized(4_000_000, 200_000) / BATCHES as u64 / 8;
    for _ in 0..rounds {
        equal_indices(&mut rng, &mut tally);
        split(&mut rng, &mut tally);
        one_and_eight(&mut rng, &mut tally);
    }
    tally
}

fn bits(v: Vector3<f32>) -> [u32; 3] {
    [v.x, v.y, v.z].map(f32::to_bits)
}

/// Tests that equal indices reflect and bend no light, at grazing and normal incidence, too.
fn equal_indices(rng: &mut Rng, tally: &mut CaseCounts) {
    let ior = 10.0_f64.powf(rng.between(-1.0, 1.0));
    let boundary = Boundary::<f32>::new(ior, ior);
    let angle = if rng.below(4) == 0 { 0.0 } else { rng.unit().acos() };
    let (incident, normal) = rng.meeting_at(angle);
    for c in [-incident.dot(normal), 0.0, 1.0] {
        let at = boundary.cross(c);
        let r = [Exact::dielectric(&boundary, &at), Schlick::dielectric(&boundary, &at)];
        let t = boundary.refract(incident, normal, &at);
        let holds = r == [0.0; 2] && !at.total && bits(t) == bits(incident);
        tally.check(holds, || {
            format!("index {ior} on both sides, cosine {c:e}: R = {r:?}, {incident:?} goes on as {t:?}")
        });
    }
}

/// Tests that `R + (1 - R)` is 1 to the bit for every formula: light that is not reflected is transmitted.
fn split(rng: &mut Rng, tally: &mut CaseCounts) {
    let (n1, n2) = INDEX_PAIRS[rng.below(INDEX_PAIRS.len())];
    let boundary = Boundary::<F32x8>::new(n1, n2);
    let at = boundary.cross(F32x8::from_fn(|_| cosine(rng, critical_cosine(n1, n2))));
    for r in
        [Exact::dielectric(&boundary, &at), Schlick::dielectric(&boundary, &at), AtNormal::dielectric(&boundary, &at)]
    {
        let sum = r + (F32x8::ONE - r);
        for lane in 0..8 {
            tally.check(sum.lane(lane) == 1.0, || {
                format!("{n1} to {n2}: R = {:e}, R + T = {:e}", r.lane(lane), sum.lane(lane))
            });
        }
    }
}

/// Returns the results of the formulas for one ray as numbers.
fn answers<R: Real>(boundary: &Boundary<R>, incident: Vector3<R>, normal: Vector3<R>) -> [R; 10] {
    let at = boundary.cross(-incident.dot(normal));
    let (t, r) = (boundary.refract(incident, normal, &at), reflect(incident, normal));
    let total = R::select(at.total, R::one(), R::zero());
    let share = [Exact::dielectric(boundary, &at), Schlick::dielectric(boundary, &at)];
    [t.x, t.y, t.z, r.x, r.y, r.z, total, at.cos_t, share[0], share[1]]
}

/// Tests that each of eight lanes gives the bits of the scalar formula, with poisoned numbers in some lanes.
fn one_and_eight(rng: &mut Rng, tally: &mut CaseCounts) {
    let (n1, n2) = INDEX_PAIRS[rng.below(INDEX_PAIRS.len())];
    let (mut incident, mut normal) = (Vec3x8::splat(glam::Vec3::X), Vec3x8::splat(glam::Vec3::X));
    for lane in 0..8 {
        let angle = rng.unit().acos();
        let (mut i, n) = rng.meeting_at(angle);
        if rng.below(8) == 0 {
            i = Vector3::new(rng.awkward(), rng.awkward(), rng.awkward());
        }
        incident.set_lane(lane, i.into());
        normal.set_lane(lane, n.into());
    }
    let eight = answers(&Boundary::<F32x8>::new(n1, n2), incident, normal);
    let boundary = Boundary::<f32>::new(n1, n2);
    for lane in 0..8 {
        let one = answers(&boundary, incident.lane(lane).into(), normal.lane(lane).into());
        let same = one.iter().zip(&eight).all(|(a, b)| {
            let b = b.lane(lane);
            a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
        });
        tally.check(same, || {
            format!("{n1} to {n2}, {:?} at {:?}: one lane and eight differ", incident.lane(lane), normal.lane(lane))
        });
    }
}
