//! Nanoseconds of a formula: in eight lanes, in one, and in one of `f64`.

use std::hint::black_box;
use std::time::Instant;

use crate::measure::Percentiles;

/// Time of one evaluation in nanoseconds: the median over rounds in which the three versions take turns. It includes
/// loading the arguments and storing the result.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Time {
    /// Of eight lanes at once.
    pub eight: f64,
    /// Of one number, in `f32`.
    pub one: f64,
    /// Of one number, in `f64`.
    pub double: f64,
}

/// Number of rounds.
const ROUNDS: usize = 15;

/// Approximate length of a round, in seconds.
const ROUND: f64 = 0.001;

/// Times three versions of a formula. Each is a run over a batch, which returns the number of evaluations.
pub(super) fn time(runs: [&mut dyn FnMut() -> usize; 3]) -> Time {
    let [eight, one, double] = runs.map(|run| {
        let mut once = || {
            let start = Instant::now();
            let evaluations = black_box(run());
            (start.elapsed().as_secs_f64(), evaluations)
        };
        // A warm-up, then as many runs as fill a round.
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
