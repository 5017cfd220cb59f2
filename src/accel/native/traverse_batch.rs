//! Many scattered rays together, node by node: each node of the tree is read once for all rays that reach it.
//!
//! After Tsakok 2009 ("Faster Incoherent Rays: Multi-BVH Ray Stream Tracing") and Fuetterling et al. 2015 ("Efficient
//! Ray Tracing Kernels for Modern CPU Architectures"): rays are parted by octant, so that near and far planes of a
//! node stay in registers while its list of rays goes by. Unlike theirs, rays are not copied out of their packets. The
//! octants are walked by turns: what one will visit next comes from memory while the others are at work.

use super::bits::{compress, transpose};
use super::bvh8::{Bvh8, Child, Node8};
use super::leaf::{Best, Leaf};
use super::one::{Cold8, Hot8, One};
use super::rays::{Way8, each};
use super::traverse_stream::STRETCH;
use super::traverse_tile::fetch;
use crate::geometry::{Hit8, Ray8};
use crate::math::Real;
use crate::simd::F32x8;

/// Rays that wait to be traced together, and room for them, made when the first comes: 512 kB.
#[derive(Debug, Default)]
pub(super) struct Batch {
    rays: Option<Rays>,
    lists: [Lists; 8],
}

/// Packets with such rays, side by side. A ray is named by its place times eight and its lane.
#[derive(Debug)]
struct Rays {
    /// How many packets there are; what lies behind them was left by others.
    count: usize,
    hot: Box<[Hot8; STRETCH]>,
    cold: Box<[Cold8; STRETCH]>,
}

/// Lists of rays, each below the ones made after it.
#[derive(Debug, Default)]
struct Lists {
    /// The rays that it begins with.
    all: Vec<u16>,
    ids: Vec<u16>,
    /// Of the list at hand, for each eight rays, a byte a child: which of them meet it.
    masks: Vec<u64>,
    stack: Vec<Visit>,
}

/// A node and the rays that are to visit it.
#[derive(Clone, Copy, Debug)]
struct Visit {
    child: Child,
    first: usize,
    count: usize,
}

impl Batch {
    /// Takes in the rays in `lanes` of a packet.
    #[inline(always)]
    pub fn push(&mut self, way: &Way8, packet: usize, lanes: u8) {
        if lanes == 0 {
            return;
        }
        let rays = self.rays.get_or_insert_with(Rays::none);
        let slot = rays.count & (STRETCH - 1);
        rays.count = slot + 1;
        rays.hot[slot] = Hot8::new(way);
        rays.cold[slot] = Cold8::new(way, packet, lanes);
        let octants = way.octants();
        each(lanes, |i| self.lists[usize::from(octants[i] & 7)].all.push((slot * 8 + i) as u16));
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rays.as_ref().is_none_or(|rays| rays.count == 0)
    }

    /// Takes the nearest hits into `hits`, by packet, which hold those found so far, or misses.
    #[inline(never)]
    pub fn closest<L: Leaf>(&mut self, tree: &Bvh8<L>, hits: &mut [Hit8]) {
        self.by_turns::<L, true>(tree, |rays, leaf, octant, ids| {
            for &id in ids {
                let (slot, lane) = place(id);
                let (hot, cold) = (&mut rays.hot[slot], &rays.cold[slot]);
                let t_max = hot.t_max.lane(lane);
                if let Some(met) = leaf.meet_one(&One::new(hot, cold, lane, octant), t_max) {
                    let hits = &mut hits[usize::from(cold.packet)];
                    let mut best = Best::of(hits, lane, t_max);
                    best.take(&met, leaf.tags());
                    hot.t_max.set_lane(lane, best.t);
                    hits.set_lane(lane, &best.hit());
                }
            }
        });
    }

    /// Ends the rays that meet anything, which [`Batch::finish_blocked`] then names.
    #[inline(never)]
    pub fn occluded<L: Leaf>(&mut self, tree: &Bvh8<L>) {
        self.by_turns::<L, false>(tree, |rays, leaf, octant, ids| {
            for &id in ids {
                let (slot, lane) = place(id);
                let (hot, cold) = (&mut rays.hot[slot], &rays.cold[slot]);
                let t_max = hot.t_max.lane(lane);
                if t_max != f32::NEG_INFINITY && leaf.meet_one(&One::new(hot, cold, lane, octant), t_max).is_some() {
                    hot.t_max.set_lane(lane, f32::NEG_INFINITY);
                }
            }
        });
    }

    /// Walks all octants, a visit each in turn; `leaf` takes the rays that reach one.
    #[inline(always)]
    fn by_turns<L: Leaf, const NEAREST: bool>(
        &mut self,
        tree: &Bvh8<L>,
        mut leaf: impl FnMut(&mut Rays, &L, [usize; 3], &[u16]),
    ) {
        let Some(rays) = &mut self.rays else { return };
        if tree.root == Child::NONE {
            return;
        }
        self.lists.iter_mut().for_each(|lists| lists.start(tree.root));
        let mut more = true;
        while more {
            more = false;
            for (o, lists) in self.lists.iter_mut().enumerate() {
                more |= lists.step::<L, NEAREST>(tree, o, rays, &mut leaf);
            }
        }
    }

