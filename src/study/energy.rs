//! Energy balance of a picture against its reference.

use serde::{Deserialize, Serialize};

use crate::image::Film;
use crate::render::Outcome;

/// Light of a picture and of its reference, and losses. Means are over all pixels and channels, in units of radiance;
/// pixels that are not finite in either picture are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Mean radiance.
    pub light: f64,
    /// Mean radiance of the reference.
    pub reference: f64,
    /// Mean excess of brighter pixels over the reference.
    pub gained: f64,
    /// Mean deficit of darker pixels.
    pub lost: f64,
    /// Mean weight of the rays ended by the depth limit or the cut-off: the largest loss at radiance 1.
    pub cut: f64,
    /// Number of contributions left out because they were not finite.
    pub non_finite: u64,
    /// Number of contributions clamped because they were too large.
    pub clamped: u64,
    /// Number of rays that left a medium they had never entered.
    pub unmatched_exits: u64,
}

impl Ledger {
    /// Computes the balance of a picture against its reference, which must have the same size.
    #[must_use]
    pub fn of(outcome: &Outcome, reference: &Film) -> Self {
        let mut ledger = Self {
            non_finite: outcome.non_finite,
            clamped: outcome.clamped,
            unmatched_exits: outcome.unmatched_exits,
            ..Self::default()
        };
        let mut n = 0_u64;
        for (p, q) in outcome.film.pixels.iter().zip(&reference.pixels) {
            if !p.iter().chain(q).all(|x| x.is_finite()) {
                continue;
            }
            n += 3;
            for (&a, &b) in p.iter().zip(q) {
                let (a, b) = (f64::from(a), f64::from(b));
                ledger.light += a;
                ledger.reference += b;
                ledger.gained += (a - b).max(0.0);
                ledger.lost += (b - a).max(0.0);
            }
        }
        let share = 1.0 / n.max(1) as f64;
        for sum in [&mut ledger.light, &mut ledger.reference, &mut ledger.gained, &mut ledger.lost] {
            *sum *= share;
        }
        let cut: f64 = outcome.truncated.pixels.iter().flatten().map(|&x| f64::from(x)).sum();
        ledger.cut = cut / (3 * outcome.truncated.pixels.len()).max(1) as f64;
        ledger
    }

    /// Returns the excess light relative to the reference; below zero if light is missing.
    #[must_use]
    pub fn error(&self) -> f64 {
        if self.reference > 0.0 { (self.light - self.reference) / self.reference } else { self.light }
    }

    /// Returns the misplaced light relative to the reference: gained plus lost. A picture may have the right sum and
    /// still be wrong everywhere.
    #[must_use]
    pub fn misplaced(&self) -> f64 {
        let wrong = self.gained + self.lost;
        if self.reference > 0.0 { wrong / self.reference } else { wrong }
    }

    /// Returns true if the balance holds within `tolerance`, relative to the reference. Light may also be lost by the
    /// cut weight at a radiance of `brightest`, the largest of the scene.
    #[must_use]
    pub fn balances(&self, tolerance: f64, brightest: f64) -> bool {
        let slack = tolerance * self.reference;
        self.gained <= slack && self.lost <= slack + self.cut * brightest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{RayCounts, Seen, StreamCounts, TouchingFound};

    #[test]
    fn the_ledger_adds_up_by_hand() {
        let film = |values: [f32; 2]| Film { width: 2, height: 1, pixels: values.map(|v| [v; 3]).to_vec() };
        let outcome = Outcome {
            film: film([1.5, 0.25]),
            truncated: film([0.0, 0.25]),
            limits: vec![None; 2],
            shortfall: None,
            rays: RayCounts::default(),
            non_finite: 0,
            clamped: 0,
            unmatched_exits: 3,
            unmatched_objects: vec![(0, 3)],
            streams: StreamCounts::default(),
            seen: Seen::default(),
            touching: TouchingFound::default(),
            planar: None,
            maps: None,
            images: None,
            body_maps: None,
        };
        let ledger = Ledger::of(&outcome, &film([1.0, 0.5]));
        assert_eq!((ledger.light, ledger.reference), (0.875, 0.75));
        assert_eq!((ledger.gained, ledger.lost, ledger.cut), (0.25, 0.125, 0.125));
        assert!((ledger.error() - 1.0 / 6.0).abs() < 1e-15 && ledger.misplaced() == 0.5);
        assert!(!ledger.balances(0.1, 1.0), "light from nowhere");
        let short = Ledger { gained: 0.0, ..ledger };
        assert!(short.balances(0.0, 1.0) && !short.balances(0.0, 0.5), "what is lost was cut");
    }
}
