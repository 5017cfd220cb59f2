//! Eight rays of one octant together, against one box and one triangle at a time.

use super::bvh8::{Bvh8, Child, Node8, leave_of};
use super::leaf::{Best8, Leaf};
use super::rays::Eight;
use super::stack::{Entry, Scratch, Stack, nearest_last};
use super::traverse_single;
use crate::math::Real;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// A subtree that no more rays than this meet is walked by each of them alone.
const ALONE: u32 = 3;

/// The nearest hits of the rays in `lanes`, which share an octant, taken into `best`.
#[inline(never)]
pub(super) fn closest<L: Leaf>(tree: &Bvh8<L>, rays: &Eight, lanes: u8, best: &mut Best8, scratch: &mut Scratch) {
    let t_max = only(lanes, best.t);
    let Scratch { single, packet } = scratch;
    walk(tree, rays, lanes, t_max, packet, |below, met, t| {
        if below.is_leaf() {
            tree.leaves[below.index()].closest_eight(rays, met, best);
        } else {
            traverse_single::closest_each(tree, below, rays, met, best, single);
        }
        *t = only(lanes, best.t);
        false
    });
}

/// Which rays of `lanes`, which share an octant, meet anything at or before their `t_max`.
#[inline(never)]
pub(super) fn occluded<L: Leaf>(tree: &Bvh8<L>, rays: &Eight, lanes: u8, scratch: &mut Scratch) -> u8 {
    let mut blocked = 0;
    let Scratch { single, packet } = scratch;
    walk(tree, rays, lanes, only(lanes, rays.t_max), packet, |below, met, t| {
        let met = met & !blocked;
        if below.is_leaf() {
            blocked |= tree.leaves[below.index()].occluded_eight(rays, met, *t);
        } else {
            blocked |= traverse_single::occluded_each(tree, below, rays, met, single);
        }
        *t = only(lanes & !blocked, *t);
        blocked == lanes
    });
    blocked
}

/// `t` in `lanes`, and -inf, where nothing is met, in the others.
#[inline(always)]
fn only(lanes: u8, t: F32x8) -> F32x8 {
    Mask8::from_bits(lanes).select(t, F32x8::from(f32::NEG_INFINITY))
}

/// The space that all rays of a packet lie in, as intervals; it tells at once which of eight boxes none of them meets.
struct Frustum {
    /// By axis, the starts that reach near planes first, and those that reach far planes last.
    origin: [[F32x8; 2]; 3],
    /// By axis, least and greatest inverse direction.
    inverse: [[F32x8; 2]; 3],
    octant: [usize; 3],
    t_min: F32x8,
    /// A slope is infinite, and intervals cannot tell `0 * inf` from a bound: every box is taken for met.
    blind: bool,
}

impl Frustum {
    #[inline(always)]
    fn new(rays: &Eight, lanes: u8) -> Self {
        let mask = Mask8::from_bits(lanes);
        let least = |x: F32x8| -greatest(mask.select(-x, F32x8::from(f32::NEG_INFINITY)));
        let most = |x: F32x8| greatest(mask.select(x, F32x8::from(f32::NEG_INFINITY)));
        let octant = rays.octant(lanes.trailing_zeros() as usize & 7);
        let origin = rays.slab.origin;
        let inverse = rays.slab.inverse;
        let ends = |x: F32x8, backwards: usize| {
            let ends = [F32x8::from(most(x)), F32x8::from(least(x))];
            if backwards == 0 { ends } else { [ends[1], ends[0]] }
        };
        let range = |x: F32x8| [F32x8::from(least(x)), F32x8::from(most(x))];
        Self {
            origin: [ends(origin.x, octant[0]), ends(origin.y, octant[1]), ends(origin.z, octant[2])],
            inverse: [range(inverse.x), range(inverse.y), range(inverse.z)],
            octant,
            t_min: F32x8::from(least(rays.t_min)),
            blind: [inverse.x, inverse.y, inverse.z].iter().any(|r| r.is_finite().bits() & lanes != lanes),
        }
    }

