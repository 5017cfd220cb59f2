//! Nanoseconds of a formula: of eight lanes, of one, and of one in `f64`.

use std::hint::black_box;
use std::time::Instant;

use crate::measure::Percentiles;

/// What one evaluation takes, in nanoseconds: the median of the rounds, which take turns. Loading the arguments and
/// storing the result is part of it.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Time {
    /// Of eight lanes at once.
    pub eight: f64,
    /// Of one, in `f32`.
    pub one: f64,
    /// Of one, in `f64`.
    pub double: f64,
}

/// Rounds.
const ROUNDS: usize = 15;

/// What a round takes about, in seconds.
const ROUND: f64 = 0.001;

/// Times three versions of a formula, each a run over a batch that says how many evaluations it made.
pub(super) fn time(runs: [&mut dyn FnMut() -> usize; 3]) -> Time {
    let [eight, one, double] = runs.map(|run| {
        let mut once = || {
            let start = Instant::now();
            let evaluations = black_box(run());
            (start.elapsed().as_secs_f64(), evaluations)
        };
        // Warm, and then as often as fills a round.
        once();
        let (seconds, _) = once();
        let repeats = (ROUND / seconds.max(1e-8)).ceil().clamp(1.0, 1e6) as usize;
        let round = |_| {
            let (mut seconds, mut evaluations) = (0.0, 0);
            for _ in 0..repeats {
                let (s, n) = once();
                seconds += s;
                evaluations += n;
            }
            seconds * 1e9 / evaluations as f64
        };
        Percentiles::of((0..ROUNDS).map(round).collect()).median
    });
    Time { eight, one, double }
}
