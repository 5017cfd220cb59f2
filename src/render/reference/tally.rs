//! What one or many camera rays came to.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::render::{Limit, RayCounts, UnmatchedExits};

/// The largest contribution that the eight-wide renderer's accumulator holds, in radiance.
const LARGEST: f64 = (1_u64 << 62) as f64;

/// The outcome of camera rays: radiance, and what is counted.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Radiance per channel.
    pub radiance: DVec3,
    /// Weight of the rays that were cut, per channel.
    pub truncated: DVec3,
    /// The same by the limit that ended them, in the order of [`Limit::ALL`].
    pub ended: [DVec3; Limit::ALL.len()],
    /// Rays traced.
    pub rays: RayCounts,
    /// Contributions that were NaN or infinite, and left out.
    pub non_finite: u64,
    /// Contributions beyond 2^62, clamped to it.
    pub clamped: u64,
    /// Rays that left a medium they had never entered.
    pub unmatched_exits: UnmatchedExits,
    /// Objects that rays met, shadow rays apart.
    pub met: BTreeSet<u32>,
    /// Camera rays that met nothing.
    pub missed: u64,
    /// True if any surface sent light of a lamp.
    pub lit: bool,
}

impl Tally {
    /// Adds radiance.
    pub(super) fn add(&mut self, contribution: DVec3) {
        if !contribution.is_finite() {
            self.non_finite += 1;
            return;
        }
        if contribution.abs().max_element() > LARGEST {
            self.clamped += 1;
        }
        self.radiance += contribution.clamp(DVec3::splat(-LARGEST), DVec3::splat(LARGEST));
    }

    /// Counts the weight of a ray that a limit ended.
    pub(super) fn end(&mut self, limit: Limit, weight: DVec3) {
        self.truncated += weight;
        self.ended[limit as usize] += weight;
    }

    /// The limit that ended most of the truncated weight.
    #[must_use]
    pub fn limit(&self) -> Option<Limit> {
        Limit::heaviest(self.ended.map(|weight| weight.to_array()))
    }

    /// Adds the counts, and `share` times the radiance and the truncated weight, of another tally.
    pub(super) fn merge(&mut self, o: &Self, share: f64) {
        self.radiance += o.radiance * share;
        self.truncated += o.truncated * share;
        self.ended.iter_mut().zip(o.ended).for_each(|(sum, weight)| *sum += weight * share);
        self.rays.merge(&o.rays);
        self.non_finite += o.non_finite;
        self.clamped += o.clamped;
        self.unmatched_exits.merge(&o.unmatched_exits);
        self.met.extend(&o.met);
        self.missed += o.missed;
        self.lit |= o.lit;
    }
}