    /// The boxes that some ray may meet, and a bound below where it enters them. Each step rounds a number that
    /// bounds the one of every ray, so the bounds hold as computed.
    #[inline(always)]
    fn meet(&self, node: &Node8, t_max: F32x8) -> (u8, F32x8) {
        if self.blind {
            return (u8::MAX, self.t_min);
        }
        let near = |axis: usize| {
            let distance = node.planes[axis][self.octant[axis] & 1] - self.origin[axis][0];
            let (a, b) = (distance * self.inverse[axis][0], distance * self.inverse[axis][1]);
            a.min_or(b)
        };
        let far = |axis: usize| {
            let distance = node.planes[axis][(self.octant[axis] & 1) ^ 1] - self.origin[axis][1];
            (distance * self.inverse[axis][0]).max_or(distance * self.inverse[axis][1])
        };
        let enter = near(0).max_or(near(1).max_or(near(2).max_or(self.t_min)));
        let leave = leave_of(Vec3x8::new(far(0), far(1), far(2)), t_max);
        (enter.le(leave).bits(), enter)
    }
}

/// The rays that meet the box of child `i`, and where each enters it.
#[inline(always)]
fn meet_eight(node: &Node8, i: usize, octant: [usize; 3], rays: &Eight, t_max: F32x8) -> (Mask8, F32x8) {
    let near = |axis: usize| F32x8::from(node.planes[axis][octant[axis] & 1].lane(i));
    let far = |axis: usize| F32x8::from(node.planes[axis][(octant[axis] & 1) ^ 1].lane(i));
    let near = Vec3x8::new(near(0), near(1), near(2));
    let far = Vec3x8::new(far(0), far(1), far(2));
    let (enter, leave) = rays.slab.clip_sorted(near, far, rays.t_min, t_max);
    (enter.le(leave), enter)
}

/// Visits leaves, and subtrees that few rays meet, roughly near ones first, with the rays that meet their box, until
/// `visit` says that it is enough; it may lower the limits.
#[inline(always)]
fn walk<L: Leaf>(
    tree: &Bvh8<L>,
    rays: &Eight,
    lanes: u8,
    mut t_max: F32x8,
    stack: &mut Stack,
    mut visit: impl FnMut(Child, u8, &mut F32x8) -> bool,
) {
    if tree.root == Child::NONE || lanes == 0 {
        return;
    }
    let frustum = Frustum::new(rays, lanes);
    let mut farthest = greatest(t_max);
    stack[0] = Entry { enter: f32::NEG_INFINITY, child: tree.root, lanes };
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let Entry { enter, child, lanes } = stack[top];
        if enter > farthest {
            continue;
        }
        if child.is_leaf() || lanes.count_ones() <= ALONE {
            if visit(child, lanes, &mut t_max) {
                return;
            }
            farthest = greatest(t_max);
            continue;
        }
        let node = &tree.nodes[child.index()];
        let (mut boxes, enter) = frustum.meet(node, F32x8::from(farthest));
        let base = top;
        while boxes != 0 {
            let i = boxes.trailing_zeros() as usize & 7;
            boxes &= boxes - 1;
            let (met, _) = meet_eight(node, i, frustum.octant, rays, t_max);
            let lanes = met.bits();
            if lanes != 0 {
                stack[top] = Entry { enter: enter.lane(i), child: node.children[i], lanes };
                top += 1;
            }
        }
        nearest_last(&mut stack[base..top]);
    }
}

/// The largest of eight numbers.
#[inline(always)]
fn greatest(x: F32x8) -> f32 {
    let [a, b, c, d, e, f, g, h] = x.to_array();
    let (a, b, c, d) = (a.max_or(e), b.max_or(f), c.max_or(g), d.max_or(h));
    a.max_or(c).max_or(b.max_or(d))
}
