//! Results of one or more camera rays: radiance and counts.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::render::{Limit, RayCounts, UnmatchedExits};

/// Largest contribution that the eight-wide renderer's accumulator holds, in radiance.
const LARGEST: f64 = (1_u64 << 62) as f64;

/// Radiance and counts of camera rays.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Radiance per channel.
    pub radiance: DVec3,
    /// Weight of rays that a limit ended, per channel.
    pub truncated: DVec3,
    /// Truncated weight by limit, in the order of [`Limit::ALL`].
    pub ended: [DVec3; Limit::ALL.len()],
    /// Number of rays traced.
    pub rays: RayCounts,
    /// Number of contributions left out because they were NaN or infinite.
    pub non_finite: u64,
    /// Number of contributions clamped because they exceeded 2^62.
    pub clamped: u64,
    /// Rays that left a medium they had never entered.
    pub unmatched_exits: UnmatchedExits,
    /// Objects that rays hit, except for shadow rays.
    pub met: BTreeSet<u32>,
    /// Number of camera rays that hit nothing.
    pub missed: u64,
    /// Reflections that were traced for want of a map.
    pub without_map: u64,
    /// Reflections that were traced for want of a virtual scene.
    pub without_image: u64,
    /// Refracted rays that were traced for want of a map.
    pub without_body_map: u64,
    /// True if any surface reflected light of a lamp.
    pub lit: bool,
}

impl Tally {
    /// Adds a contribution to the radiance.
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

    /// Returns the limit that ended most of the truncated weight.
    #[must_use]
    pub fn limit(&self) -> Option<Limit> {
        Limit::heaviest(self.ended.map(|weight| weight.to_array()))
    }

    /// Adds the counts of `o`, and `share` times its radiance and truncated weight.
    pub(super) fn merge(&mut self, o: &Self, share: f64) {
        self.radiance += o.radiance * share;
        self.truncated += o.truncated * share;
        self.ended.iter_mut().zip(o.ended).for_each(|(sum, weight)| *sum += weight * share);
        self.rays.merge(&o.rays);
        self.non_finite += o.non_finite;
        self.clamped += o.clamped;
        self.unmatched_exits.merge(&o.unmatched_exits);
        self.met.extend(&o.met);
        self.without_map += o.without_map;
        self.without_image += o.without_image;
        self.without_body_map += o.without_body_map;
        self.missed += o.missed;
        self.lit |= o.lit;
    }
}
