//! The single-ray kernel: one ray at a time, against eight boxes and eight primitives at once.

use super::super::node::bvh8::{Bvh8, NodeRef};
use super::super::node::closest_hit::ClosestHit8;
use super::super::node::leaf::Leaf;
use super::super::ray::lane_ray::{BoxRays8, LaneRay, LeafRays8};
use super::super::ray::packet8::Packet8;
use super::stack::{Entry, Stack, sort_nearest_last};
use crate::math::Real;
use crate::simd::{F32x8, set_lanes};

/// Finds the closest hits of the rays in `lanes`. Closer hits replace those in `closest`.
#[inline(never)]
pub(super) fn closest<L: Leaf>(
    tree: &Bvh8<L>,
    rays: &Packet8,
    lanes: u8,
    closest: &mut ClosestHit8,
    stack: &mut Stack,
) {
    let (boxes, leaves) = (BoxRays8::new(rays), LeafRays8::new(rays, 0, lanes));
    set_lanes(lanes).for_each(|i| {
        let ray = LaneRay::new(&boxes, &leaves, i, rays.octant(i));
        let mut hit = closest.lane(i);
        traverse::<L, true>(tree, &ray, hit.t, stack, |leaf, t_max| {
            if let Some(hits) = leaf.intersect_ray(&ray, *t_max) {
                hit.update(&hits, leaf.tags());
                *t_max = hit.t;
            }
            false
        });
        closest.set_lane(i, &hit);
    });
}

/// Returns the lanes of `lanes` whose ray has any hit.
#[inline(never)]
pub(super) fn occluded<L: Leaf>(tree: &Bvh8<L>, rays: &Packet8, lanes: u8, stack: &mut Stack) -> u8 {
    let (boxes, leaves) = (BoxRays8::new(rays), LeafRays8::new(rays, 0, lanes));
    let mut blocked = 0;
    set_lanes(lanes).for_each(|i| {
        let ray = LaneRay::new(&boxes, &leaves, i, rays.octant(i));
        let hit = traverse::<L, false>(tree, &ray, boxes.t_max.lane(i), stack, |leaf, t_max| {
            leaf.intersect_ray(&ray, *t_max).is_some()
        });
        blocked |= u8::from(hit) << i;
    });
    blocked
}

/// Visits the leaves whose boxes the ray hits before `t_max`. `visit` may lower `t_max`, and returns true to stop. Returns
/// true if `visit` did.
///
/// With `CLOSEST` near children come first, else likely blockers (the order of the slots).
#[inline(always)]
fn traverse<L: Leaf, const CLOSEST: bool>(
    tree: &Bvh8<L>,
    ray: &LaneRay,
    mut t_max: f32,
    stack: &mut Stack,
    mut visit: impl FnMut(&L, &mut f32) -> bool,
) -> bool {
    let mut top = 0;
    let mut here = tree.root;
    if here == NodeRef::NONE {
        return false;
    }
    let mut limit = F32x8::from(t_max);
    let (slab, t_min) = (ray.slab(), ray.t_min());
    loop {
        let mut dead_end = false;
        while !here.is_leaf() {
            let node = &tree.nodes[here.index()];
            let (near, far) = node.boxes.sorted(ray.octant);
            let (enter, leave) = slab.clip_sorted(near, far, t_min, limit);
            let mut left = enter.le(leave).bits();
            if left == 0 {
                dead_end = true;
                break;
            }
            let first = pop_lane(&mut left);
            here = node.children[first];
            if left == 0 {
                continue;
            }
            if !CLOSEST {
                while left != 0 {
                    stack[top] = Entry { enter: f32::NEG_INFINITY, node: here, groups: 0 };
                    top += 1;
                    here = node.children[pop_lane(&mut left)];
                }
                continue;
            }
            let enter = enter.as_array();
            let second = pop_lane(&mut left);
            let mut a = Entry { enter: enter[first], node: here, groups: 0 };
            let mut b = Entry { enter: enter[second], node: node.children[second], groups: 0 };
            if left == 0 {
                if b.enter < a.enter {
                    std::mem::swap(&mut a, &mut b);
                }
                stack[top] = b;
                top += 1;
                here = a.node;
                continue;
            }
            let base = top;
            stack[top] = a;
            stack[top + 1] = b;
            top += 2;
            while left != 0 {
                let i = pop_lane(&mut left);
                stack[top] = Entry { enter: enter[i], node: node.children[i], groups: 0 };
                top += 1;
            }
            sort_nearest_last(&mut stack[base..top]);
            top -= 1;
            here = stack[top].node;
        }
        if !dead_end {
            if visit(&tree.leaves[here.index()], &mut t_max) {
                return true;
            }
            limit = F32x8::from(t_max);
        }
        loop {
            if top == 0 {
                return false;
            }
            top -= 1;
            if stack[top].enter <= t_max {
                here = stack[top].node;
                break;
            }
        }
    }
}

/// Removes the lowest lane from a mask that is not empty, and returns it.
#[inline(always)]
fn pop_lane(lanes: &mut u8) -> usize {
    let i = lanes.trailing_zeros() as usize & 7;
    *lanes &= *lanes - 1;
    i
}
