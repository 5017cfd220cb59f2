//! The dispatcher: it divides a stream of packets between the kernels, for closest-hit and any-hit queries alike.

use super::super::node::bvh8::NodeRef;
use super::super::node::closest_hit::ClosestHit8;
use super::super::ray::packet8::{LeafPacket8, Packet8};
pub use super::grouping::Kernel;
pub(crate) use super::grouping::Trees;
use super::grouping::{Tile, TileTest};
use super::stack::{Stack, new_stack};
use super::stream::{RayStream, STREAM_PACKETS};
use super::tile::{RayGroup, TILE};
use super::{single, tile};
use crate::accel::Coherence;
use crate::geometry::{Hit8, Ray8};
use crate::simd::{F32x8, Mask8};

/// Buffers that are kept between calls, so that tracing allocates no memory.
#[derive(Debug)]
pub struct Scratch {
    single: Box<Stack>,
    tile: Tile,
    tile_stack: Box<Stack>,
    stream: RayStream,
}

impl Default for Scratch {
    fn default() -> Self {
        Self { single: new_stack(), tile: Tile::default(), tile_stack: new_stack(), stream: RayStream::default() }
    }
}

/// A query that the kernels answer, packet by packet.
trait Query {
    /// The answer for one packet.
    type Answer;

    /// Sets the answer to that of rays without hits. Closest-hit queries leave inactive lanes as they are.
    fn reset(rays: &Ray8, answer: &mut Self::Answer);

    /// Answers for the rays in `lanes` of a packet, one by one.
    fn single(trees: &Trees, rays: &Packet8, lanes: u8, answer: &mut Self::Answer, stack: &mut Stack);

    /// Answers for the groups of a tile, at most eight of one octant. The slices are indexed by packet.
    fn tile(trees: &Trees, groups: &mut [RayGroup], packets: TilePackets<Self::Answer>, stack: &mut Stack);

    /// Answers for the rays of a stream.
    fn stream(trees: &Trees, stream: &mut RayStream, answers: &mut [Self::Answer]);
}

/// The packets of a tile, with closest hits and answers.
struct TilePackets<'a, A> {
    rays: &'a [LeafPacket8; TILE],
    closest: &'a mut [ClosestHit8; TILE],
    answers: &'a mut [A],
}

/// The closest hit of each ray.
struct Closest;

impl Query for Closest {
    type Answer = Hit8;

    #[inline(always)]
    fn reset(rays: &Ray8, hits: &mut Hit8) {
        if rays.active == u8::MAX {
            *hits = Hit8::default();
        } else {
            ClosestHit8::new(F32x8::ZERO).write(rays.active, hits);
        }
    }

    #[inline(always)]
    fn single(trees: &Trees, rays: &Packet8, lanes: u8, hits: &mut Hit8, stack: &mut Stack) {
        let mut closest = ClosestHit8::new(rays.t_max);
        if trees.has_spheres() {
            single::closest(trees.spheres, rays, lanes, &mut closest, stack);
        }
        single::closest(trees.triangles, rays, lanes, &mut closest, stack);
        closest.write(lanes, hits);
    }

    #[inline(always)]
    fn tile(trees: &Trees, groups: &mut [RayGroup], packets: TilePackets<Hit8>, stack: &mut Stack) {
        let TilePackets { rays, closest, answers } = packets;
        if trees.has_spheres() {
            tile::closest(trees.spheres, groups, rays, closest, stack);
        }
        tile::closest(trees.triangles, groups, rays, closest, stack);
        for group in groups {
            closest[group.packet].write(group.lanes, &mut answers[group.packet]);
        }
    }

    #[inline(always)]
    fn stream(trees: &Trees, stream: &mut RayStream, hits: &mut [Hit8]) {
        if trees.has_spheres() {
            stream.closest(trees.spheres, hits);
        }
        stream.closest(trees.triangles, hits);
    }
}

/// The rays with any hit.
struct Occluded;

impl Query for Occluded {
    type Answer = Mask8;

    #[inline(always)]
    fn reset(_rays: &Ray8, blocked: &mut Mask8) {
        *blocked = Mask8::NONE;
    }

