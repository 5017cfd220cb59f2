//! The interval frustum: one bound for rays of an octant, tested against eight boxes at once.

use arrayvec::ArrayVec;

use super::super::node::bvh8::{Bvh8, NodeRef};
use super::super::ray::packet8::Packet8;
use crate::geometry::slab::widened;
use crate::geometry::{Aabb8, Octant, Ray8};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, set_lanes};

/// A bound for rays that share an octant and have `t_min >= 0`: the intervals of their origins and inverse directions.
/// It hits at least every box in which one of the rays can have a hit, and enters it no later than the ray does.
/// (Overbeck, Ramamoorthi, Mark 2008; with interval arithmetic instead of planes.)
///
/// Consider a ray with a hit at `t > t_min >= 0` in a box. The far planes lie ahead of its origin. So the distance of a far
/// plane from the farthest origin, times the greatest inverse direction, is no less than the ray's own value. The
/// distance of a near plane from the nearest origin, times the least inverse direction, is no more than the ray's own
/// value, or not above zero if the plane lies behind. Each step rounds ordered numbers, and rounding keeps their order.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Frustum {
    /// Lanes 0..3: by axis, the origin that reaches near planes first. Lanes 4..7: by axis, the inverse direction of least
    /// magnitude. Lanes 3 and 7 are unused.
    near: F32x8,
    /// Lanes 0..3: by axis, the origin that reaches far planes last. Lanes 4..7: by axis, the inverse direction of greatest
    /// magnitude. Lane 7: the greatest `t_max`. Lane 3 is unused.
    far: F32x8,
}

/// The lane of [`Frustum::far`] that holds the greatest `t_max`.
const T_MAX: usize = 7;

/// In the rows of [`Packet8::rows`]: the lane of `t_min`, the lanes of origins and those of directions.
const T_MIN: usize = 3;
const DIRECTIONS: u8 = 0b0111_0000;
const ORIGINS: u8 = 0b0000_0111;

/// Directions are narrow if the squared diagonal of their box is at most this part of twice the squared distance of its
/// centre: about 13 degrees to either side.
const NARROW: f32 = 0.05;

/// The maximum number of nodes that [`Frustum::reaches`] visits.
const MOST_VISITS: usize = 12;

/// The frustum around all rays of some packets, and properties of the rays.
pub(super) struct TileFrustum {
    /// The frustum.
    pub frustum: Frustum,
    /// Common octant of the rays.
    pub octant: Octant,
    /// True if the directions differ little ([`NARROW`]).
    pub narrow: bool,
    /// True if all rays have the same origin.
    pub one_origin: bool,
}

impl Frustum {
    /// The frustum around the rays in `lanes`, which share `octant` and have `t_min >= 0`.
    #[inline(always)]
    pub fn new(rays: &Packet8, lanes: u8, octant: Octant) -> Self {
        let rows = rays.rows();
        let first = rows[lanes.trailing_zeros() as usize & 7];
        let (mut low, mut high) = (first, first);
        if lanes == u8::MAX {
            for row in rows {
                (low, high) = (row.min_or(low), row.max_or(high));
            }
        } else {
            set_lanes(lanes).for_each(|i| (low, high) = (rows[i].min_or(low), rows[i].max_or(high)));
        }
        Self::between(low, high, octant)
    }

    /// The frustum between the least and the greatest values of some rays, in the lanes of [`Packet8::rows`].
    #[inline(always)]
    fn between(low: F32x8, high: F32x8, octant: Octant) -> Self {
        let backwards = octant[0] | octant[1] << 1 | octant[2] << 2;
        // Origins are swapped along axes on which the rays run forwards, inverse directions on the others.
        let swapped = Mask8::from_bits(((backwards ^ 0b111) | backwards << 4) as u8);
        Self { near: swapped.select(high, low), far: swapped.select(low, high) }
    }

