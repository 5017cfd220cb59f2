//! Which kernel takes which rays. All kernels give the same bits, so the choice is about speed alone.

use super::beam::{Beam, Hull};
use super::bvh8::{Bvh8, Child};
use super::leaf::Best8;
use super::rays::{Eight, Way8};
use super::sphere8::Sphere8;
use super::stack::Scratch;
use super::traverse_batch::Batch;
use super::traverse_single;
use super::traverse_tile::{self, Group, TILE};
use super::tri8::Tri8;
use crate::accel::Coherence;
use crate::geometry::{Hit8, Ray8};
use crate::simd::{F32x8, Mask8};

/// Packets whose scattered rays are gathered into one batch: as many as make long lists of rays that the second cache holds.
pub(super) const STRETCH: usize = 1024;

/// Fewer packets than this make no lists worth the name: 16 rays are 1.4 times as fast one by one, 64 as fast either way.
const FEW: usize = 8;

/// Nodes in which a tile's beam is looked for anything that it may meet, before its packets are made ready.
const VISITS: usize = 12;

/// How rays are walked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Each ray alone.
    Single,
    /// Together with those of its packet that run into the same octant, however few, eight packets at a time.
    Packet,
    /// All of them node by node.
    Batch,
    /// As the stream's coherence and the packet's occupancy suggest.
    Auto,
}

/// Rays of a packet that go the same way, or that do not.
enum Share {
    /// Together, as a beam; one that is wide has its rays looked at one by one, too.
    Beam { lanes: u8, wide: bool },
    /// Each for itself.
    Apart(u8),
}

impl Kernel {
    /// Whether the scattered ones among so many packets are walked one by one.
    fn alone(self, packets: usize) -> bool {
        self == Self::Single || self == Self::Auto && packets < FEW
    }

    /// Some of `left`, at least one. The caller's word on coherence is checked, since too wide a beam meets too much.
    #[inline(always)]
    fn next(self, way: &Way8, left: u8, coherence: Coherence) -> Share {
        match self {
            Self::Single | Self::Batch => Share::Apart(left),
            Self::Packet => {
                let ahead = way.ahead(left);
                if ahead == 0 { Share::Apart(left) } else { Share::Beam { lanes: way.same_octant(ahead), wide: true } }
            }
            Self::Auto => {
                let coherent = coherence == Coherence::Coherent;
                // Within some 13 degrees, and 15.
                let (enough, agreement) = if coherent { (4, 0.95) } else { (6, 0.998) };
                let of_octant = way.same_octant(left);
                if !coherent && of_octant.count_ones() < enough {
                    return Share::Apart(left);
                }
                let (close, together) = way.same_way(of_octant, agreement);
                let lanes = way.ahead(close);
                if lanes.count_ones() >= enough {
                    Share::Beam { lanes, wide: together & lanes != lanes }
                } else {
                    Share::Apart(if coherent && lanes.count_ones() > 1 { lanes } else { left })
                }
            }
        }
    }
}

/// What is known of a tile before its packets are looked at.
#[derive(Clone, Copy)]
enum Survey {
    /// Its rays meet nothing.
    Misses,
    /// They all go together.
    Narrow { wide: bool },
    /// Nothing.
    Mixed,
}

/// Up to eight packets made ready, and those of their rays that go together.
#[derive(Debug)]
pub(super) struct Tile {
    rays: Box<[Eight; TILE]>,
    best: Box<[Best8; TILE]>,
    groups: Vec<Group>,
}

impl Default for Tile {
    fn default() -> Self {
        let best = Best8::new(F32x8::ZERO);
        Self { rays: Box::default(), best: Box::new([best; TILE]), groups: Vec::with_capacity(8 * TILE) }
    }
}

impl Tile {
    /// Takes in the rays of packet `i` that go together and may meet something in `trees`; which rays do not.
    #[inline(always)]
    fn take(&mut self, trees: &Trees, survey: Survey, next: impl Fn(&Way8, u8) -> Share, i: usize, way: &Way8) -> u8 {
        let (mut left, mut apart) = (way.lanes, 0);
        let before = self.groups.len();
        while left != 0 {
            let share = match survey {
                Survey::Narrow { wide } => Share::Beam { lanes: left, wide },
                _ => next(way, left),
            };
            match share {
                Share::Beam { lanes, wide } => {
                    left &= !lanes;
                    let group = Group::new(way, i, lanes, wide);
                    // A narrow tile's own beam has been followed farther down than this looks.
                    let known = matches!(survey, Survey::Narrow { .. });
                    if known || group.reaches(trees.triangles) || group.reaches(trees.spheres) {
                        self.groups.push(group);
                    }
                }
                Share::Apart(lanes) => {
                    left &= !lanes;
                    apart |= lanes;
                }
            }
        }
        if self.groups.len() > before {
            self.rays[i] = Eight::new(way);
            self.best[i] = Best8::new(way.t_max);
        }
        apart
    }

    /// Calls `go` with the groups, at most eight of one octant at a time.
    #[inline(always)]
    fn by_octant(&mut self, mut go: impl FnMut(&mut [Group], &[Eight; TILE], &mut [Best8; TILE])) {
        let Self { rays, best, groups } = self;
        if groups.windows(2).any(|two| two[0].octant != two[1].octant) {
            groups.sort_unstable_by_key(|g| g.octant);
        }
        for of_octant in groups.chunk_by_mut(|a, b| a.octant == b.octant) {
            for at_most_eight in of_octant.chunks_mut(TILE) {
                go(at_most_eight, rays, best);
            }
        }
    }
}

