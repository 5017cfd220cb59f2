//! Hard cases run on this machine. Back ends must lose no ray, hit no surface twice, and give the same bits in any
//! packet. The optics must keep their documented bounds.
//!
//! Every group is a number of batches with a random stream each, so that the result does not depend on the number of
//! threads.

mod builds;
mod candidate;
mod chains;
mod fresnel;
mod group;
mod lanes;
mod leaks;
mod matched;
mod meshes;
mod reflection;
mod refraction;
mod scene;
mod self_hits;
mod tally;
mod traversal;
mod trouble;

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

pub use candidate::{Candidate, NamedAccel, UnderTest};
pub use fresnel::INDEX_PAIRS;
pub use group::Group;
pub use scene::fire as fire_at_scene;
pub use tally::{CaseCounts, Worst};
pub use trouble::{TriangleLocation, Trouble, TroubleKind, Troubles, find as find_trouble};

use crate::render::Observer;
use crate::{Error, Result};

/// Selection of test cases.
#[derive(Clone, Debug)]
pub struct VerifyPlan {
    /// Groups, in the requested order.
    pub groups: Vec<Group>,
    /// True for all documented cases, minutes of work; false for a sample of them.
    pub full: bool,
    /// Number of rays of each group that runs on a scene; `None` for the usual number.
    pub rays: Option<u64>,
}

impl VerifyPlan {
    /// Returns a sample of every group, some seconds of work.
    #[must_use]
    pub fn quick() -> Self {
        Self { groups: Group::OF_NO_SCENE.to_vec(), full: false, rays: None }
    }

    /// Returns the number of cases: `full` or `quick`.
    fn sized(&self, full: u64, quick: u64) -> u64 {
        if self.full { full } else { quick }
    }

    /// Returns the final value of [`Observer::pixels_done`] for a run with this many back ends: parts of the work,
    /// without unit.
    #[must_use]
    pub fn parts(&self, paths: usize) -> u64 {
        self.groups.iter().map(|g| if g.is_of_path() { PARTS * paths as u64 } else { PARTS }).sum()
    }
}

/// Number of parts per group in a progress bar.
pub(crate) const PARTS: u64 = 1000;

/// Result of one group.
#[derive(Clone, Debug)]
pub struct GroupResult {
    /// Group.
    pub group: Group,
    /// Back end; `None` for a group of formulas.
    pub path: Option<&'static str>,
    /// Cases, failures and the worst figure.
    pub tally: CaseCounts,
    /// Wall time.
    pub time: Duration,
}

impl GroupResult {
    /// Returns true if no case failed and there was at least one. If the work limit left no case, the rays left out are
    /// reported instead.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.tally.failures == 0 && (self.tally.cases > 0 || self.tally.left_out > 0)
    }
}

/// Runs the selected groups that test formulas alone.
///
/// # Errors
/// Returns [`Error::Interrupted`] soon after `observer.stop` is set.
pub fn fire_at_optics(plan: &VerifyPlan, observer: &Observer) -> Result<Vec<GroupResult>> {
    let mut findings = Vec::new();
    for &group in plan.groups.iter().filter(|g| !g.is_of_path()) {
        let finding = |batches, batch: &(dyn Fn(usize) -> Result<CaseCounts> + Sync)| {
            timed(group, None, || in_batches(batches, observer, batch))
        };
        findings.push(match group {
            Group::Fresnel => finding(fresnel::batches(plan), &|i| Ok(fresnel::batch(plan, i)))?,
            Group::Refraction => finding(refraction::batches(plan), &|i| Ok(refraction::batch(plan, i)))?,
            Group::Reflection => finding(reflection::BATCHES, &|i| Ok(reflection::batch(plan, i)))?,
            Group::Matched => finding(matched::BATCHES, &|i| Ok(matched::batch(plan, i)))?,
            _ => continue,
        });
    }
    Ok(findings)
}

/// Runs the selected groups that test a back end.
///
/// # Errors
/// Fails as [`fire_at_optics`] does, or if the back end cannot be built.
pub fn fire_at_path<C: Candidate>(candidate: &C, plan: &VerifyPlan, observer: &Observer) -> Result<Vec<GroupResult>> {
    let mut findings = Vec::new();
    for &group in plan.groups.iter().filter(|g| g.is_of_path()) {
        let finding = |batches, batch: &(dyn Fn(usize) -> Result<CaseCounts> + Sync)| {
            timed(group, Some(candidate.name()), || in_batches(batches, observer, batch))
        };
        findings.push(match group {
            Group::Leaks => {
                let pairs = meshes::pairs(&leaks::MESHES);
                finding(pairs.len(), &|i| leaks::batch(candidate, plan, &pairs, i))?
            }
            Group::SelfHits => {
                let pairs = meshes::pairs(&self_hits::MESHES);
                finding(pairs.len(), &|i| self_hits::batch(candidate, plan, &pairs, i))?
            }
            Group::Lanes => finding(lanes::BATCHES, &|i| lanes::batch(candidate, plan, i))?,
            Group::Traversal => finding(traversal::BATCHES, &|i| traversal::batch(candidate, plan, i))?,
            Group::Builds => finding(builds::BATCHES, &|i| builds::batch(candidate, plan, i))?,
            Group::Chains => finding(chains::BATCHES, &|i| chains::batch(candidate, plan, i))?,
            _ => continue,
        });
    }
    Ok(findings)
}

/// Measures the time of a group.
fn timed(group: Group, path: Option<&'static str>, work: impl FnOnce() -> Result<CaseCounts>) -> Result<GroupResult> {
    let start = Instant::now();
    let tally = work()?;
    Ok(GroupResult { group, path, tally, time: start.elapsed() })
}

/// Runs batches on all threads and sums their results in order.
fn in_batches(
    batches: usize,
    observer: &Observer,
    batch: &(dyn Fn(usize) -> Result<CaseCounts> + Sync),
) -> Result<CaseCounts> {
    let done = AtomicU64::new(0);
    let tallies: Vec<CaseCounts> = (0..batches)
        .into_par_iter()
        // Some batches take a hundred times as long as others, so each is a task that an idle thread can take.
        .with_max_len(1)
        .map(|i| {
            if observer.stop.load(Ordering::Relaxed) {
                return Err(Error::Interrupted);
            }
            let tally = batch(i)?;
            let before = done.fetch_add(1, Ordering::Relaxed);
            let parts = |n: u64| PARTS * n / batches as u64;
            observer.pixels_done.fetch_add(parts(before + 1) - parts(before), Ordering::Relaxed);
            Ok(tally)
        })
        .collect::<Result<_>>()?;
    let mut sum = CaseCounts::default();
    for tally in tallies {
        sum.merge(tally);
    }
    Ok(sum)
}
