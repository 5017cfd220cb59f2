//! Parity, ray by ray: answers of each contender to the same rays, judged by the arbiter.
//!
//! An answer that differs from the `f64` one is *undecidable* if `f32` could not tell; cause and margin are counted.
//! Otherwise it is *wrong*, with a named fault. Answers beyond an end of the ray's interval by no more than rounding
//! are a separate class, since Embree's modes differ there.

mod aimed;
mod leaving;
mod sets;
mod tally;

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

pub use aimed::{Targets, ends};
pub use sets::{Set, sets};
pub use tally::{CAUSES, FAULTS, Judgement, VerdictCounts, cause_name, fault_name};

use crate::accel::reference::{Examined, Fault, Hit64, Reference, Verdict};
use crate::accel::{Coherence, Intersector};
use crate::geometry::{Hit, Hit8, Ray, Ray8};
use crate::simd::Mask8;

/// Instance, geometry and primitive of a hit.
pub type Id = (u32, u32, u32);

/// Number of packets per task.
const TASK: usize = 64;

/// Number of wrong answers kept per contender, query and set of rays.
const EXAMPLES: usize = 4;

/// Query of an [`Intersector`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Query {
    /// Closest hit.
    Closest,
    /// Occlusion.
    Occluded,
}

/// Answers of a contender to a list of rays, in order.
#[derive(Clone, Debug)]
pub struct Answers {
    /// Closest hits.
    pub hits: Vec<Hit>,
    /// True for each occluded ray.
    pub blocked: Vec<bool>,
}

/// Traces rays that share a mask by a contender, in parallel, with both queries.
pub fn ask<I: Intersector>(of: &I, rays: &[Ray], coherence: Coherence) -> Answers {
    let packets = Ray8::pack(rays);
    let parts: Vec<(Vec<Hit8>, Vec<Mask8>)> = packets
        .par_chunks(TASK)
        .map_init(I::Scratch::default, |scratch, packets| {
            let (mut hits, mut blocked) = (vec![Hit8::default(); packets.len()], vec![Mask8::NONE; packets.len()]);
            of.closest(packets, &mut hits, coherence, scratch);
            of.occluded(packets, &mut blocked, coherence, scratch);
            (hits, blocked)
        })
        .collect();
    let all = || parts.iter().flat_map(|(hits, blocked)| hits.iter().zip(blocked));
    Answers {
        hits: all().flat_map(|(h, _)| (0..8).map(|i| h.lane(i))).take(rays.len()).collect(),
        blocked: all().flat_map(|(_, b)| (0..8).map(|i| b.lane(i))).take(rays.len()).collect(),
    }
}

/// Results of one contender for one query.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Numbers of answers by verdict.
    pub tally: VerdictCounts,
    /// Number of rays whose answer (the primitive, or occlusion) differs from the first contender's.
    pub differs: u64,
    /// Number of these where neither answer is wrong.
    pub differs_undecidably: u64,
    /// First wrong answers.
    pub wrong: Vec<Wrong>,
}

/// Wrong answer.
#[derive(Clone, Copy, Debug)]
pub struct Wrong {
    /// Ray.
    pub ray: Ray,
    /// Fault; `None` if the answer is off by no more than rounding at an end of the interval.
    pub fault: Option<Fault>,
    /// Answer; under [`Query::Occluded`] only hit or miss counts.
    pub claim: Hit,
    /// Hit by the `f64` arbiter.
    pub truth: Hit64,
}

/// Results of one contender for both queries.
#[derive(Clone, Debug, Default)]
pub struct Records {
    /// [`Query::Closest`].
    pub closest: Record,
    /// [`Query::Occluded`].
    pub occluded: Record,
}

impl Records {
    /// Returns each record with its query.
    pub fn each(&self) -> [(Query, &Record); 2] {
        [(Query::Closest, &self.closest), (Query::Occluded, &self.occluded)]
    }
}