    /// The frustum around all rays of some packets. Returns `None` if the rays do not share an octant, if a lane is
    /// inactive, if a direction component is zero, or if a `t_min` is negative.
    #[inline(always)]
    pub fn around(packets: &[Ray8]) -> Option<TileFrustum> {
        let (mut low, mut high) = ([F32x8::INFINITY; 8], [-F32x8::INFINITY; 8]);
        for rays in packets {
            let (o, d) = (rays.origin, rays.dir);
            let signs = [d.x.sign_bits(), d.y.sign_bits(), d.z.sign_bits()];
            if rays.active != u8::MAX || signs.iter().any(|&s| s != 0 && s != u8::MAX) {
                return None;
            }
            // A NaN is ignored: its ray hits nothing.
            for (k, x) in [o.x, o.y, o.z, rays.t_min, d.x, d.y, d.z, rays.t_max].into_iter().enumerate() {
                (low[k], high[k]) = (x.min_or(low[k]), x.max_or(high[k]));
            }
        }
        let low = F32x8::transpose(low).into_iter().fold(F32x8::INFINITY, |least, row| row.min_or(least));
        let high = F32x8::transpose(high).into_iter().fold(-F32x8::INFINITY, |most, row| row.max_or(most));
        let (forwards, back) = (F32x8::ZERO.lt(low).bits(), high.lt(F32x8::ZERO).bits());
        if (forwards | back) & DIRECTIONS != DIRECTIONS || low.lane(T_MIN) < 0.0 {
            return None;
        }
        // Division keeps the order of numbers, and rounding keeps it.
        let inverse = Mask8::from_bits(DIRECTIONS);
        let (least, most) = (inverse.select(F32x8::ONE / high, low), inverse.select(F32x8::ONE / low, high));
        let octant = [4, 5, 6].map(|k| usize::from(back >> k & 1));
        let (width, middle) = ((high - low).to_array(), (high + low).to_array());
        let squared = |v: [f32; 8]| v[4] * v[4] + v[5] * v[5] + v[6] * v[6];
        Some(TileFrustum {
            frustum: Self::between(least, most, octant),
            octant,
            narrow: squared(width) <= NARROW * squared(middle),
            one_origin: low.eq(high).bits() & ORIGINS == ORIGINS,
        })
    }

    /// The greatest `t_max` of the rays.
    #[inline(always)]
    pub fn t_max(&self) -> f32 {
        self.far.lane(T_MAX)
    }

    /// Sets the greatest `t_max` of the rays.
    #[inline(always)]
    pub fn set_t_max(&mut self, t_max: f32) {
        self.far.set_lane(T_MAX, t_max);
    }

    /// Tests eight boxes. Returns those that the frustum hits before its `t_max`, and a lower bound of the ray parameter at
    /// which a ray enters each box.
    #[inline(always)]
    pub fn boxes_hit(&self, boxes: &Aabb8, octant: Octant) -> (u8, F32x8) {
        let near = |axis: usize| {
            (boxes.near(axis, octant) - F32x8::from(self.near.lane(axis))) * F32x8::from(self.near.lane(axis + 4))
        };
        let far = |axis: usize| {
            (boxes.far(axis, octant) - F32x8::from(self.far.lane(axis))) * F32x8::from(self.far.lane(axis + 4))
        };
        let enter = near(0).max_or(near(1).max_or(near(2).max_or(F32x8::ZERO)));
        let leave = widened(far(0).min_or(far(1).min_or(far(2).min_or(F32x8::from(self.t_max())))));
        (enter.le(leave).bits(), enter)
    }

    /// Returns false if the frustum certainly misses everything in a tree. It visits at most `visits` nodes and returns
    /// true if they do not decide.
    #[inline(always)]
    pub fn reaches<L>(&self, tree: &Bvh8<L>, octant: Octant, visits: usize) -> bool {
        if tree.root == NodeRef::NONE {
            return false;
        }
        let mut open: ArrayVec<NodeRef, { 7 * MOST_VISITS + 1 }> = ArrayVec::new();
        open.push(tree.root);
        for _ in 0..visits.min(MOST_VISITS) {
            let Some(here) = open.pop() else { return false };
            if here.is_leaf() {
                return true;
            }
            let node = &tree.nodes[here.index()];
            set_lanes(self.boxes_hit(&node.boxes, octant).0).for_each(|c| open.push(node.children[c]));
        }
        !open.is_empty()
    }
}