    /// Marks the rays that were blocked, a byte a packet.
    #[inline(always)]
    pub fn finish_blocked(&self, blocked: &mut [u8]) {
        let Some(rays) = &self.rays else { return };
        for (hot, cold) in rays.hot.iter().zip(&*rays.cold).take(rays.count) {
            blocked[usize::from(cold.packet)] |= hot.t_max.eq(-F32x8::INFINITY).bits() & cold.lanes;
        }
    }

    /// Lets go of all rays.
    #[inline(always)]
    pub fn clear(&mut self) {
        if let Some(rays) = &mut self.rays {
            rays.count = 0;
        }
        self.lists.iter_mut().for_each(|lists| lists.all.clear());
    }
}

impl Rays {
    /// Room for some.
    #[cold]
    fn none() -> Self {
        fn room<T: Clone>(of: T) -> Box<[T; STRETCH]> {
            let all = vec![of; STRETCH].try_into();
            all.unwrap_or_else(|_| unreachable!("it was made as long as that"))
        }
        let way = Way8::new(&Ray8::default());
        Self { count: 0, hot: room(Hot8::new(&way)), cold: room(Cold8::new(&way, 0, 0)) }
    }
}

/// A ray's name holds its place and its lane.
const _: () = assert!(8 * STRETCH - 1 <= u16::MAX as usize && STRETCH.is_power_of_two());

/// Where a ray is: which packet, which lane.
#[inline(always)]
fn place(id: u16) -> (usize, usize) {
    (usize::from(id >> 3) & (STRETCH - 1), usize::from(id & 7))
}

/// For each axis, 1 where rays of octant `o` run backwards along it.
fn octant(o: usize) -> [usize; 3] {
    [o & 1, o >> 1 & 1, o >> 2 & 1]
}

impl Lists {
    /// Begins at `root` with all rays.
    fn start(&mut self, root: Child) {
        self.stack.clear();
        let count = self.all.len();
        if count == 0 {
            return;
        }
        self.ids.resize(count.max(self.ids.len()), 0);
        self.ids[..count].copy_from_slice(&self.all);
        self.stack.push(Visit { child: root, first: 0, count });
    }

    /// One visit: to a node, whose children go on the stack, roughly near ones last where the `NEAREST` hit is wanted,
    /// else likely blockers; or to a leaf. Whether there are more to come, of which the next is asked for from memory.
    #[inline(always)]
    fn step<L: Leaf, const NEAREST: bool>(
        &mut self,
        tree: &Bvh8<L>,
        o: usize,
        rays: &mut Rays,
        leaf: impl FnOnce(&mut Rays, &L, [usize; 3], &[u16]),
    ) -> bool {
        let Some(Visit { child, first, count }) = self.stack.pop() else { return false };
        let octant = octant(o);
        let end = first + count;
        if child.is_leaf() {
            leaf(rays, &tree.leaves[child.index()], octant, &self.ids[first..end]);
        } else {
            // Eight children may each get all rays, and blocks of eight are written whole.
            let room = end + 8 * count + 8;
            if self.ids.len() < room {
                self.ids.resize(room, 0);
            }
            let node = &tree.nodes[child.index()];
            let met = self.meet(node, octant, first, count, &rays.hot);
            let mut start = end;
            let mut push = |c: usize| {
                let stop = gather(&mut self.ids, &self.masks, first, count, c, start);
                self.stack.push(Visit { child: node.children[c], first: start, count: stop - start });
                start = stop;
            };
            if NEAREST {
                for &c in &node.far_to_near(o, met) {
                    push(usize::from(c));
                }
            } else {
                each(met, push);
            }
        }
        match self.stack.last() {
            Some(next) => fetch(tree, next.child),
            None => return false,
        }
        true
    }

    /// Fills [`Lists::masks`]; the children that some ray meets.
    #[inline(always)]
    fn meet(&mut self, node: &Node8, octant: [usize; 3], first: usize, count: usize, hot: &[Hot8; STRETCH]) -> u8 {
        let (near, far) = node.sorted(octant);
        let mut any = 0;
        self.masks.clear();
        for ids in self.ids[first..first + count].chunks(8) {
            let mut masks = 0;
            for (k, &id) in ids.iter().enumerate() {
                let (slot, lane) = place(id);
                let met = hot[slot].meet(lane, near, far);
                any |= met;
                masks |= u64::from(met) << (8 * k);
            }
            self.masks.push(transpose(masks));
        }
        any
    }
}

/// Writes the rays of a list that meet child `c` from `to` on; where they end.
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
