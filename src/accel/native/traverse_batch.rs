//! Many scattered rays together, node by node: each node of the tree is read once for all rays that reach it.
//!
//! After Tsakok 2009 ("Faster Incoherent Rays: Multi-BVH Ray Stream Tracing") and Fuetterling et al. 2015 ("Efficient
//! Ray Tracing Kernels for Modern CPU Architectures"): rays are parted by octant, so that near and far planes of a
//! node stay in registers while its list of rays goes by, each with the 32 bytes that the box test needs. A list that
//! has become short is finished ray by ray.

use super::bits::{compress, transpose};
use super::bvh8::{Bvh8, Child, Node8, Planes};
use super::leaf::{Best, Leaf};
use super::rays::{Hot, One, Turned, Way8, each};
use super::stack::Stack;
use super::traverse_single;
use super::traverse_stream::STRETCH;
use super::traverse_tile::fetch;
use crate::geometry::Hit8;
use crate::math::Real;
use crate::simd::{F32x8, Vec3x8};

/// A list of no more rays than this is finished ray by ray.
const FEW: usize = 4;

/// Rays that a batch has room for.
const ROOM: usize = 8 * STRETCH;

/// Rays that wait to be traced together, and room for the work.
#[derive(Debug)]
pub(super) struct Batch {
    /// How many there are.
    count: usize,
    hot: Box<[Hot; ROOM]>,
    turned: Box<[Turned; ROOM]>,
    best: Box<[Best; ROOM]>,
    /// Whose rays they are: packet times eight, and lane.
    owner: Box<[u16; ROOM]>,
    /// By octant, those that go there, and how many these are.
    octants: Box<[[u16; ROOM]; 8]>,
    counts: [usize; 8],
    lists: Lists,
}

impl Default for Batch {
    fn default() -> Self {
        Self {
            count: 0,
            hot: bytemuck::zeroed_box(),
            turned: bytemuck::zeroed_box(),
            best: Box::new([Best::new(0.0); ROOM]),
            owner: bytemuck::zeroed_box(),
            octants: bytemuck::zeroed_box(),
            counts: [0; 8],
            lists: Lists::default(),
        }
    }
}

