//! Medians with confidence intervals.
//!
//! The interval of a median is that of order statistics. It assumes no distribution of the values.

use serde::{Deserialize, Serialize};

/// Least confidence of an interval, where there are enough runs for it.
const WANTED: f64 = 0.95;

/// A median and the interval of the true one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Median of the runs.
    pub median: f64,
    /// Interval that holds the true median with the confidence below.
    pub interval: [f64; 2],
    /// Confidence of the interval, 0..1; below 0.95 where there were fewer than six runs.
    pub confidence: f64,
    /// Runs.
    pub runs: usize,
}

impl Figure {
    /// The median of the values of all runs, at least one.
    #[must_use]
    pub fn of(runs: &[f64]) -> Self {
        let mut sorted = runs.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let median = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
        // The narrowest pair of order statistics that is still sure enough; the outermost where none is.
        let k = (0..n.div_ceil(2)).rev().find(|&k| confidence(n, k) >= WANTED).unwrap_or(0);
        Self { median, interval: [sorted[k], sorted[n - 1 - k]], confidence: confidence(n, k), runs: n }
    }

    /// Returns true if the measured runs do not rule out a true median of `x`. One or two runs rule out nothing. The interval
    /// of three to five runs has too low a confidence, and counts three times as wide.
    #[must_use]
    pub fn may_be(&self, x: f64) -> bool {
        let [low, high] = self.interval;
        let slack = if self.confidence < WANTED { high - low } else { 0.0 };
        self.runs < 3 || (low - slack <= x && x <= high + slack)
    }
}

/// Chance that the true median lies between the `k`-th smallest and the `k`-th largest of `n` runs, `k` from 0.
fn confidence(n: usize, k: usize) -> f64 {
    // That of 2^n equally likely patterns of above and below, with more than k on either side.
    let mut choose = 1.0;
    let mut outside = 0.0;
    for i in 0..=k {
        outside += choose;
        choose *= (n - i) as f64 / (i + 1) as f64;
    }
    (1.0 - 2.0 * outside / 2.0_f64.powi(n as i32)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_a_median_by_hand() {
        // Six runs: all above or all below has a chance of 2 / 64.
        let six = Figure::of(&[6.0, 1.0, 5.0, 2.0, 4.0, 3.0]);
        assert_eq!((six.median, six.interval), (3.5, [1.0, 6.0]));
        assert!((six.confidence - (1.0 - 2.0 / 64.0)).abs() < 1e-15);
        // Nine: all but one on a side, 2 (1 + 9) / 512.
        let nine = Figure::of(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        assert_eq!(nine.interval, [2.0, 8.0]);
        assert!((nine.confidence - (1.0 - 20.0 / 512.0)).abs() < 1e-15);
        // Three are not enough for 95 %, and it says so.
        let three = Figure::of(&[3.0, 1.0, 2.0]);
        assert_eq!((three.interval, three.confidence), ([1.0, 3.0], 0.75));
        assert_eq!(Figure::of(&[2.0]).confidence, 0.0);
    }

    #[test]
    fn what_overlaps_one_may_be_one() {
        assert!(Figure::of(&[0.9, 1.1, 1.2, 0.95]).may_be(1.0));
        assert!(!Figure::of(&[1.01, 1.1, 1.2, 1.05, 1.03, 1.1]).may_be(1.0));
        // Four runs above 1 happen by chance once in eight times.
        assert!(Figure::of(&[1.01, 1.1, 1.2, 1.05]).may_be(1.0));
        assert!(!Figure::of(&[2.0, 2.1, 2.2]).may_be(1.0), "twice the time needs no more");
        assert!(Figure::of(&[5.0]).may_be(1.0), "one run tells nothing");
    }
}
