//! Some rays of one octant as one: the intervals that their starts and inverse directions lie in.

use super::bvh8::{Planes, leave_of};
use super::rays::{Eight, each};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// A bound on rays that share an octant and start at no negative `t`: it meets at least the boxes that one of them
/// can meet something in, and enters them no later. (Overbeck, Ramamoorthi, Mark 2008; interval arithmetic instead of
/// planes.)
///
/// For a ray that meets something at `t > t_min >= 0` in a box, the far planes lie ahead, so a far plane as seen from
/// the start that is farthest from it, times the greatest inverse, is no less than the ray's own; and a near plane
/// seen from the start next to it, times the least inverse, is no more, or not above zero where it lies behind. Each
/// step rounds numbers in that order, and rounding keeps it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Beam {
    /// By axis, the start that reaches near planes first; a gap; by axis, the inverse direction that is least in
    /// magnitude; a gap.
    near: F32x8,
    /// By axis, the start that reaches far planes last; a gap; by axis, the inverse direction that is greatest in
    /// magnitude; the greatest of the rays' limits.
    far: F32x8,
}

/// The lane of [`Beam::far`] that holds the limit.
const LIMIT: usize = 7;

impl Beam {
    /// Around the rays in `lanes`, which share the octant and of which none begins below zero.
    #[inline(always)]
    pub fn new(rays: &Eight, lanes: u8, octant: [usize; 3]) -> Self {
        let rows = rays.rows();
        let first = rows[lanes.trailing_zeros() as usize & 7];
        let (mut low, mut high) = (first, first);
        if lanes == u8::MAX {
            for row in rows {
                (low, high) = (row.min_or(low), row.max_or(high));
            }
        } else {
            each(lanes, |i| (low, high) = (rows[i].min_or(low), rows[i].max_or(high)));
        }
        let backwards = octant[0] | octant[1] << 1 | octant[2] << 2;
        // Starts are swapped where the rays run forwards, inverse directions where they run backwards.
        let swapped = Mask8::from_bits(((backwards ^ 0b111) | backwards << 4) as u8);
        Self { near: swapped.select(high, low), far: swapped.select(low, high) }
    }

    /// How far it reaches.
    #[inline(always)]
    pub fn t_max(&self) -> f32 {
        self.far.lane(LIMIT)
    }

    /// Shortens it.
    #[inline(always)]
    pub fn limit(&mut self, t_max: f32) {
        self.far.set_lane(LIMIT, t_max);
    }

    /// Which of eight boxes it meets before its limit, and where it enters them.
    #[inline(always)]
    pub fn meet(&self, planes: &Planes, octant: [usize; 3]) -> (u8, F32x8) {
        let near = |axis: usize| {
            (planes[axis][octant[axis] & 1] - F32x8::from(self.near.lane(axis))) * F32x8::from(self.near.lane(axis + 4))
        };
        let far = |axis: usize| {
            (planes[axis][(octant[axis] & 1) ^ 1] - F32x8::from(self.far.lane(axis)))
                * F32x8::from(self.far.lane(axis + 4))
        };
        let enter = near(0).max_or(near(1).max_or(near(2).max_or(F32x8::ZERO)));
        let leave = leave_of(Vec3x8::new(far(0), far(1), far(2)), F32x8::from(self.t_max()));
        (enter.le(leave).bits(), enter)
    }
}

/// The largest of eight numbers.
#[inline(always)]
pub(super) fn greatest(x: F32x8) -> f32 {
    let [a, b, c, d, e, f, g, h] = x.to_array();
    let (a, b, c, d) = (a.max_or(e), b.max_or(f), c.max_or(g), d.max_or(h));
    a.max_or(c).max_or(b.max_or(d))
}
