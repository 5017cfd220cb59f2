//! Some rays of one octant as one: the intervals that their starts and inverse directions lie in.

use arrayvec::ArrayVec;

use super::bvh8::{Bvh8, Child, Planes, leave_of};
use super::rays::{Way8, each};
use crate::geometry::Ray8;
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

/// The lane that holds the lower ends of intervals, and those that hold directions.
const T_MIN: usize = 3;
const DIRECTIONS: u8 = 0b0111_0000;
const STARTS: u8 = 0b0000_0111;

/// Directions within a box whose diagonal is this part (squared) of twice its distance go together: some 13 degrees to
/// either side.
const NARROW: f32 = 0.05;

/// Nodes that [`Beam::reaches`] looks into at most.
const MOST_VISITS: usize = 12;

/// What [`Beam::around`] tells of some packets.
pub(super) struct Hull {
    /// Around all rays.
    pub beam: Beam,
    /// The octant that they share.
    pub octant: [usize; 3],
    /// Whether they go about the same way.
    pub narrow: bool,
    /// Whether they start in one point.
    pub one_start: bool,
}

impl Beam {
    /// Around the rays in `lanes`, which share the octant and of which none begins below zero.
    #[inline(always)]
    pub fn new(rays: &Way8, lanes: u8, octant: [usize; 3]) -> Self {
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
        Self::between(low, high, octant)
    }

    /// By lane as [`Way8::rows`] has a ray, the least and the greatest numbers of some rays.
    #[inline(always)]
    fn between(low: F32x8, high: F32x8, octant: [usize; 3]) -> Self {
        let backwards = octant[0] | octant[1] << 1 | octant[2] << 2;
        // Starts are swapped where the rays run forwards, inverse directions where they run backwards.
        let swapped = Mask8::from_bits(((backwards ^ 0b111) | backwards << 4) as u8);
        Self { near: swapped.select(high, low), far: swapped.select(low, high) }
    }

    /// Around all rays of some packets; `None` where they share no octant, or where that cannot be told at little cost.
    #[inline(always)]
    pub fn around(packets: &[Ray8]) -> Option<Hull> {
        let (mut low, mut high) = ([F32x8::INFINITY; 8], [-F32x8::INFINITY; 8]);
        for rays in packets {
            let (o, d) = (rays.origin, rays.dir);
            let signs = [d.x.sign_bits(), d.y.sign_bits(), d.z.sign_bits()];
            if rays.active != u8::MAX || signs.iter().any(|&s| s != 0 && s != u8::MAX) {
                return None;
            }
            // What is not a number passes; its ray meets nothing.
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
        // Dividing keeps the order, and rounding keeps it.
        let inverse = Mask8::from_bits(DIRECTIONS);
        let (least, most) = (inverse.select(F32x8::ONE / high, low), inverse.select(F32x8::ONE / low, high));
        let octant = [4, 5, 6].map(|k| usize::from(back >> k & 1));
        let (width, middle) = ((high - low).to_array(), (high + low).to_array());
        let squared = |v: [f32; 8]| v[4] * v[4] + v[5] * v[5] + v[6] * v[6];
        Some(Hull {
            beam: Self::between(least, most, octant),
            octant,
            narrow: squared(width) <= NARROW * squared(middle),
            one_start: low.eq(high).bits() & STARTS == STARTS,
        })
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

    /// Whether anything in a tree may be met, as far as `visits` nodes tell.
    #[inline(always)]
    pub fn reaches<L>(&self, tree: &Bvh8<L>, octant: [usize; 3], visits: usize) -> bool {
        if tree.root == Child::NONE {
            return false;
        }
        let mut open: ArrayVec<Child, { 7 * MOST_VISITS + 1 }> = ArrayVec::new();
        open.push(tree.root);
        for _ in 0..visits.min(MOST_VISITS) {
            let Some(child) = open.pop() else { return false };
            if child.is_leaf() {
                return true;
            }
            let node = &tree.nodes[child.index()];
            each(self.meet(&node.planes, octant).0, |c| open.push(node.children[c]));
        }
        !open.is_empty()
    }
}

/// The largest of eight numbers.
#[inline(always)]
pub(super) fn greatest(x: F32x8) -> f32 {
    let [a, b, c, d, e, f, g, h] = x.to_array();
    let (a, b, c, d) = (a.max_or(e), b.max_or(f), c.max_or(g), d.max_or(h));
    a.max_or(c).max_or(b.max_or(d))
}
