//! The sets of rays that contenders are asked about.

use super::Id;
use super::aimed::{Targets, ends};
use super::leaving::leaving;
use crate::accel::Coherence;
use crate::accel::reference::Reference;
use crate::geometry::{Geometry, Ray};
use crate::trial::rays::{self, Picture, View};

/// What aimed rays are drawn from; any number would do.
const SEED: u64 = 1;

/// Rays of one kind, which share a mask.
#[derive(Clone, Debug)]
pub struct Set {
    /// The kind: a [`crate::trial::RayKind`], `edge`, `vertex` or `end` for those aimed at trouble, or `leaving` for those
    /// started from a surface as the renderer starts them.
    pub name: &'static str,
    /// What contenders are told of their order.
    pub coherence: Coherence,
    /// The rays.
    pub rays: Vec<Ray>,
    /// The primitive that each ray leaves and must not meet again. Empty for kinds that are not checked for this.
    pub leaves: Vec<Option<Id>>,
}

/// About `count` rays of each kind at `geometry`, of which `reference` was built: those that pictures are made of as
/// seen from `view`, then those aimed at edges, at corners, and at the ends of their own intervals, then those that leave
/// a surface as the renderer's do. Of kinds that start from a surface there are fewer where fewer rays meet one.
#[must_use]
pub fn sets(reference: &Reference, geometry: &[Geometry], view: &View, count: usize) -> Vec<Set> {
    let edge = ((count as f64).sqrt().ceil() as u32).next_multiple_of(8).max(8);
    let kinds = rays::all(reference, geometry, view, &Picture { edge, one_in: 1 });
    let mut sets: Vec<Set> = kinds
        .iter()
        .map(|set| {
            // Evenly thinned out in packets, so that what is left is as coherent as it was.
            let packets = set.count.div_ceil(8);
            let wanted = count.div_ceil(8).clamp(1, packets.max(1));
            let packets = (0..wanted.min(packets)).map(|k| k * packets / wanted);
            let lanes = packets.flat_map(|p| (0..8).map(move |i| (p, i))).filter(|(p, i)| 8 * p + i < set.count);
            let rays = lanes.map(|(p, i)| set.rays[p].lane(i)).collect();
            Set { name: set.kind.name(), coherence: set.kind.coherence(), rays, leaves: Vec::new() }
        })
        .collect();
    let targets = Targets::new(geometry);
    let aimed = [("edge", targets.edges(count, SEED)), ("vertex", targets.vertices(count, SEED))];
    let end = ends(reference, &sets[0].rays);
    let aimed = aimed.into_iter().chain([("end", end)]);
    let (away, leaves) = leaving(reference, geometry, &sets[0].rays[..sets[0].rays.len().min(count.div_ceil(2))]);
    let aimed = aimed.map(|(name, rays)| (name, rays, Vec::new())).chain([("leaving", away, leaves)]);
    let aimed: Vec<Set> =
        aimed.map(|(name, rays, leaves)| Set { name, coherence: Coherence::Incoherent, rays, leaves }).collect();
    sets.extend(aimed);
    sets
}