impl Record {
    fn add(&mut self, finding: Judgement, first: Judgement, differs: bool, wrong: impl FnOnce() -> Wrong) {
        self.tally.add(finding);
        self.differs += u64::from(differs);
        self.differs_undecidably += u64::from(differs && !finding.is_wrong() && !first.is_wrong());
        if finding.is_wrong() && self.wrong.len() < EXAMPLES {
            self.wrong.push(wrong());
        }
    }

    fn merge(&mut self, o: Self) {
        self.tally.merge(&o.tally);
        self.differs += o.differs;
        self.differs_undecidably += o.differs_undecidably;
        self.wrong.extend(o.wrong);
        self.wrong.truncate(EXAMPLES);
    }
}

/// Judges the answers of each contender to the rays of `set`. Calls `done` after each batch of rays. Returns `None` if
/// `stop` is set meanwhile.
pub fn judge(
    reference: &Reference,
    set: &Set,
    answers: &[Answers],
    stop: &AtomicBool,
    done: impl Fn(u64) + Sync,
) -> Option<Vec<Records>> {
    let batches = set.rays.par_chunks(8 * TASK).enumerate().map(|(batch, rays)| {
        let mut records = vec![Records::default(); answers.len()];
        for (k, ray) in (batch * 8 * TASK..).zip(rays) {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let leaves = set.leaves.get(k).copied().flatten();
            one(&reference.examine(ray), ray, leaves, answers, k, &mut records);
        }
        done(rays.len() as u64);
        Some(records)
    });
    // In order, so that the examples do not depend on which thread is first.
    let batches: Vec<_> = batches.collect::<Option<_>>()?;
    let mut sum = vec![Records::default(); answers.len()];
    for batch in batches {
        for (sum, records) in sum.iter_mut().zip(batch) {
            sum.closest.merge(records.closest);
            sum.occluded.merge(records.occluded);
        }
    }
    Some(sum)
}

/// Records each contender's answer to ray `k`, which must not hit `leaves` again.
fn one(case: &Examined, ray: &Ray, leaves: Option<Id>, answers: &[Answers], k: usize, records: &mut [Records]) {
    let mut first: Option<(Judgement, Judgement)> = None;
    for (a, record) in answers.iter().zip(records) {
        let (claim, blocked) = (a.hits[k], a.blocked[k]);
        let again = claim.is_hit() && leaves == Some(claim.id());
        let closest = if again { Judgement::Wrong(Fault::SelfHit) } else { finding(case, ray, &claim) };
        let occluded = Judgement::from(case.judge_occluded(blocked));
        let (first_closest, first_occluded) = *first.get_or_insert((closest, occluded));
        let wrong =
            |finding: Judgement, claim| Wrong { ray: *ray, fault: finding.fault(), claim, truth: *case.truth() };
        let other = claim.id() != answers[0].hits[k].id() || claim.is_hit() != answers[0].hits[k].is_hit();
        record.closest.add(closest, first_closest, other, || wrong(closest, claim));
        let claim = if blocked { Hit { geometry: 0, ..Hit::MISS } } else { Hit::MISS };
        let other = blocked != answers[0].blocked[k];
        record.occluded.add(occluded, first_occluded, other, || wrong(occluded, claim));
    }
}

/// Returns the arbiter's verdict, with answers just beyond an end of the interval as a separate class.
fn finding(case: &Examined, ray: &Ray, claim: &Hit) -> Judgement {
    let verdict = case.judge(claim);
    if verdict != Verdict::Wrong(Fault::OutsideInterval) {
        return verdict.into();
    }
    let t = f64::from(claim.t);
    let beyond = (f64::from(ray.t_min) - t).max(t - f64::from(ray.t_max));
    let near = case.contacts().iter().filter(|c| c.id == claim.id() && (c.t - t).abs() <= c.bound);
    if near.into_iter().any(|c| beyond <= c.bound) { Judgement::BeyondEnd } else { verdict.into() }
}
