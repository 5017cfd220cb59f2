//! Selection of test cases, and their run in batches.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::group::Group;
use super::tally::CaseCounts;
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
    pub(super) fn sized(&self, full: u64, quick: u64) -> u64 {
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

/// Measures the time of a group.
pub(super) fn timed(
    group: Group,
    path: Option<&'static str>,
    work: impl FnOnce() -> Result<CaseCounts>,
) -> Result<GroupResult> {
    let start = Instant::now();
    let tally = work()?;
    Ok(GroupResult { group, path, tally, time: start.elapsed() })
}

/// Runs batches on all threads and sums their results in order.
pub(super) fn in_batches(
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
