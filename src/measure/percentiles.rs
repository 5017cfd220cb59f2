//! Medians with percentiles, over rounds in which all contenders had a turn.

/// Median and spread of a quantity that was measured once per round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Percentiles {
    /// Median over the rounds.
    pub median: f64,
    /// The 10th and the 90th percentile.
    pub spread: [f64; 2],
}

impl Percentiles {
    /// The percentiles of the values of all rounds, at least one. Interpolates between neighbouring values.
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

    /// Millions per second, from the seconds that `count` items took in each round.
    #[must_use]
    pub fn of_millions(count: usize, seconds: &[f64]) -> Self {
        Self::of(seconds.iter().map(|s| count as f64 * 1e-6 / s).collect())
    }

    /// Speed of `a` over that of `b`, from the seconds of both in each round.
    #[must_use]
    pub fn of_ratio(a: &[f64], b: &[f64]) -> Self {
        Self::of(a.iter().zip(b).map(|(a, b)| b / a).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_percentiles_by_hand() {
        assert_eq!(Percentiles::of(vec![3.0]), Percentiles { median: 3.0, spread: [3.0, 3.0] });
        let eleven = Percentiles::of((0..=10).rev().map(f64::from).collect());
        assert_eq!(eleven, Percentiles { median: 5.0, spread: [1.0, 9.0] });
        assert_eq!(Percentiles::of(vec![1.0, 2.0]).median, 1.5);
    }

    #[test]
    fn a_round_in_which_all_were_slow_does_not_change_the_ratio() {
        let (a, b) = ([1.0, 10.0, 1.0], [2.0, 20.0, 2.0]);
        assert_eq!(Percentiles::of_ratio(&a, &b), Percentiles { median: 2.0, spread: [2.0, 2.0] });
        assert_eq!(Percentiles::of_millions(3_000_000, &[1.0, 3.0, 1.5]).median, 2.0);
    }
}