    #[inline(always)]
    fn single(trees: &Trees, rays: &Packet8, lanes: u8, blocked: &mut Mask8, stack: &mut Stack) {
        let mut bits = 0;
        if trees.has_spheres() {
            bits = single::occluded(trees.spheres, rays, lanes, stack);
        }
        bits |= single::occluded(trees.triangles, rays, lanes & !bits, stack);
        *blocked = Mask8::from_bits(bits);
    }

    #[inline(always)]
    fn tile(trees: &Trees, groups: &mut [RayGroup], packets: TilePackets<Mask8>, stack: &mut Stack) {
        let TilePackets { rays, closest, answers } = packets;
        if trees.has_spheres() {
            tile::occluded(trees.spheres, groups, rays, closest, stack);
        }
        tile::occluded(trees.triangles, groups, rays, closest, stack);
        for group in groups {
            answers[group.packet] |= Mask8::from_bits(group.blocked);
        }
    }

    #[inline(always)]
    fn stream(trees: &Trees, stream: &mut RayStream, blocked: &mut [Mask8]) {
        if trees.has_spheres() {
            stream.occluded(trees.spheres);
        }
        stream.occluded(trees.triangles);
        stream.write_occluded(blocked);
    }
}

impl Trees<'_> {
    #[inline(always)]
    fn has_spheres(&self) -> bool {
        self.spheres.root != NodeRef::NONE
    }

    /// Adds the rays of `lanes` that hit a child of a root to the stream.
    #[inline(always)]
    fn push_reaching(&self, stream: &mut RayStream, rays: &Packet8, packet: usize, lanes: u8) {
        let mut reaching = self.triangles.lanes_reaching(rays, lanes);
        if self.has_spheres() {
            reaching |= self.spheres.lanes_reaching(rays, lanes);
        }
        stream.push(rays, packet, reaching);
    }

    /// Writes the closest hits, or misses, into the active lanes of `hits`.
    pub fn closest(&self, choice: (Kernel, Coherence), rays: &[Ray8], hits: &mut [Hit8], scratch: &mut Scratch) {
        self.answer::<Closest>(choice, rays, hits, scratch);
    }

    /// Writes the lanes of active rays with any hit.
    pub fn occluded(&self, choice: (Kernel, Coherence), rays: &[Ray8], blocked: &mut [Mask8], scratch: &mut Scratch) {
        self.answer::<Occluded>(choice, rays, blocked, scratch);
    }

    /// Answers a query for all rays, a tile at a time. Scattered rays are collected, and traced once for each
    /// [`STREAM_PACKETS`] packets.
    #[inline(always)]
    fn answer<Q: Query>(
        &self,
        choice: (Kernel, Coherence),
        rays: &[Ray8],
        answers: &mut [Q::Answer],
        scratch: &mut Scratch,
    ) {
        let Scratch { single, tile, tile_stack, stream } = scratch;
        let singly = choice.0.traces_singly(rays.len());
        for (rays, answers) in rays.chunks(STREAM_PACKETS).zip(answers.chunks_mut(STREAM_PACKETS)) {
            for (k, (packets, answers)) in rays.chunks(TILE).zip(answers.chunks_mut(TILE)).enumerate() {
                tile.clear();
                for (rays, answer) in packets.iter().zip(&mut *answers) {
                    Q::reset(rays, answer);
                }
                let test = TileTest::new(self, choice.0, packets);
                if matches!(test, TileTest::Miss) {
                    continue;
                }
                for (i, (rays, answer)) in packets.iter().zip(&mut *answers).enumerate() {
                    let rays = Packet8::new(rays);
                    let scattered = tile.push(self, test, choice, i, &rays);
                    if scattered == 0 {
                        continue;
                    }
                    if singly {
                        Q::single(self, &rays, scattered, answer, single);
                    } else {
                        self.push_reaching(stream, &rays, k * TILE + i, scattered);
                    }
                }
                tile.for_each_octant(|groups, rays, closest| {
                    Q::tile(self, groups, TilePackets { rays, closest, answers: &mut *answers }, tile_stack);
                });
            }
            if !stream.is_empty() {
                Q::stream(self, stream, answers);
                stream.clear();
            }
        }
    }
}
