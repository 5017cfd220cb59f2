//! The clock: contenders take turns, and are compared turn by turn.
//!
//! Clocks drift and neighbours steal time, so that a figure of one minute says little about another. In each round every
//! contender has its turn, A B C A B C; what is compared is the ratio within a round, and the figure is the median of these.
//!
//! Renders know one back end, whose tree stays in the caches as far as it fits. Here each back end pushes the others' out,
//! and who comes after a mode of its own back end finds what that one left: among a million triangles up to a third faster.
//! So turns go from back end to back end, and a turn is two runs, of which the second counts.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::contender::Contender;
use super::rays::RaySet;
use super::team::Team;
use crate::{Error, Result};

/// How a caller watches a trial, and stops it.
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    /// Runs finished so far.
    pub done: &'a AtomicU64,
    /// Set it, and the trial ends after the run under way.
    pub stop: &'a AtomicBool,
}

impl Watch<'_> {
    /// Counts a run.
    ///
    /// # Errors
    /// `Interrupted`, where that is wished.
    pub fn step(&self) -> Result<()> {
        self.done.fetch_add(1, Ordering::Relaxed);
        if self.stop.load(Ordering::Relaxed) { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// A figure taken once a round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Median over the rounds.
    pub median: f64,
    /// From the 10th to the 90th percentile.
    pub spread: [f64; 2],
}

impl Figure {
    /// Of the figures of all rounds, at least one. Between two of them, percentiles are interpolated.
    #[must_use]
    pub fn of(mut rounds: Vec<f64>) -> Self {
        rounds.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * (rounds.len() - 1) as f64;
            let (below, above) = (place.floor() as usize, place.ceil() as usize);
            rounds[below] + (rounds[above] - rounds[below]) * place.fract()
        };
        Self { median: at(0.5), spread: [at(0.1), at(0.9)] }
    }
}

/// Seconds of each contender in each round. Each has traced the set right before, so that nothing is cold.
///
/// # Errors
/// `Interrupted`.
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
            // No run is shorter than what the clock can tell.
            seconds.push(start.elapsed().max(Duration::from_nanos(1)).as_secs_f64());
            watch.step()?;
        }
    }
    Ok(seconds)
}

/// The order in which contenders take turns, by their back ends: the first of each, the second of each, and so on.
fn turns<B: PartialEq>(backends: &[B]) -> Vec<usize> {
    let earlier = |i: usize| backends[..i].iter().filter(|&b| *b == backends[i]).count();
    let mut order: Vec<usize> = (0..backends.len()).collect();
    order.sort_by_key(|&i| earlier(i));
    order
}

/// Millions a second in each round.
#[must_use]
pub fn millions(count: usize, seconds: &[f64]) -> Figure {
    Figure::of(seconds.iter().map(|s| count as f64 * 1e-6 / s).collect())
}

/// How many times as fast as `b` was `a`, round by round.
#[must_use]
pub fn ratio(a: &[f64], b: &[f64]) -> Figure {
    Figure::of(a.iter().zip(b).map(|(a, b)| b / a).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_percentiles_by_hand() {
        assert_eq!(Figure::of(vec![3.0]), Figure { median: 3.0, spread: [3.0, 3.0] });
        let eleven = Figure::of((0..=10).rev().map(f64::from).collect());
        assert_eq!(eleven, Figure { median: 5.0, spread: [1.0, 9.0] });
        assert_eq!(Figure::of(vec![1.0, 2.0]).median, 1.5);
    }

    #[test]
    fn a_round_in_which_all_were_slow_does_not_change_the_ratio() {
        let (a, b) = ([1.0, 10.0, 1.0], [2.0, 20.0, 2.0]);
        assert_eq!(ratio(&a, &b), Figure { median: 2.0, spread: [2.0, 2.0] });
        assert_eq!(millions(3_000_000, &[1.0, 3.0, 1.5]).median, 2.0);
    }

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
