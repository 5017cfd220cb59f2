//! Which kernel takes which rays. All kernels give the same bits, so the choice is about speed alone.

use arrayvec::ArrayVec;

use super::bvh8::{Bvh8, Child};
use super::leaf::Best8;
use super::rays::Eight;
use super::sphere8::Sphere8;
use super::stack::Scratch;
use super::traverse_single;
use super::traverse_tile::{self, Group, TILE};
use super::tri8::Tri8;
use crate::accel::Coherence;
use crate::geometry::{Hit8, Ray8};
use crate::simd::Mask8;

/// Packets whose scattered rays are gathered into one batch.
const STRETCH: usize = 128;

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

impl Kernel {
    /// Some of `left`, at least one, that are to go together, or else which rays are not to. The caller's word on
    /// coherence is checked, since a wide beam meets too much: only rays from one start are narrow enough. It lowers
    /// the number that is enough.
    #[inline(always)]
    fn next(self, rays: &Eight, left: u8, coherence: Coherence) -> Result<u8, u8> {
        match self {
            Self::Single | Self::Batch => Err(left),
            Self::Packet => {
                let ahead = rays.ahead(left);
                if ahead == 0 { Err(left) } else { Ok(rays.same_octant(ahead)) }
            }
            Self::Auto => {
                let coherent = coherence == Coherence::Coherent;
                // Within some 3 degrees, and 1.3.
                let (enough, agreement) = if coherent { (4, 0.997) } else { (6, 0.9995) };
                let lanes = rays.ahead(rays.same_way(rays.same_octant(left), agreement));
                if lanes.count_ones() >= enough {
                    Ok(lanes)
                } else {
                    // Where a ray is the only one of its start, none of the others is expected to have company.
                    Err(if coherent && lanes.count_ones() > 1 { lanes } else { left })
                }
            }
        }
    }
}

/// Up to eight packets made ready, and those of their rays that go together.
struct Tile {
    rays: ArrayVec<Eight, TILE>,
    /// Of each packet, the rays that go alone.
    alone: ArrayVec<u8, TILE>,
    groups: ArrayVec<Group, { TILE * 8 }>,
}

impl Tile {
    #[inline(always)]
    fn new(kernel: Kernel, rays: &[Ray8], coherence: Coherence) -> Self {
        let mut tile = Self { rays: ArrayVec::new(), alone: ArrayVec::new(), groups: ArrayVec::new() };
        for (i, rays) in rays.iter().enumerate() {
            tile.rays.push(Eight::new(rays));
            let rays = &tile.rays[i];
            let (mut left, mut apart) = (rays.lanes, 0);
            while left != 0 {
                left &= !match kernel.next(rays, left, coherence) {
                    Ok(lanes) => {
                        tile.groups.push(Group::new(rays, i, lanes));
                        lanes
                    }
                    Err(lanes) => {
                        apart |= lanes;
                        lanes
                    }
                };
            }
            tile.alone.push(apart);
        }
        tile
    }

    /// Calls `go` with the groups, at most eight of one octant at a time.
    #[inline(always)]
    fn by_octant(&mut self, mut go: impl FnMut(&mut [Group], &[Eight])) {
        let Self { rays, groups, .. } = self;
        if groups.windows(2).any(|two| two[0].octant != two[1].octant) {
            groups.sort_unstable_by_key(|g| g.octant);
        }
        for of_octant in groups.chunk_by_mut(|a, b| a.octant == b.octant) {
            for at_most_eight in of_octant.chunks_mut(TILE) {
                go(at_most_eight, rays);
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
    /// The nearest hits, written into the active lanes of `hits`.
    pub fn closest(
        &self,
        kernel: Kernel,
        rays: &[Ray8],
        hits: &mut [Hit8],
        coherence: Coherence,
        scratch: &mut Scratch,
    ) {
        let spheres = self.spheres.root != Child::NONE;
        let Scratch { single, tile: stack, batch, best, .. } = scratch;
        for (rays, hits) in rays.chunks(STRETCH).zip(hits.chunks_mut(STRETCH)) {
            best.clear();
            for packets in rays.chunks(TILE) {
                let first = best.len();
                let mut tile = Tile::new(kernel, packets, coherence);
                best.extend(tile.rays.iter().map(|rays| Best8::new(rays.t_max)));
                let best = &mut best[first..];
                for (i, (rays, &lanes)) in tile.rays.iter().zip(&tile.alone).enumerate() {
                    if kernel == Kernel::Single {
                        if spheres {
                            traverse_single::closest_each(self.spheres, rays, lanes, &mut best[i], single);
                        }
                        traverse_single::closest_each(self.triangles, rays, lanes, &mut best[i], single);
                    } else {
                        batch.push(rays, first + i, lanes);
                    }
                }
                tile.by_octant(|groups, rays| {
                    if spheres {
                        traverse_tile::closest(self.spheres, groups, rays, best, stack);
                    }
                    traverse_tile::closest(self.triangles, groups, rays, best, stack);
                });
            }
            if !batch.is_empty() {
                if spheres {
                    batch.closest(self.spheres, single);
                }
                batch.closest(self.triangles, single);
                batch.finish(best);
            }
            for ((rays, hits), best) in rays.iter().zip(hits).zip(best.iter()) {
                best.write(rays.active, hits);
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
        let spheres = self.spheres.root != Child::NONE;
        let Scratch { single, tile: stack, batch, blocked: found, .. } = scratch;
        for (rays, blocked) in rays.chunks(STRETCH).zip(blocked.chunks_mut(STRETCH)) {
            found.clear();
            found.resize(rays.len(), 0);
            for (k, packets) in rays.chunks(TILE).enumerate() {
                let found = &mut found[k * TILE..];
                let mut tile = Tile::new(kernel, packets, coherence);
                for (i, (rays, &lanes)) in tile.rays.iter().zip(&tile.alone).enumerate() {
                    if kernel == Kernel::Single {
                        if spheres {
                            found[i] = traverse_single::occluded_each(self.spheres, rays, lanes, single);
                        }
                        let left = lanes & !found[i];
                        found[i] |= traverse_single::occluded_each(self.triangles, rays, left, single);
                    } else {
                        batch.push(rays, k * TILE + i, lanes);
                    }
                }
                tile.by_octant(|groups, rays| {
                    let mut before = [0; TILE];
                    for (before, group) in before.iter_mut().zip(&*groups) {
                        *before = group.lanes;
                    }
                    if spheres {
                        traverse_tile::occluded(self.spheres, groups, rays, stack);
                    }
                    traverse_tile::occluded(self.triangles, groups, rays, stack);
                    for (before, group) in before.iter().zip(groups) {
                        found[group.packet] |= before & !group.lanes;
                    }
                });
            }
            if !batch.is_empty() {
                if spheres {
                    batch.occluded(self.spheres, single);
                }
                batch.occluded(self.triangles, single);
                batch.finish_blocked(found);
            }
            for (blocked, &found) in blocked.iter_mut().zip(found.iter()) {
                *blocked = Mask8::from_bits(found);
            }
        }
    }
}
