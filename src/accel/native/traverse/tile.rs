//! The packet kernel: up to eight ray groups of one octant traverse the tree together, each as one frustum. Single rays are
//! tested in the leaves only.

use super::super::node::bvh8::{Bvh8, NodeRef};
use super::super::node::closest_hit::ClosestHit8;
use super::super::node::leaf::{Leaf, LeafQuery};
use super::super::ray::packet8::{LeafPacket8, Packet8};
use super::frustum::Frustum;
use super::stack::{Entry, Stack, sort_nearest_last};
use crate::geometry::Octant;
use crate::math::Real;
use crate::simd::{F32x8, Mask8, set_lanes, transpose_bits};

/// The number of packets in a tile, and the maximum number of groups in one traversal.
pub(super) const TILE: usize = 8;

/// The number of leaves that a frustum may visit before its rays are tested one by one in the boxes it hits. Where
/// triangles are smaller than the gaps between its rays, most boxes that the frustum hits are hit by none of them.
const PATIENCE: u32 = 4;

/// Rays of one packet that share an octant, and the frustum around them.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayGroup {
    /// Index of the packet in the tile.
    pub packet: usize,
    /// Lanes of the rays. Occluded rays are removed.
    pub lanes: u8,
    /// Lanes of the occluded rays.
    pub blocked: u8,
    /// True if the rays are tested one by one in the boxes that the frustum hits.
    wide: bool,
    /// Common octant of the rays.
    pub octant: Octant,
    frustum: Frustum,
}

impl RayGroup {
    /// A group of the rays in `lanes` of packet number `index` of the tile. They share an octant and have `t_min >= 0`.
    #[inline(always)]
    pub fn new(packet: &Packet8, index: usize, lanes: u8, wide: bool) -> Self {
        let octant = packet.octant(lanes.trailing_zeros() as usize & 7);
        Self { packet: index, lanes, blocked: 0, wide, octant, frustum: Frustum::new(packet, lanes, octant) }
    }

    /// Returns false if the frustum misses every child of the tree's root.
    #[inline(always)]
    pub fn reaches<L>(&self, tree: &Bvh8<L>) -> bool {
        self.frustum.reaches(tree, self.octant, 1)
    }

    /// Ends the frustum at the greatest `t_max` of the group's rays.
    #[inline(always)]
    fn set_t_max(&mut self, t_max: F32x8) {
        let mask = Mask8::from_bits(self.lanes);
        self.frustum.set_t_max(mask.select(t_max, F32x8::from(f32::NEG_INFINITY)).reduce_max());
    }
}

/// Finds the closest hits of at most eight groups of one octant. `rays` and `closest` are indexed by packet. Closer hits
/// replace those in `closest`.
#[inline(never)]
pub(super) fn closest<L: Leaf>(
    tree: &Bvh8<L>,
    groups: &mut [RayGroup],
    rays: &[LeafPacket8],
    closest: &mut [ClosestHit8],
    stack: &mut Stack,
) {
    traverse::<L, true>(tree, groups, rays, closest, stack);
}

/// Moves the rays with any hit from [`RayGroup::lanes`] to [`RayGroup::blocked`]. The groups are at most eight, of one
/// octant. `rays` and `closest`, which holds the limits of the rays, are indexed by packet.
#[inline(never)]
pub(super) fn occluded<L: Leaf>(
    tree: &Bvh8<L>,
    groups: &mut [RayGroup],
    rays: &[LeafPacket8],
    closest: &mut [ClosestHit8],
    stack: &mut Stack,
) {
    traverse::<L, false>(tree, groups, rays, closest, stack);
}

/// Visits the leaves that the groups' frustums hit. With `CLOSEST` near children come first. Else likely blockers come
/// first (the order of the slots), until all rays are occluded.
#[inline(always)]
fn traverse<L: Leaf, const CLOSEST: bool>(
    tree: &Bvh8<L>,
    groups: &mut [RayGroup],
    rays: &[LeafPacket8],
    closest: &mut [ClosestHit8],
    stack: &mut Stack,
) {
    if tree.root == NodeRef::NONE {
        return;
    }
    let mut live = 0;
    for (i, group) in groups.iter_mut().enumerate() {
        group.set_t_max(closest[group.packet].t);
        live |= u8::from(group.lanes != 0) << i;
    }
    if live == 0 {
        return;
    }
    let octant = groups[0].octant;
    let mut farthest = farthest_of(groups);
    stack[0] = Entry { enter: f32::NEG_INFINITY, node: tree.root, groups: live };
    let mut top = 1;
    let mut patience = PATIENCE * live.count_ones();
    while top > 0 {
        top -= 1;
        let Entry { enter, node: here, groups: hit } = stack[top];
        let hit = hit & live;
        if hit == 0 || (CLOSEST && enter > farthest) {
            continue;
        }
        if top > 0 {
            tree.prefetch(stack[top - 1].node);
        }
        if here.is_leaf() {
            let leaf = &tree.leaves[here.index()];
            let boxes = leaf.boxes();
            patience = patience.saturating_sub(hit.count_ones());
            if patience == 0 {
                groups.iter_mut().for_each(|group| group.wide = true);
            }
            set_lanes(hit).for_each(|g| {
                let group = &mut groups[g];
                let (slots, _) = group.frustum.boxes_hit(&boxes, octant);
                if slots == 0 {
                    return;
                }
                let (rays, closest) = (&rays[group.packet], &mut closest[group.packet]);
                let query = LeafQuery { lanes: group.lanes, octant, boxes: &boxes };
                if CLOSEST {
                    leaf.closest_packet(rays, &query, slots, closest);
                    group.set_t_max(closest.t);
                } else {
                    let blocked = leaf.occluded_packet(rays, &query, slots, closest.t);
                    if blocked != 0 {
                        group.lanes &= !blocked;
                        group.blocked |= blocked;
                        group.set_t_max(closest.t);
                        live &= !(u8::from(group.lanes == 0) << g);
                    }
                }
            });
            if live == 0 {
                return;
            }
            if CLOSEST {
                farthest = farthest_of(groups);
            }
            continue;
        }
        let node = &tree.nodes[here.index()];
        let mut masks = 0_u64;
        let mut enter = F32x8::INFINITY;
        let mut any = 0;
        set_lanes(hit).for_each(|g| {
            let group = &groups[g];
            let (mut boxes, at) = group.frustum.boxes_hit(&node.boxes, octant);
            if group.wide {
                let t_max = closest[group.packet].t;
                boxes = rays[group.packet].packet.boxes_hit(group.lanes, t_max, octant, &node.boxes, boxes);
            }
            masks |= u64::from(boxes) << (8 * g);
            any |= boxes;
            if CLOSEST {
                enter = at.min_or(enter);
            }
        });
        if any == 0 {
            continue;
        }
        let by_child = transpose_bits(masks);
        let base = top;
        set_lanes(any).for_each(|c| {
            let enter = if CLOSEST { enter.lane(c) } else { 0.0 };
            stack[top] = Entry { enter, node: node.children[c], groups: (by_child >> (8 * c)) as u8 };
            top += 1;
        });
        if CLOSEST && top - base > 1 {
            sort_nearest_last(&mut stack[base..top]);
        }
    }
}

/// The greatest `t_max` of all groups.
fn farthest_of(groups: &[RayGroup]) -> f32 {
    groups.iter().fold(f32::NEG_INFINITY, |far, g| far.max_or(g.frustum.t_max()))
}
