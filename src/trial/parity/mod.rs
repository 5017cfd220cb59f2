//! Parity, ray by ray: what each contender answers to the same rays, judged by the arbiter.
//!
//! An answer that differs from the `f64` one is *undecidable* where `f32` could not tell, for a reason and by a margin
//! that are counted, or else it is *wrong*, in a way that has a name. Answers beyond an end of the ray's interval by no
//! more than rounding are a class of their own, since Embree's modes differ there.

mod aimed;
mod leaving;
mod sets;
mod tally;

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

pub use aimed::{Targets, ends};
pub use sets::{Set, sets};
pub use tally::{CAUSES, FAULTS, Finding, Tally, cause_name, fault_name};

use crate::accel::reference::{Examined, Fault, Hit64, Reference, Verdict};
use crate::accel::{Coherence, Intersector};
use crate::geometry::{Hit, Hit8, Ray, Ray8};
use crate::simd::Mask8;

/// Instance, geometry and primitive of a hit.
pub type Id = (u32, u32, u32);

/// Packets that one task takes on.
const TASK: usize = 64;

/// Wrong answers that are kept of each contender, query and set of rays.
const EXAMPLES: usize = 4;

/// The two questions that an [`Intersector`] answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Query {
    /// Which hit is nearest.
    Closest,
    /// Whether there is any.
    Occluded,
}

/// What a contender answers to a list of rays, one for one.
#[derive(Clone, Debug)]
pub struct Answers {
    /// Nearest hits.
    pub hits: Vec<Hit>,
    /// Whether anything is met.
    pub blocked: Vec<bool>,
}

/// Asks a contender about rays that share a mask, in parallel, both queries.
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

/// What came of one contender's answers to one query.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// How many answers are what.
    pub tally: Tally,
    /// Rays where the answer (the primitive, or whether there is any) is another one than the first contender's.
    pub differs: u64,
    /// Of those, the ones where neither of the two is wrong.
    pub differs_undecidably: u64,
    /// The first wrong answers.
    pub wrong: Vec<Wrong>,
}

/// A wrong answer.
#[derive(Clone, Copy, Debug)]
pub struct Wrong {
    /// The ray.
    pub ray: Ray,
    /// What is wrong; none where the answer is off by no more than rounding at an end of the interval.
    pub fault: Option<Fault>,
    /// The answer; only whether it is a hit counts under [`Query::Occluded`].
    pub claim: Hit,
    /// What `f64` finds.
    pub truth: Hit64,
}

/// Both queries of one contender.
#[derive(Clone, Debug, Default)]
pub struct Records {
    /// [`Query::Closest`].
    pub closest: Record,
    /// [`Query::Occluded`].
    pub occluded: Record,
}

impl Records {
    /// Each with its query.
    pub fn each(&self) -> [(Query, &Record); 2] {
        [(Query::Closest, &self.closest), (Query::Occluded, &self.occluded)]
    }
}

impl Record {
    fn add(&mut self, finding: Finding, first: Finding, differs: bool, wrong: impl FnOnce() -> Wrong) {
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

/// Judges what each contender answered to the rays of `set`. `done` is told of every batch of rays that is through; none comes
/// back where `stop` was set meanwhile.
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
    // In order, so that the examples are the same whoever was first.
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

/// Records each contender's answer to ray `k`, which must not meet `leaves` again.
fn one(case: &Examined, ray: &Ray, leaves: Option<Id>, answers: &[Answers], k: usize, records: &mut [Records]) {
    let mut first: Option<(Finding, Finding)> = None;
    for (a, record) in answers.iter().zip(records) {
        let (claim, blocked) = (a.hits[k], a.blocked[k]);
        let again = claim.is_hit() && leaves == Some(claim.id());
        let closest = if again { Finding::Wrong(Fault::SelfHit) } else { finding(case, ray, &claim) };
        let occluded = Finding::from(case.judge_occluded(blocked));
        let (first_closest, first_occluded) = *first.get_or_insert((closest, occluded));
        let wrong = |finding: Finding, claim| Wrong { ray: *ray, fault: finding.fault(), claim, truth: *case.truth() };
        let other = claim.id() != answers[0].hits[k].id() || claim.is_hit() != answers[0].hits[k].is_hit();
        record.closest.add(closest, first_closest, other, || wrong(closest, claim));
        let claim = if blocked { Hit { geometry: 0, ..Hit::MISS } } else { Hit::MISS };
        let other = blocked != answers[0].blocked[k];
        record.occluded.add(occluded, first_occluded, other, || wrong(occluded, claim));
    }
}

/// The arbiter's verdict, with answers just beyond an end of the interval put apart.
fn finding(case: &Examined, ray: &Ray, claim: &Hit) -> Finding {
    let verdict = case.judge(claim);
    if verdict != Verdict::Wrong(Fault::OutsideInterval) {
        return verdict.into();
    }
    let t = f64::from(claim.t);
    let beyond = (f64::from(ray.t_min) - t).max(t - f64::from(ray.t_max));
    let near = case.contacts().iter().filter(|c| c.id == claim.id() && (c.t - t).abs() <= c.bound);
    if near.into_iter().any(|c| beyond <= c.bound) { Finding::BeyondEnd } else { verdict.into() }
}
