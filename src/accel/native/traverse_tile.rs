//! Up to eight packets of one octant together: each goes down the tree as one beam, and its rays part at the leaves.

use super::beam::{Beam, greatest};
use super::bits::transpose;
use super::bvh8::{Bvh8, Child};
use super::leaf::{Best8, Leaf, Towards};
use super::rays::{Eight, Way8, each};
use super::stack::{Entry, Stack, nearest_last};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, prefetch};

/// Packets of a tile.
pub(super) const TILE: usize = 8;

/// Leaves that a beam may meet before it counts as wide: where triangles are smaller than the gaps between its rays, most
/// of what it meets none of them does.
const PATIENCE: u32 = 4;

/// Rays of one packet that share an octant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    /// Which packet of the tile.
    pub packet: usize,
    /// Which of its rays; they leave once they are blocked.
    pub lanes: u8,
    /// Those that have left.
    pub blocked: u8,
    /// Whether it is so wide that its rays are looked at one by one in the boxes that it meets.
    wide: bool,
    /// For each axis, 1 where they run backwards along it.
    pub octant: [usize; 3],
    beam: Beam,
}

impl Group {
    /// The rays in `lanes`, which share an octant and of which none begins below zero.
    #[inline(always)]
    pub fn new(way: &Way8, packet: usize, lanes: u8, wide: bool) -> Self {
        let octant = way.octant(lanes.trailing_zeros() as usize & 7);
        Self { packet, lanes, blocked: 0, wide, octant, beam: Beam::new(way, lanes, octant) }
    }

    /// Whether anything in a tree may be met, as its root tells.
    #[inline(always)]
    pub fn reaches<L>(&self, tree: &Bvh8<L>) -> bool {
        self.beam.reaches(tree, self.octant, 1)
    }

    #[inline(always)]
    fn limit(&mut self, t_max: F32x8) {
        let mask = Mask8::from_bits(self.lanes);
        self.beam.limit(greatest(mask.select(t_max, F32x8::from(f32::NEG_INFINITY))));
    }
}

/// The nearest hits of at most eight groups that share an octant, taken into `best`, which has a place for each packet.
#[inline(never)]
pub(super) fn closest<L: Leaf>(
    tree: &Bvh8<L>,
    groups: &mut [Group],
    rays: &[Eight],
    best: &mut [Best8],
    stack: &mut Stack,
) {
    walk::<L, true>(tree, groups, rays, best, stack);
}

/// Takes the rays that meet anything out of at most eight groups that share an octant; `best` holds their limits.
#[inline(never)]
pub(super) fn occluded<L: Leaf>(
    tree: &Bvh8<L>,
    groups: &mut [Group],
    rays: &[Eight],
    best: &mut [Best8],
    stack: &mut Stack,
) {
    walk::<L, false>(tree, groups, rays, best, stack);
}

/// Visits leaves with each group whose beam meets their boxes; near ones first where the `NEAREST` hit is wanted, else
/// likely blockers first until there is any hit for all rays.
#[inline(always)]
fn walk<L: Leaf, const NEAREST: bool>(
    tree: &Bvh8<L>,
    groups: &mut [Group],
    rays: &[Eight],
    best: &mut [Best8],
    stack: &mut Stack,
) {
    if tree.root == Child::NONE {
        return;
    }
    let mut live = 0;
    for (i, group) in groups.iter_mut().enumerate() {
        group.limit(best[group.packet].t);
        live |= u8::from(group.lanes != 0) << i;
    }
    if live == 0 {
        return;
    }
    let octant = groups[0].octant;
    let mut farthest = farthest_of(groups);
    stack[0] = Entry { enter: f32::NEG_INFINITY, child: tree.root, lanes: live };
    let mut top = 1;
    let mut patience = PATIENCE * live.count_ones();
    while top > 0 {
        top -= 1;
        let Entry { enter, child, lanes } = stack[top];
        let met = lanes & live;
        if met == 0 || (NEAREST && enter > farthest) {
            continue;
        }
        if top > 0 {
            fetch(tree, stack[top - 1].child);
        }
        if child.is_leaf() {
            let leaf = &tree.leaves[child.index()];
            let boxes = leaf.boxes();
            patience = patience.saturating_sub(met.count_ones());
            if patience == 0 {
                groups.iter_mut().for_each(|group| group.wide = true);
            }
            each(met, |g| {
                let group = &mut groups[g];
                let (slots, _) = group.beam.meet(&boxes, octant);
                if slots == 0 {
                    return;
                }
                let (rays, best) = (&rays[group.packet], &mut best[group.packet]);
                let to = Towards { lanes: group.lanes, octant, boxes: &boxes };
                if NEAREST {
                    leaf.closest_eight(rays, &to, slots, best);
                    group.limit(best.t);
                } else {
                    let blocked = leaf.occluded_eight(rays, &to, slots, best.t);
                    if blocked != 0 {
                        group.lanes &= !blocked;
                        group.blocked |= blocked;
                        group.limit(best.t);
                        live &= !(u8::from(group.lanes == 0) << g);
                    }
                }
            });
            if live == 0 {
                return;
            }
            if NEAREST {
                farthest = farthest_of(groups);
            }
            continue;
        }
        let node = &tree.nodes[child.index()];
        let mut masks = 0_u64;
        let mut enter = F32x8::INFINITY;
        let mut boxes = 0;
        each(met, |g| {
            let group = &groups[g];
            let (mut meets, at) = group.beam.meet(&node.planes, octant);
            if group.wide {
                let t_max = best[group.packet].t;
                meets = rays[group.packet].way.sift(group.lanes, t_max, octant, &node.planes, meets);
            }
            masks |= u64::from(meets) << (8 * g);
            boxes |= meets;
            if NEAREST {
                enter = at.min_or(enter);
            }
        });
        if boxes == 0 {
            continue;
        }
        let by_child = transpose(masks);
        let base = top;
        each(boxes, |c| {
            let enter = if NEAREST { enter.lane(c) } else { 0.0 };
            stack[top] = Entry { enter, child: node.children[c], lanes: (by_child >> (8 * c)) as u8 };
            top += 1;
        });
        if NEAREST && top - base > 1 {
            nearest_last(&mut stack[base..top]);
        }
    }
}

/// Asks for what will be visited after next.
#[inline(always)]
pub(super) fn fetch<L>(tree: &Bvh8<L>, child: Child) {
    if child.is_leaf() {
        prefetch(&tree.leaves[child.index()]);
    } else {
        prefetch(&tree.nodes[child.index()]);
    }
}

fn farthest_of(groups: &[Group]) -> f32 {
    groups.iter().fold(f32::NEG_INFINITY, |far, g| far.max_or(g.beam.t_max()))
}
