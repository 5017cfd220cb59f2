//! The ray-stream kernel: scattered rays traverse the tree together, so that each node is read once for all rays that
//! reach it.
//!
//! After Tsakok 2009 ("Faster Incoherent Rays: Multi-BVH Ray Stream Tracing") and Fuetterling et al. 2015 ("Efficient
//! Ray Tracing Kernels for Modern CPU Architectures"). Rays are sorted by octant, so that near and far planes of a node
//! stay in registers while its list of rays is tested. Unlike in these papers, rays are not copied out of their packets.
//! The eight octants take turns: while one waits for its next node from memory, the others are traced.

use super::super::node::bvh8::{Bvh8, Node8, NodeRef};
use super::super::node::closest_hit::ClosestHit;
use super::super::node::leaf::Leaf;
use super::super::ray::lane_ray::{BoxRays8, LaneRay, LeafRays8};
use super::super::ray::packet8::Packet8;
use crate::geometry::{Hit8, Octant, Ray8};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, compress, set_lanes, transpose_bits};

/// The maximum number of packets in a stream: enough for long lists of rays that still fit in the L2 cache.
pub(super) const STREAM_PACKETS: usize = 1024;

/// A ray is identified by its slot times eight plus its lane, in 16 bits.
const _: () = assert!(8 * STREAM_PACKETS - 1 <= u16::MAX as usize && STREAM_PACKETS.is_power_of_two());

/// Rays that are collected, then traced together. The buffers (512 kB) are allocated for the first ray.
#[derive(Debug, Default)]
pub(super) struct RayStream {
    rays: Option<StreamRays>,
    octants: [OctantTraversal; 8],
}

/// Packets of the stream, by slot.
#[derive(Debug)]
struct StreamRays {
    /// Number of packets. Slots from here on hold rays of earlier streams.
    count: usize,
    boxes: Box<[BoxRays8; STREAM_PACKETS]>,
    leaves: Box<[LeafRays8; STREAM_PACKETS]>,
}

/// The traversal of the rays of one octant. Lists of rays form a stack in `ids`.
#[derive(Debug, Default)]
struct OctantTraversal {
    /// All rays of the octant.
    all: Vec<u16>,
    /// The lists of rays of all nodes on the stack, one after the other.
    ids: Vec<u16>,
    /// Hits of the current list with the boxes of a node, eight rays a word: byte `c` holds the mask of rays that hit
    /// child `c`.
    masks: Vec<u64>,
    stack: Vec<NodeVisit>,
}

/// A node or leaf, and its list of rays: `count` of them from `first` on.
#[derive(Clone, Copy, Debug)]
struct NodeVisit {
    node: NodeRef,
    first: usize,
    count: usize,
}

impl RayStream {
    /// Adds the rays in `lanes` of packet number `index`.
    #[inline(always)]
    pub fn push(&mut self, packet: &Packet8, index: usize, lanes: u8) {
        if lanes == 0 {
            return;
        }
        let rays = self.rays.get_or_insert_with(StreamRays::new);
        let slot = rays.count & (STREAM_PACKETS - 1);
        rays.count = slot + 1;
        rays.boxes[slot] = BoxRays8::new(packet);
        rays.leaves[slot] = LeafRays8::new(packet, index, lanes);
        let octants = packet.octants();
        set_lanes(lanes).for_each(|i| self.octants[usize::from(octants[i] & 7)].all.push((slot * 8 + i) as u16));
    }

    /// Returns true if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.rays.as_ref().is_none_or(|rays| rays.count == 0)
    }

    /// Finds the closest hits. `hits`, by packet, hold the closest hits so far or misses; closer hits replace them.
    #[inline(never)]
    pub fn closest<L: Leaf>(&mut self, tree: &Bvh8<L>, hits: &mut [Hit8]) {
        self.traverse::<L, true>(tree, |rays, leaf, octant, ids| {
            for &id in ids {
                let (slot, lane) = slot_and_lane(id);
                let (boxes, leaves) = (&mut rays.boxes[slot], &rays.leaves[slot]);
                let t_max = boxes.t_max.lane(lane);
                if let Some(found) = leaf.intersect_ray(&LaneRay::new(boxes, leaves, lane, octant), t_max) {
                    let hits = &mut hits[usize::from(leaves.packet)];
                    let mut closest = ClosestHit::of(hits, lane, t_max);
                    closest.update(&found, leaf.tags());
                    boxes.t_max.set_lane(lane, closest.t);
                    hits.set_lane(lane, &closest.hit());
                }
            }
        });
    }

    /// Ends the rays that have any hit. [`RayStream::write_occluded`] reports them.
    #[inline(never)]
    pub fn occluded<L: Leaf>(&mut self, tree: &Bvh8<L>) {
        self.traverse::<L, false>(tree, |rays, leaf, octant, ids| {
            for &id in ids {
                let (slot, lane) = slot_and_lane(id);
                let (boxes, leaves) = (&mut rays.boxes[slot], &rays.leaves[slot]);
                let t_max = boxes.t_max.lane(lane);
                if t_max != f32::NEG_INFINITY
                    && leaf.intersect_ray(&LaneRay::new(boxes, leaves, lane, octant), t_max).is_some()
                {
                    boxes.t_max.set_lane(lane, f32::NEG_INFINITY);
                }
            }
        });
    }

    /// Traverses the tree with all octants, one visit each in turn. `visit` receives each leaf with the rays that reach it.
    #[inline(always)]
    fn traverse<L: Leaf, const CLOSEST: bool>(
        &mut self,
        tree: &Bvh8<L>,
        mut visit: impl FnMut(&mut StreamRays, &L, Octant, &[u16]),
    ) {
        let Some(rays) = &mut self.rays else { return };
        if tree.root == NodeRef::NONE {
            return;
        }
        self.octants.iter_mut().for_each(|traversal| traversal.start(tree.root));
        let mut more = true;
        while more {
            more = false;
            for (o, traversal) in self.octants.iter_mut().enumerate() {
                more |= traversal.step::<L, CLOSEST>(tree, o, rays, &mut visit);
            }
        }
    }

    /// Adds the rays that [`RayStream::occluded`] has ended to `blocked`, by packet.
    #[inline(always)]
    pub fn write_occluded(&self, blocked: &mut [Mask8]) {
        let Some(rays) = &self.rays else { return };
        for (boxes, leaves) in rays.boxes.iter().zip(&*rays.leaves).take(rays.count) {
            let ended = boxes.t_max.eq(-F32x8::INFINITY).bits() & leaves.lanes;
            blocked[usize::from(leaves.packet)] |= Mask8::from_bits(ended);
        }
    }

    /// Removes all rays.
    #[inline(always)]
    pub fn clear(&mut self) {
        if let Some(rays) = &mut self.rays {
            rays.count = 0;
        }
        self.octants.iter_mut().for_each(|traversal| traversal.all.clear());
    }
}

