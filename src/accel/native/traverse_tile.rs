//! Up to eight packets of one octant together: each goes down the tree as one beam, and its rays part at the leaves.

use super::beam::{Beam, greatest};
use super::bits::transpose;
use super::bvh8::{Bvh8, Child};
use super::leaf::{Best8, Leaf};
use super::rays::{Eight, each};
use super::stack::{Entry, Stack, nearest_last};
use crate::math::Real;
use crate::simd::{F32x8, Mask8};

/// Packets of a tile.
pub(super) const TILE: usize = 8;

/// Rays of one packet that share an octant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    /// Which packet of the tile.
    pub packet: usize,
    /// Which of its rays; they leave once they are blocked.
    pub lanes: u8,
    /// For each axis, 1 where they run backwards along it.
    pub octant: [usize; 3],
    beam: Beam,
}

impl Group {
    /// The rays in `lanes`, which share an octant and of which none begins below zero.
    #[inline(always)]
    pub fn new(rays: &Eight, packet: usize, lanes: u8) -> Self {
        let octant = rays.octant(lanes.trailing_zeros() as usize & 7);
        Self { packet, lanes, octant, beam: Beam::new(rays, lanes, octant) }
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
    for group in groups.iter_mut() {
        group.limit(best[group.packet].t);
    }
    let live = all(groups.len());
    walk::<L, true>(tree, groups, live, stack, |leaf, group| {
        let (slots, _) = group.beam.meet(&leaf.1, group.octant);
        if slots != 0 {
            let best = &mut best[group.packet];
            leaf.0.closest_eight(&rays[group.packet], group.lanes, slots, best);
            group.limit(best.t);
        }
        true
    });
}

/// Takes the rays that meet anything out of at most eight groups that share an octant.
#[inline(never)]
pub(super) fn occluded<L: Leaf>(tree: &Bvh8<L>, groups: &mut [Group], rays: &[Eight], stack: &mut Stack) {
    let mut live = 0;
    for (i, group) in groups.iter_mut().enumerate() {
        group.limit(rays[group.packet].t_max);
        live |= u8::from(group.lanes != 0) << i;
    }
    walk::<L, false>(tree, groups, live, stack, |leaf, group| {
        let (slots, _) = group.beam.meet(&leaf.1, group.octant);
        if slots != 0 {
            let rays = &rays[group.packet];
            let blocked = leaf.0.occluded_eight(rays, group.lanes, slots, rays.t_max);
            if blocked != 0 {
                group.lanes &= !blocked;
                group.limit(rays.t_max);
            }
        }
        group.lanes != 0
    });
}

/// The lowest `n` bits.
#[inline(always)]
fn all(n: usize) -> u8 {
    ((1_u32 << n) - 1) as u8
}

/// Visits leaves with each group whose beam meets their boxes, near ones first where `SORTED`, until `visit` has said
/// of every group that it is done.
#[inline(always)]
fn walk<L: Leaf, const SORTED: bool>(
    tree: &Bvh8<L>,
    groups: &mut [Group],
    mut live: u8,
    stack: &mut Stack,
    mut visit: impl FnMut((&L, super::bvh8::Planes), &mut Group) -> bool,
) {
    if tree.root == Child::NONE || live == 0 {
        return;
    }
    let octant = groups[0].octant;
    let mut farthest = farthest_of(groups);
    stack[0] = Entry { enter: f32::NEG_INFINITY, child: tree.root, lanes: live };
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let Entry { enter, child, lanes } = stack[top];
        let met = lanes & live;
        if met == 0 || (SORTED && enter > farthest) {
            continue;
        }
        if child.is_leaf() {
            let leaf = &tree.leaves[child.index()];
            let boxes = leaf.boxes();
            each(met, |g| {
                if !visit((leaf, boxes), &mut groups[g]) {
                    live &= !(1 << g);
                }
            });
            if live == 0 {
                return;
            }
            if SORTED {
                farthest = farthest_of(groups);
            }
            continue;
        }
        let node = &tree.nodes[child.index()];
        let mut masks = 0_u64;
        let mut enter = F32x8::INFINITY;
        let mut boxes = 0;
        each(met, |g| {
            let (meets, at) = groups[g].beam.meet(&node.planes, octant);
            masks |= u64::from(meets) << (8 * g);
            boxes |= meets;
            if SORTED {
                enter = at.min_or(enter);
            }
        });
        if boxes == 0 {
            continue;
        }
        let by_child = transpose(masks);
        let base = top;
        each(boxes, |c| {
            let enter = if SORTED { enter.lane(c) } else { 0.0 };
            stack[top] = Entry { enter, child: node.children[c], lanes: (by_child >> (8 * c)) as u8 };
            top += 1;
        });
        if SORTED && top - base > 1 {
            nearest_last(&mut stack[base..top]);
        }
    }
}

fn farthest_of(groups: &[Group]) -> f32 {
    groups.iter().fold(f32::NEG_INFINITY, |far, g| far.max_or(g.beam.t_max()))
}
