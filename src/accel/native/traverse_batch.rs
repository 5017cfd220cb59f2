//! Many scattered rays together, node by node: each node of the tree is read once for all rays that reach it.
//!
//! After Tsakok 2009 ("Faster Incoherent Rays: Multi-BVH Ray Stream Tracing") and Fuetterling et al. 2015 ("Efficient
//! Ray Tracing Kernels for Modern CPU Architectures"): rays are parted by octant, so that near and far planes of a
//! node stay in registers while its list of rays goes by, each with the 32 bytes that the box test needs. A list that
//! has become short is finished ray by ray.

use arrayvec::ArrayVec;

use super::bits::{compress, transpose};
use super::bvh8::{Bvh8, Child, Node8, Planes};
use super::leaf::{Best, Best8, Leaf};
use super::rays::{Eight, Hot, One, Turned, each};
use super::stack::Stack;
use super::traverse_single;
use crate::simd::Vec3x8;

/// A list of no more rays than this is finished ray by ray.
const FEW: usize = 4;

/// Rays that wait to be traced together, and room for the work.
#[derive(Debug, Default)]
pub(super) struct Batch {
    hot: Vec<Hot>,
    turned: Vec<Turned>,
    best: Vec<Best>,
    /// Whose rays they are: packet times eight, and lane.
    owner: Vec<u16>,
    /// By octant, those that go there.
    octants: [Vec<u16>; 8],
    lists: Lists,
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
    pub fn push(&mut self, rays: &Eight, packet: usize, lanes: u8) {
        if lanes == 0 {
            return;
        }
        let (hot, turned) = rays.split();
        each(lanes, |i| {
            let id = self.hot.len() as u16;
            self.hot.push(hot[i]);
            self.turned.push(turned[i]);
            self.best.push(Best::new(hot[i].t_max));
            self.owner.push((packet * 8 + i) as u16);
            let [x, y, z] = rays.octant(i);
            self.octants[x | y << 1 | z << 2].push(id);
        });
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.hot.is_empty()
    }

    /// Takes the nearest hits into what is known of the rays.
    #[inline(never)]
    pub fn closest<L: Leaf>(&mut self, tree: &Bvh8<L>, stack: &mut Stack) {
        let Self { hot, turned, best, octants, lists, .. } = self;
        for (o, ids) in octants.iter().enumerate() {
            lists.walk(tree, octant(o), ids, hot, |child, ids, hot| {
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
        let Self { hot, turned, octants, lists, .. } = self;
        for (o, ids) in octants.iter().enumerate() {
            lists.walk(tree, octant(o), ids, hot, |child, ids, hot| {
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

    /// Gives back what was found, and is empty again.
    #[inline(always)]
    pub fn finish(&mut self, best: &mut [Best8]) {
        for (owner, found) in self.owner.iter().zip(&self.best) {
            best[usize::from(owner >> 3)].set_lane(usize::from(owner & 7), found);
        }
        self.clear();
    }

    /// Marks the rays that were blocked, a byte a packet, and is empty again.
    #[inline(always)]
    pub fn finish_blocked(&mut self, blocked: &mut [u8]) {
        for (owner, hot) in self.owner.iter().zip(&self.hot) {
            blocked[usize::from(owner >> 3)] |= u8::from(hot.t_max == f32::NEG_INFINITY) << (owner & 7);
        }
        self.clear();
    }

    fn clear(&mut self) {
        self.hot.clear();
        self.turned.clear();
        self.best.clear();
        self.owner.clear();
        self.octants.iter_mut().for_each(Vec::clear);
    }
}

/// For each axis, 1 where rays of octant `o` run backwards along it.
fn octant(o: usize) -> [usize; 3] {
    [o & 1, o >> 1 & 1, o >> 2 & 1]
}

impl Lists {
    /// Calls `visit` with leaves, and with what few rays reach, roughly near ones first, and the rays that do.
    #[inline(always)]
    fn walk<L: Leaf>(
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
            for c in far_to_near(node, octant, met) {
                let stop = self.gather(first, count, c, start);
                self.stack.push(Visit { child: node.children[c], first: start, count: stop - start });
                start = stop;
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

    /// Writes the rays of a list that meet child `c` from `to` on; where they end.
    #[inline(always)]
    fn gather(&mut self, first: usize, count: usize, c: usize, mut to: usize) -> usize {
        for (block, masks) in self.masks[..count.div_ceil(8)].iter().enumerate() {
            let mask = (masks >> (8 * c)) as u8;
            let from = first + 8 * block;
            let Some(&ids) = self.ids[from..].first_chunk() else { break };
            self.ids[to..to + 8].copy_from_slice(&compress(ids, mask));
            to += mask.count_ones() as usize;
        }
        to
    }
}

/// The children of a node in `met`, those first whose centres rays of the octant pass last.
#[inline(always)]
fn far_to_near(node: &Node8, octant: [usize; 3], met: u8) -> ArrayVec<usize, 8> {
    let along = |planes: &Planes, axis: usize| {
        let twice_centre = planes[axis][0] + planes[axis][1];
        if octant[axis] == 0 { twice_centre } else { -twice_centre }
    };
    let place = along(&node.planes, 0) + along(&node.planes, 1) + along(&node.planes, 2);
    let place = place.as_array();
    let mut order = ArrayVec::new();
    each(met, |c| {
        let mut k = order.len();
        order.push(c);
        while k > 0 && place[order[k - 1]] < place[c] {
            order[k] = order[k - 1];
            k -= 1;
        }
        order[k] = c;
    });
    order
}