impl StreamRays {
    /// Allocates the slots.
    #[cold]
    fn new() -> Self {
        fn slots<T: Clone>(of: T) -> Box<[T; STREAM_PACKETS]> {
            let all = vec![of; STREAM_PACKETS].try_into();
            all.unwrap_or_else(|_| unreachable!("the vector has this length"))
        }
        let none = Packet8::new(&Ray8::default());
        Self { count: 0, boxes: slots(BoxRays8::new(&none)), leaves: slots(LeafRays8::new(&none, 0, 0)) }
    }
}

/// Slot and lane of a ray.
#[inline(always)]
fn slot_and_lane(id: u16) -> (usize, usize) {
    (usize::from(id >> 3) & (STREAM_PACKETS - 1), usize::from(id & 7))
}

/// The octant whose bits, x lowest, are `o`.
fn octant_of_bits(o: usize) -> Octant {
    [o & 1, o >> 1 & 1, o >> 2 & 1]
}

impl OctantTraversal {
    /// Pushes `root` with all rays.
    fn start(&mut self, root: NodeRef) {
        self.stack.clear();
        let count = self.all.len();
        if count == 0 {
            return;
        }
        self.ids.resize(count.max(self.ids.len()), 0);
        self.ids[..count].copy_from_slice(&self.all);
        self.stack.push(NodeVisit { node: root, first: 0, count });
    }

    /// Pops one entry. A leaf goes to `visit`; the children of a node are pushed, with `CLOSEST` the near ones last, else
    /// the likely blockers last. Returns true if the stack is not empty; then its top is prefetched.
    #[inline(always)]
    fn step<L: Leaf, const CLOSEST: bool>(
        &mut self,
        tree: &Bvh8<L>,
        o: usize,
        rays: &mut StreamRays,
        visit: impl FnOnce(&mut StreamRays, &L, Octant, &[u16]),
    ) -> bool {
        let Some(NodeVisit { node: here, first, count }) = self.stack.pop() else { return false };
        let octant = octant_of_bits(o);
        let end = first + count;
        if here.is_leaf() {
            visit(rays, &tree.leaves[here.index()], octant, &self.ids[first..end]);
        } else {
            // Each of eight children may get all rays, and lists are written in blocks of eight.
            let room = end + 8 * count + 8;
            if self.ids.len() < room {
                self.ids.resize(room, 0);
            }
            let node = &tree.nodes[here.index()];
            let hit = self.boxes_hit(node, octant, first, count, &rays.boxes);
            let mut start = end;
            let mut push = |c: usize| {
                let stop = gather(&mut self.ids, &self.masks, first, count, c, start);
                self.stack.push(NodeVisit { node: node.children[c], first: start, count: stop - start });
                start = stop;
            };
            if CLOSEST {
                for &c in &node.far_to_near(o, hit) {
                    push(usize::from(c));
                }
            } else {
                set_lanes(hit).for_each(push);
            }
        }
        match self.stack.last() {
            Some(next) => tree.prefetch(next.node),
            None => return false,
        }
        true
    }

    /// Fills [`OctantTraversal::masks`]. Returns the children that any ray hits.
    #[inline(always)]
    fn boxes_hit(
        &mut self,
        node: &Node8,
        octant: Octant,
        first: usize,
        count: usize,
        rays: &[BoxRays8; STREAM_PACKETS],
    ) -> u8 {
        let (near, far) = node.boxes.sorted(octant);
        let mut any = 0;
        self.masks.clear();
        for ids in self.ids[first..first + count].chunks(8) {
            let mut masks = 0;
            for (k, &id) in ids.iter().enumerate() {
                let (slot, lane) = slot_and_lane(id);
                let hit = rays[slot].boxes_hit(lane, near, far);
                any |= hit;
                masks |= u64::from(hit) << (8 * k);
            }
            self.masks.push(transpose_bits(masks));
        }
        any
    }
}

/// Copies the rays of a list that hit child `c` to index `to` and on. Returns the index behind the last one.
#[inline(always)]
fn gather(all: &mut [u16], masks: &[u64], first: usize, count: usize, c: usize, mut to: usize) -> usize {
    for (block, masks) in masks[..count.div_ceil(8)].iter().enumerate() {
        let mask = (masks >> (8 * c)) as u8;
        let from = first + 8 * block;
        let Some(&ids) = all[from..].first_chunk() else { break };
        all[to..to + 8].copy_from_slice(&compress(ids, mask));
        to += mask.count_ones() as usize;
    }
    to
}
