//! One ray at a time, against eight boxes and eight primitives at once.

use super::bvh8::{Bvh8, Child};
use super::leaf::{Best, Best8, Leaf};
use super::one::{Cold8, Hot8, One};
use super::rays::{Way8, each};
use super::stack::{Entry, Stack, nearest_last};
use crate::math::Real;
use crate::simd::F32x8;

/// The nearest hits of the rays in `lanes`, each taken into its lane of `best`.
#[inline(never)]
pub(super) fn closest_each<L: Leaf>(tree: &Bvh8<L>, rays: &Way8, lanes: u8, best: &mut Best8, stack: &mut Stack) {
    let (hot, cold) = (Hot8::new(rays), Cold8::new(rays, 0, lanes));
    each(lanes, |i| {
        let mut one = best.lane(i);
        closest(tree, &One::new(&hot, &cold, i, rays.octant(i)), &mut one, stack);
        best.set_lane(i, &one);
    });
}

/// The nearest hit of a ray, taken into `best`.
#[inline(always)]
fn closest<L: Leaf>(tree: &Bvh8<L>, ray: &One, best: &mut Best, stack: &mut Stack) {
    walk::<L, true>(tree, ray, best.t, stack, |leaf, t| {
        if let Some(met) = leaf.meet_one(ray, *t) {
            best.take(&met, leaf.tags());
            *t = best.t;
        }
        false
    });
}

/// Which rays of `lanes` meet anything.
#[inline(never)]
pub(super) fn occluded_each<L: Leaf>(tree: &Bvh8<L>, rays: &Way8, lanes: u8, stack: &mut Stack) -> u8 {
    let (hot, cold) = (Hot8::new(rays), Cold8::new(rays, 0, lanes));
    let mut blocked = 0;
    each(lanes, |i| {
        let met = occluded(tree, &One::new(&hot, &cold, i, rays.octant(i)), hot.t_max.lane(i), stack);
        blocked |= u8::from(met) << i;
    });
    blocked
}

/// Whether a ray meets anything at or before `t_max`.
#[inline(always)]
fn occluded<L: Leaf>(tree: &Bvh8<L>, ray: &One, t_max: f32, stack: &mut Stack) -> bool {
    walk::<L, false>(tree, ray, t_max, stack, |leaf, t| leaf.meet_one(ray, *t).is_some())
}

/// Visits leaves until `visit` says that it is enough; it may lower the limit. Whether it did. Near ones come first
/// where the `NEAREST` hit is wanted, else those that are likeliest to block the ray.
#[inline(always)]
fn walk<L: Leaf, const NEAREST: bool>(
    tree: &Bvh8<L>,
    ray: &One,
    mut t_max: f32,
    stack: &mut Stack,
    mut visit: impl FnMut(&L, &mut f32) -> bool,
) -> bool {
    let mut top = 0;
    let mut here = tree.root;
    if here == Child::NONE {
        return false;
    }
    let mut limit = F32x8::from(t_max);
    let (slab, t_min) = (ray.slab(), ray.t_min());
    loop {
        let mut dead_end = false;
        while !here.is_leaf() {
            let node = &tree.nodes[here.index()];
            let (near, far) = node.sorted(ray.octant);
            let (enter, leave) = slab.clip_sorted(near, far, t_min, limit);
            let mut left = enter.le(leave).bits();
            if left == 0 {
                dead_end = true;
                break;
            }
            let first = next(&mut left);
            here = node.children[first];
            if left == 0 {
                continue;
            }
            if !NEAREST {
                while left != 0 {
                    stack[top] = Entry { enter: f32::NEG_INFINITY, child: here, lanes: 0 };
                    top += 1;
                    here = node.children[next(&mut left)];
                }
                continue;
            }
            let enter = enter.as_array();
            let second = next(&mut left);
            let mut a = Entry { enter: enter[first], child: here, lanes: 0 };
            let mut b = Entry { enter: enter[second], child: node.children[second], lanes: 0 };
            if left == 0 {
                if b.enter < a.enter {
                    std::mem::swap(&mut a, &mut b);
                }
                stack[top] = b;
                top += 1;
                here = a.child;
                continue;
            }
            let base = top;
            stack[top] = a;
            stack[top + 1] = b;
            top += 2;
            while left != 0 {
                let i = next(&mut left);
                stack[top] = Entry { enter: enter[i], child: node.children[i], lanes: 0 };
                top += 1;
            }
            nearest_last(&mut stack[base..top]);
            top -= 1;
            here = stack[top].child;
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
                here = stack[top].child;
                break;
            }
        }
    }
}

/// Takes the lowest set bit out.
#[inline(always)]
fn next(bits: &mut u8) -> usize {
    let i = bits.trailing_zeros() as usize & 7;
    *bits &= *bits - 1;
    i
}
