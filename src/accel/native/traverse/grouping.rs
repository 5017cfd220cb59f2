//! The choice of kernel for each ray, and the tile of packets that share a traversal.
//!
//! All kernels give the same hits to the bit, so that the choice affects speed only.

use super::super::node::bvh8::Bvh8;
use super::super::node::closest_hit::ClosestHit8;
use super::super::node::sphere8::Sphere8;
use super::super::node::tri8::Tri8;
use super::super::ray::packet8::{LeafPacket8, Packet8};
use super::frustum::{Frustum, TileFrustum};
use super::tile::{RayGroup, TILE};
use crate::accel::Coherence;
use crate::geometry::Ray8;
use crate::simd::F32x8;

/// Streams of fewer packets make lists too short to pay: 16 rays are 1.4 times as fast one by one, 64 as fast either way.
const FEW: usize = 8;

/// The number of nodes in which a tile's frustum is tested before its packets are prepared.
const VISITS: usize = 12;

/// The kernel that traces rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// One ray at a time.
    Single,
    /// The rays of a packet together that share an octant, however few, eight packets at a time.
    Packet,
    /// All rays of the stream together, node by node.
    Stream,
    /// The kernel that suits the stream's coherence and the packet's active lanes.
    Auto,
}

/// The two hierarchies of an accelerator.
#[derive(Clone, Copy)]
pub(crate) struct Trees<'a> {
    /// Over spheres.
    pub spheres: &'a Bvh8<Sphere8>,
    /// Over triangles.
    pub triangles: &'a Bvh8<Tri8>,
}

/// Rays of a packet, and how they are traced.
enum Grouping {
    /// The rays in `lanes` form a [`RayGroup`]; `wide` as there.
    Frustum { lanes: u8, wide: bool },
    /// These rays are traced one by one, or in a stream.
    Scattered(u8),
}

impl Kernel {
    /// Returns true if scattered rays of a stream of this many packets are traced one by one.
    pub fn traces_singly(self, packets: usize) -> bool {
        self == Self::Single || self == Self::Auto && packets < FEW
    }

    /// Chooses how some of the rays in `left`, at least one, are traced. The caller's `coherence` is checked, since too wide
    /// a frustum hits too many boxes.
    #[inline(always)]
    fn group(self, rays: &Packet8, left: u8, coherence: Coherence) -> Grouping {
        match self {
            Self::Single | Self::Stream => Grouping::Scattered(left),
            Self::Packet => {
                let ahead = rays.ahead(left);
                if ahead == 0 {
                    Grouping::Scattered(left)
                } else {
                    Grouping::Frustum { lanes: rays.same_octant(ahead), wide: true }
                }
            }
            Self::Auto => {
                let coherent = coherence == Coherence::Coherent;
                // Squared cosines: within about 13 degrees, or 2.6.
                let (enough, agreement) = if coherent { (4, 0.95) } else { (6, 0.998) };
                let of_octant = rays.same_octant(left);
                if !coherent && of_octant.count_ones() < enough {
                    return Grouping::Scattered(left);
                }
                let (close, together) = rays.similar(of_octant, agreement);
                let lanes = rays.ahead(close);
                if lanes.count_ones() >= enough {
                    Grouping::Frustum { lanes, wide: together & lanes != lanes }
                } else {
                    Grouping::Scattered(if coherent && lanes.count_ones() > 1 { lanes } else { left })
                }
            }
        }
    }
}

/// The result of testing one frustum around all rays of a tile.
#[derive(Clone, Copy)]
pub(super) enum TileTest {
    /// The rays hit nothing.
    Miss,
    /// Each packet is one group; `wide` as in [`RayGroup`].
    Narrow { wide: bool },
    /// Undecided.
    Mixed,
}

impl TileTest {
    /// Tests the frustum around `packets`, if `kernel` is [`Kernel::Auto`] and the rays have a frustum.
    #[inline(always)]
    pub fn new(trees: &Trees, kernel: Kernel, packets: &[Ray8]) -> Self {
        let around = if kernel == Kernel::Auto { Frustum::around(packets) } else { None };
        let Some(TileFrustum { frustum, octant, narrow, one_origin }) = around else { return Self::Mixed };
        if !frustum.reaches(trees.triangles, octant, VISITS) && !frustum.reaches(trees.spheres, octant, VISITS) {
            Self::Miss
        } else if narrow {
            Self::Narrow { wide: !one_origin }
        } else {
            Self::Mixed
        }
    }
}

/// Up to eight packets prepared for traversal, and the groups of their rays.
#[derive(Debug)]
pub(super) struct Tile {
    rays: Box<[LeafPacket8; TILE]>,
    closest: Box<[ClosestHit8; TILE]>,
    groups: Vec<RayGroup>,
}

impl Default for Tile {
    fn default() -> Self {
        let closest = ClosestHit8::new(F32x8::ZERO);
        Self { rays: Box::default(), closest: Box::new([closest; TILE]), groups: Vec::with_capacity(8 * TILE) }
    }
}

impl Tile {
    /// Removes all packets.
    pub fn clear(&mut self) {
        self.groups.clear();
    }

    /// Forms groups of the rays of packet number `i` and keeps those that may hit something. Returns the lanes of scattered
    /// rays.
    #[inline(always)]
    pub fn push(&mut self, trees: &Trees, test: TileTest, choice: (Kernel, Coherence), i: usize, rays: &Packet8) -> u8 {
        let (mut left, mut scattered) = (rays.lanes, 0);
        let before = self.groups.len();
        while left != 0 {
            let grouping = match test {
                TileTest::Narrow { wide } => Grouping::Frustum { lanes: left, wide },
                _ => choice.0.group(rays, left, choice.1),
            };
            match grouping {
                Grouping::Frustum { lanes, wide } => {
                    left &= !lanes;
                    let group = RayGroup::new(rays, i, lanes, wide);
                    // The frustum of a narrow tile has already been tested deeper than this one would be.
                    let tested = matches!(test, TileTest::Narrow { .. });
                    if tested || group.reaches(trees.triangles) || group.reaches(trees.spheres) {
                        self.groups.push(group);
                    }
                }
                Grouping::Scattered(lanes) => {
                    left &= !lanes;
                    scattered |= lanes;
                }
            }
        }
        if self.groups.len() > before {
            self.rays[i] = LeafPacket8::new(rays);
            self.closest[i] = ClosestHit8::new(rays.t_max);
        }
        scattered
    }

    /// Calls `f` with the groups, at most eight of one octant at a time, and with the tile's packets and closest hits.
    #[inline(always)]
    pub fn for_each_octant(
        &mut self,
        mut f: impl FnMut(&mut [RayGroup], &[LeafPacket8; TILE], &mut [ClosestHit8; TILE]),
    ) {
        let Self { rays, closest, groups } = self;
        if groups.windows(2).any(|two| two[0].octant != two[1].octant) {
            groups.sort_unstable_by_key(|g| g.octant);
        }
        for of_octant in groups.chunk_by_mut(|a, b| a.octant == b.octant) {
            for at_most_eight in of_octant.chunks_mut(TILE) {
                f(at_most_eight, rays, closest);
            }
        }
    }
}
