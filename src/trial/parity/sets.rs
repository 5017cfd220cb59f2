//! Sets of rays for the comparison of contenders.

use super::aimed::{Targets, ends};
use super::id::Id;
use super::leaving::leaving;
use crate::accel::Coherence;
use crate::accel::reference::Reference;
use crate::geometry::{Geometry, Ray};
use crate::trial::rays::{self, Picture, View};

/// Seed of the aimed rays; any number would do.
const SEED: u64 = 1;

/// Rays of one kind, which share a mask.
#[derive(Clone, Debug)]
pub struct Set {
    /// Name of the kind: a [`crate::trial::RayKind`]; `edge`, `vertex` or `end` for aimed rays; or `leaving` for rays
    /// that start from a surface as the renderer starts them.
    pub name: &'static str,
    /// Coherence hint for contenders.
    pub coherence: Coherence,
    /// Rays.
    pub rays: Vec<Ray>,
    /// Primitive that each ray leaves and must not hit again. Empty for kinds without this check.
    pub leaves: Vec<Option<Id>>,
}

/// Creates about `count` rays of each kind at `geometry`, of which `reference` was built. First come the kinds that
/// pictures consist of, seen from `view`. Then come rays aimed at edges, at corners, and at the ends of their own
/// intervals, and rays that leave a surface by the renderer's rule. Kinds that start from a surface have fewer rays
/// where fewer rays hit one.
#[must_use]
pub fn sets(reference: &Reference, geometry: &[Geometry], view: &View, count: usize) -> Vec<Set> {
    let edge = ((count as f64).sqrt().ceil() as u32).next_multiple_of(8).max(8);
    let kinds = rays::all(reference, geometry, view, &Picture { edge, one_in: 1 });
    let mut sets: Vec<Set> = kinds
        .iter()
        .map(|set| {
            // Thinned out evenly by packets, so that coherence is preserved.
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
