//! Many scattered rays together, node by node: each node of the tree is read once for all rays that reach it.
//!
//! After Tsakok 2009 ("Faster Incoherent Rays: Multi-BVH Ray Stream Tracing") and Fuetterling et al. 2015 ("Efficient
//! Ray Tracing Kernels for Modern CPU Architectures"): rays are parted by octant, so that near and far planes of a
//! node stay in registers while its list of rays goes by, each with the 32 bytes that the box test needs. The octants
//! are walked by turns: what one will visit next comes from memory while the others are at work.

use super::bits::{compress, transpose};
use super::bvh8::{Bvh8, Child, Node8};
use super::leaf::{Best, Leaf};
use super::rays::{Direction, Hot, One, Turned, Way8, each};
use super::traverse_stream::STRETCH;
use super::traverse_tile::fetch;
use crate::geometry::Hit8;

/// Rays that each octant of a batch has room for.
const ROOM: usize = 8 * STRETCH;

/// Rays that wait to be traced together, by octant, and room for the work: 400 kB an octant, made when the first ray comes,
/// since a small picture sends few rays into few octants.
#[derive(Debug, Default)]
pub(super) struct Batch {
    octants: [Option<Box<Rays>>; 8],
    lists: [Lists; 8],
}

/// Rays of one octant side by side, so that those of a list are near each other in memory, too.
#[derive(Debug)]
struct Rays {
    /// How many there are; what lies behind them was left by others.
    count: usize,
    hot: Box<[Hot; ROOM]>,
    turned: Box<[Turned; ROOM]>,
    dirs: Box<[Direction; ROOM]>,
    best: Box<[Best; ROOM]>,
    /// Whose rays they are: packet times eight, and lane.
    owner: Box<[u16; ROOM]>,
}

impl Default for Rays {
    fn default() -> Self {
        Self {
            count: 0,
            hot: bytemuck::zeroed_box(),
            turned: bytemuck::zeroed_box(),
            dirs: bytemuck::zeroed_box(),
            best: bytemuck::zeroed_box(),
            owner: bytemuck::zeroed_box(),
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
        let ((hot, turned), dirs) = (rays.split(), rays.directions());
        let octants = rays.octants();
        each(lanes, |i| {
            let to = self.octants[usize::from(octants[i] & 7)].get_or_insert_default();
            let id = to.count & (ROOM - 1);
            to.count = id + 1;
            to.hot[id] = hot[i];
            to.turned[id] = turned[i];
            to.dirs[id] = dirs[i];
            to.best[id] = Best::new(hot[i].t_max);
            to.owner[id] = (packet * 8 + i) as u16;
        });
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.octants.iter().flatten().all(|of_octant| of_octant.count == 0)
    }

    /// Takes the nearest hits into what is known of the rays.
    #[inline(never)]
    pub fn closest<L: Leaf>(&mut self, tree: &Bvh8<L>) {
        self.by_turns::<L, true>(tree, |Rays { hot, turned, dirs, best, .. }, leaf, octant, ids| {
            for &id in ids {
                let id = usize::from(id) & (ROOM - 1);
                let ray = One { hot: &hot[id], turned: &turned[id], dir: &dirs[id], octant };
                if leaf.closest_one(&ray, ray.hot.t_max, &mut best[id]) {
                    hot[id].t_max = best[id].t;
                }
            }
        });
    }

    /// Ends the rays that meet anything, which [`Batch::finish_blocked`] then names.
    #[inline(never)]
    pub fn occluded<L: Leaf>(&mut self, tree: &Bvh8<L>) {
        self.by_turns::<L, false>(tree, |Rays { hot, turned, dirs, .. }, leaf, octant, ids| {
            for &id in ids {
                let id = usize::from(id) & (ROOM - 1);
                let ray = One { hot: &hot[id], turned: &turned[id], dir: &dirs[id], octant };
                let t_max = ray.hot.t_max;
                if t_max != f32::NEG_INFINITY && leaf.occluded_one(&ray, t_max) {
                    hot[id].t_max = f32::NEG_INFINITY;
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
        if tree.root == Child::NONE {
            return;
        }
        let Self { octants, lists } = self;
        for (lists, rays) in lists.iter_mut().zip(&*octants) {
            lists.start(tree.root, rays.as_ref().map_or(0, |rays| rays.count));
        }
        let mut more = true;
        while more {
            more = false;
            for (o, (lists, rays)) in lists.iter_mut().zip(&mut *octants).enumerate() {
                let Some(rays) = rays else { continue };
                more |= lists.step::<L, NEAREST>(tree, o, rays, &mut leaf);
            }
        }
    }

    /// Writes what was found, and is empty again.
    #[inline(always)]
    pub fn finish(&mut self, hits: &mut [Hit8]) {
        for Rays { count, best, owner, .. } in self.octants.iter_mut().flatten().map(Box::as_mut) {
            for (owner, found) in owner.iter().zip(&**best).take(*count) {
                if found.is_hit() {
                    hits[usize::from(owner >> 3)].set_lane(usize::from(owner & 7), &found.hit());
                }
            }
            *count = 0;
        }
    }

    /// Marks the rays that were blocked, a byte a packet, and is empty again.
    #[inline(always)]
    pub fn finish_blocked(&mut self, blocked: &mut [u8]) {
        for Rays { count, hot, owner, .. } in self.octants.iter_mut().flatten().map(Box::as_mut) {
            for (owner, hot) in owner.iter().zip(&**hot).take(*count) {
                blocked[usize::from(owner >> 3)] |= u8::from(hot.t_max == f32::NEG_INFINITY) << (owner & 7);
            }
            *count = 0;
        }
    }
}

/// For each axis, 1 where rays of octant `o` run backwards along it.
fn octant(o: usize) -> [usize; 3] {
    [o & 1, o >> 1 & 1, o >> 2 & 1]
}

impl Lists {
    /// Begins with all rays, at `root`.
    fn start(&mut self, root: Child, count: usize) {
        self.stack.clear();
        if count == 0 {
            return;
        }
        self.ids.resize(count.max(self.ids.len()), 0);
        self.ids[..count].iter_mut().zip(0..).for_each(|(id, i)| *id = i);
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
    fn meet(&mut self, node: &Node8, octant: [usize; 3], first: usize, count: usize, hot: &[Hot; ROOM]) -> u8 {
        let (near, far) = node.sorted(octant);
        let mut any = 0;
        self.masks.clear();
        for ids in self.ids[first..first + count].chunks(8) {
            let mut masks = 0;
            for (k, &id) in ids.iter().enumerate() {
                let met = hot[usize::from(id) & (ROOM - 1)].meet(near, far);
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
