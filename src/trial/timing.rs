//! Rounds of a trial, in which contenders take turns.
//!
//! Clock rates drift and other processes take time, so times of different minutes do not compare. In each round every
//! contender has one turn, A B C A B C. Ratios are taken within a round, and the result is their median.
//!
//! A render uses one back end, whose tree stays in the caches as far as it fits. In a trial the back ends evict each
//! other's trees. A contender right after another of the same back end is up to a third faster among a million
//! triangles. So turns alternate between back ends, and each turn runs twice: a warm-up, then the timed run.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::contender::Contender;
use super::rays::RaySet;
use super::team::Team;
use crate::{Error, Result};

/// Progress of a trial, and the request to stop it.
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    /// Number of runs finished so far.
    pub done: &'a AtomicU64,
    /// Set to end the trial after the current run.
    pub stop: &'a AtomicBool,
}

impl Watch<'_> {
    /// Counts a run.
    ///
    /// # Errors
    /// `Interrupted` if a stop was requested.
    pub fn step(&self) -> Result<()> {
        self.done.fetch_add(1, Ordering::Relaxed);
        if self.stop.load(Ordering::Relaxed) { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// Returns the seconds of each contender in each round. Each contender traces the set once before its timed run, so
/// that nothing is cold.
///
/// # Errors
/// `Interrupted` if a stop was requested.
pub fn rounds(
    contenders: &mut [Box<dyn Contender + '_>],
    set: &RaySet,
    team: &Team,
    rounds: usize,
    watch: &Watch,
) -> Result<Vec<Vec<f64>>> {
    let mut seconds = vec![Vec::with_capacity(rounds); contenders.len()];
    let order = turns(&contenders.iter().map(|c| c.label().backend).collect::<Vec<_>>());
    for _ in 0..rounds {
        for &i in &order {
            let (contender, seconds) = (&mut contenders[i], &mut seconds[i]);
            contender.prepare(set);
            contender.trace(set, team);
            contender.prepare(set);
            let start = Instant::now();
            contender.trace(set, team);
            // The clock's resolution limits how short a run can seem.
            seconds.push(start.elapsed().max(Duration::from_nanos(1)).as_secs_f64());
            watch.step()?;
        }
    }
    Ok(seconds)
}

/// Order in which contenders take turns, by their back ends: the first of each, the second of each, and so on.
fn turns<B: PartialEq>(backends: &[B]) -> Vec<usize> {
    let earlier = |i: usize| backends[..i].iter().filter(|&b| *b == backends[i]).count();
    let mut order: Vec<usize> = (0..backends.len()).collect();
    order.sort_by_key(|&i| earlier(i));
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_comes_after_another_of_the_same_back_end_where_that_can_be() {
        assert_eq!(turns(&["a", "a", "b", "b", "c"]), [0, 2, 4, 1, 3]);
        let all = [["native"; 4].as_slice(), &["robust"; 6], &["fast"; 6]].concat();
        let order = turns(&all);
        let names: Vec<_> = order.iter().map(|&i| all[i]).collect();
        assert!(names.windows(2).all(|two| two[0] != two[1]) && names[0] != names[15]);
        assert!((0..16).all(|i| order.contains(&i)));
    }

    #[test]
    fn a_wish_to_stop_ends_the_trial() {
        let (done, stop) = (AtomicU64::new(0), AtomicBool::new(false));
        let watch = Watch { done: &done, stop: &stop };
        assert!(watch.step().is_ok());
        stop.store(true, Ordering::Relaxed);
        assert!(matches!(watch.step(), Err(Error::Interrupted)));
        assert_eq!(done.into_inner(), 2);
    }
}