/// What rays are traced against.
pub(super) struct Trees<'a> {
    pub spheres: &'a Bvh8<Sphere8>,
    pub triangles: &'a Bvh8<Tri8>,
}

impl Trees<'_> {
    #[inline(always)]
    fn any_sphere(&self) -> bool {
        self.spheres.root != Child::NONE
    }

    /// What one beam around all rays of a tile tells of them.
    #[inline(always)]
    fn survey(&self, kernel: Kernel, packets: &[Ray8]) -> Survey {
        let hull = if kernel == Kernel::Auto { Beam::around(packets) } else { None };
        let Some(Hull { beam, octant, narrow, one_start }) = hull else { return Survey::Mixed };
        if !beam.reaches(self.triangles, octant, VISITS) && !beam.reaches(self.spheres, octant, VISITS) {
            Survey::Misses
        } else if narrow {
            Survey::Narrow { wide: !one_start }
        } else {
            Survey::Mixed
        }
    }

    /// Takes those of `lanes` that may meet something into the batch.
    #[inline(always)]
    fn gather(&self, batch: &mut Batch, way: &Way8, packet: usize, lanes: u8) {
        let mut reached = way.reach(self.triangles, lanes);
        if self.any_sphere() {
            reached |= way.reach(self.spheres, lanes);
        }
        batch.push(way, packet, reached);
    }

    /// The nearest hits, written into the active lanes of `hits`.
    pub fn closest(
        &self,
        kernel: Kernel,
        rays: &[Ray8],
        hits: &mut [Hit8],
        coherence: Coherence,
        scratch: &mut Scratch,
    ) {
        let Scratch { single, stack, batch, tile } = scratch;
        let alone = kernel.alone(rays.len());
        for (rays, hits) in rays.chunks(STRETCH).zip(hits.chunks_mut(STRETCH)) {
            for (k, (packets, hits)) in rays.chunks(TILE).zip(hits.chunks_mut(TILE)).enumerate() {
                tile.groups.clear();
                for (rays, hit) in packets.iter().zip(&mut *hits) {
                    if rays.active == u8::MAX {
                        *hit = Hit8::default();
                    } else {
                        Best8::new(F32x8::ZERO).write(rays.active, hit);
                    }
                }
                let survey = self.survey(kernel, packets);
                if matches!(survey, Survey::Misses) {
                    continue;
                }
                for (i, (rays, hit)) in packets.iter().zip(&mut *hits).enumerate() {
                    let way = Way8::new(rays);
                    let apart = tile.take(self, survey, |way, left| kernel.next(way, left, coherence), i, &way);
                    if apart == 0 {
                        continue;
                    }
                    if alone {
                        let mut best = Best8::new(way.t_max);
                        if self.any_sphere() {
                            traverse_single::closest_each(self.spheres, &way, apart, &mut best, single);
                        }
                        traverse_single::closest_each(self.triangles, &way, apart, &mut best, single);
                        best.write(apart, hit);
                    } else {
                        self.gather(batch, &way, k * TILE + i, apart);
                    }
                }
                tile.by_octant(|groups, rays, best| {
                    if self.any_sphere() {
                        traverse_tile::closest(self.spheres, groups, rays, best, stack);
                    }
                    traverse_tile::closest(self.triangles, groups, rays, best, stack);
                    for group in groups {
                        best[group.packet].write(group.lanes, &mut hits[group.packet]);
                    }
                });
            }
            if !batch.is_empty() {
                if self.any_sphere() {
                    batch.closest(self.spheres, hits);
                }
                batch.closest(self.triangles, hits);
                batch.clear();
            }
        }
    }

    /// Which rays meet anything.
    pub fn occluded(
        &self,
        kernel: Kernel,
        rays: &[Ray8],
        blocked: &mut [Mask8],
        coherence: Coherence,
        scratch: &mut Scratch,
    ) {
        let Scratch { single, stack, batch, tile } = scratch;
        let alone = kernel.alone(rays.len());
        for (rays, blocked) in rays.chunks(STRETCH).zip(blocked.chunks_mut(STRETCH)) {
            let mut found = [0_u8; STRETCH];
            for (k, packets) in rays.chunks(TILE).enumerate() {
                let survey = self.survey(kernel, packets);
                if matches!(survey, Survey::Misses) {
                    continue;
                }
                tile.groups.clear();
                for (i, rays) in packets.iter().enumerate() {
                    let way = Way8::new(rays);
                    let apart = tile.take(self, survey, |way, left| kernel.next(way, left, coherence), i, &way);
                    if apart == 0 {
                        continue;
                    }
                    if alone {
                        let met = &mut found[k * TILE + i];
                        if self.any_sphere() {
                            *met = traverse_single::occluded_each(self.spheres, &way, apart, single);
                        }
                        *met |= traverse_single::occluded_each(self.triangles, &way, apart & !*met, single);
                    } else {
                        self.gather(batch, &way, k * TILE + i, apart);
                    }
                }
                tile.by_octant(|groups, rays, best| {
                    if self.any_sphere() {
                        traverse_tile::occluded(self.spheres, groups, rays, best, stack);
                    }
                    traverse_tile::occluded(self.triangles, groups, rays, best, stack);
                    for group in groups {
                        found[k * TILE + group.packet] |= group.blocked;
                    }
                });
            }
            if !batch.is_empty() {
                if self.any_sphere() {
                    batch.occluded(self.spheres);
                }
                batch.occluded(self.triangles);
                batch.finish_blocked(&mut found);
                batch.clear();
            }
            for (blocked, &found) in blocked.iter_mut().zip(&found) {
                *blocked = Mask8::from_bits(found);
            }
        }
    }
}