/// Lists of rays, each below the ones made after it.
#[derive(Debug, Default)]
struct Lists {
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
    pub fn push(&mut self, rays: &Way8, packet: usize, lanes: u8) {
        if lanes == 0 {
            return;
        }
        let (hot, turned) = rays.split();
        let octants = rays.octants();
        each(lanes, |i| {
            let id = self.count & (ROOM - 1);
            self.count = id + 1;
            self.hot[id] = hot[i];
            self.turned[id] = turned[i];
            self.best[id] = Best::new(hot[i].t_max);
            self.owner[id] = (packet * 8 + i) as u16;
            let octant = usize::from(octants[i] & 7);
            let place = self.counts[octant] & (ROOM - 1);
            self.octants[octant][place] = id as u16;
            self.counts[octant] = place + 1;
        });
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Takes the nearest hits into what is known of the rays.
    #[inline(never)]
    pub fn closest<L: Leaf>(&mut self, tree: &Bvh8<L>, stack: &mut Stack) {
        let Self { hot, turned, best, octants, counts, lists, .. } = self;
        for (o, ids) in octants.iter().enumerate() {
            lists.walk::<L, true>(tree, octant(o), &ids[..counts[o]], &mut **hot, |child, ids, hot| {
                for &id in ids {
                    let id = usize::from(id);
                    let (ray, best) = (One::from(&hot[id], &turned[id]), &mut best[id]);
                    if child.is_leaf() {
                        tree.leaves[child.index()].closest_one(&ray, best);
                    } else {
                        traverse_single::closest(tree, child, &ray, best, stack);
                    }
                    hot[id].t_max = best.t;
                }
            });
        }
    }

    /// Ends the rays that meet anything, which [`Batch::blocked`] then names.
    #[inline(never)]
    pub fn occluded<L: Leaf>(&mut self, tree: &Bvh8<L>, stack: &mut Stack) {
        let Self { hot, turned, octants, counts, lists, .. } = self;
        for (o, ids) in octants.iter().enumerate() {
            lists.walk::<L, false>(tree, octant(o), &ids[..counts[o]], &mut **hot, |child, ids, hot| {
                for &id in ids {
                    let id = usize::from(id);
                    let t_max = hot[id].t_max;
                    if t_max == f32::NEG_INFINITY {
                        continue;
                    }
                    let ray = One::from(&hot[id], &turned[id]);
                    let blocked = if child.is_leaf() {
                        tree.leaves[child.index()].occluded_one(&ray, t_max)
                    } else {
                        traverse_single::occluded(tree, child, &ray, t_max, stack)
                    };
                    if blocked {
                        hot[id].t_max = f32::NEG_INFINITY;
                    }
                }
            });
        }
    }

    /// Writes what was found, and is empty again.
    #[inline(always)]
    pub fn finish(&mut self, hits: &mut [Hit8]) {
        for (owner, found) in self.owner.iter().zip(&*self.best).take(self.count) {
            if found.is_hit() {
                hits[usize::from(owner >> 3)].set_lane(usize::from(owner & 7), &found.hit());
            }
        }
        self.clear();
    }

    /// Marks the rays that were blocked, a byte a packet, and is empty again.
    #[inline(always)]
    pub fn finish_blocked(&mut self, blocked: &mut [u8]) {
        for (owner, hot) in self.owner.iter().zip(&*self.hot).take(self.count) {
            blocked[usize::from(owner >> 3)] |= u8::from(hot.t_max == f32::NEG_INFINITY) << (owner & 7);
        }
        self.clear();
    }

    fn clear(&mut self) {
        self.count = 0;
        self.counts = [0; 8];
    }
}

/// For each axis, 1 where rays of octant `o` run backwards along it.
fn octant(o: usize) -> [usize; 3] {
    [o & 1, o >> 1 & 1, o >> 2 & 1]
}

impl Lists {
    /// Calls `visit` with leaves, and with what few rays reach, and the rays that do; roughly near ones first where the
    /// `NEAREST` hit is wanted.
    #[inline(always)]
    fn walk<L: Leaf, const NEAREST: bool>(
        &mut self,
        tree: &Bvh8<L>,
        octant: [usize; 3],
        rays: &[u16],
        hot: &mut [Hot],
        mut visit: impl FnMut(Child, &[u16], &mut [Hot]),
    ) {
        if rays.is_empty() || tree.root == Child::NONE {
            return;
        }
        if self.ids.len() < rays.len() {
            self.ids.resize(rays.len(), 0);
        }
        self.ids[..rays.len()].copy_from_slice(rays);
        self.stack.clear();
        self.stack.push(Visit { child: tree.root, first: 0, count: rays.len() });
        while let Some(Visit { child, first, count }) = self.stack.pop() {
            let end = first + count;
            if let Some(next) = self.stack.last() {
                fetch(tree, next.child);
            }
            if child.is_leaf() || count <= FEW {
                visit(child, &self.ids[first..end], hot);
                continue;
            }
            // Eight children may each get all rays, and blocks of eight are written whole.
            let room = end + 8 * count + 8;
            if self.ids.len() < room {
                self.ids.resize(room, 0);
            }
            let node = &tree.nodes[child.index()];
            let met = self.meet(node, octant, first, count, hot);
            let mut start = end;
            let mut push = |c: usize| {
                let stop = gather(&mut self.ids, &self.masks, first, count, c, start);
                self.stack.push(Visit { child: node.children[c], first: start, count: stop - start });
                start = stop;
            };
            if NEAREST && met.count_ones() > 1 {
                far_to_near(node, octant, met, push);
            } else {
                each(met, &mut push);
            }
        }
    }

    /// Fills [`Lists::masks`]; the children that some ray meets.
    #[inline(always)]
    fn meet(&mut self, node: &Node8, octant: [usize; 3], first: usize, count: usize, hot: &[Hot]) -> u8 {
        let near = |axis: usize| node.planes[axis][octant[axis] & 1];
        let far = |axis: usize| node.planes[axis][(octant[axis] & 1) ^ 1];
        let near = Vec3x8::new(near(0), near(1), near(2));
        let far = Vec3x8::new(far(0), far(1), far(2));
        let mut any = 0;
        self.masks.clear();
        for ids in self.ids[first..first + count].chunks(8) {
            let mut masks = 0;
            for (k, &id) in ids.iter().enumerate() {
                let met = hot[usize::from(id)].meet(near, far);
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

/// Calls `f` with the children of a node in `met`, those first whose centres rays of the octant pass last.
///
/// Each child's place in the order is how many others come before it, which eight comparisons tell without a branch.
#[inline(always)]
fn far_to_near(node: &Node8, octant: [usize; 3], met: u8, mut f: impl FnMut(usize)) {
    let along = |planes: &Planes, axis: usize| {
        let twice_centre = planes[axis][0] + planes[axis][1];
        if octant[axis] == 0 { twice_centre } else { -twice_centre }
    };
    let far = along(&node.planes, 0) + along(&node.planes, 1) + along(&node.planes, 2);
    // A NaN (of absent children, or of boxes beyond all measure) would break the order.
    let far = far.eq(far).select(far, F32x8::ZERO);
    let mut order = [0_u8; 8];
    each(met, |c| {
        let at = F32x8::from(far.lane(c));
        // Among equals the lower number comes first, so that no two share a place.
        let earlier = far.gt(at).bits() | (far.eq(at).bits() & ((1_u16 << c) - 1) as u8);
        order[(earlier & met).count_ones() as usize & 7] = c as u8;
    });
    for &c in &order[..met.count_ones() as usize] {
        f(usize::from(c));
    }
}
