//! The slab test of a ray against an axis-aligned box, and the margin by which the box of a shape is grown.
//!
//! One text serves one ray and eight lanes. Every step is monotone in the planes of the box, as computed: a ray never enters
//! an inner box earlier than the outer one, nor leaves it later, not by one ulp. Shapes clamp their `t` to the interval of
//! their own box. So no hierarchy of enclosing boxes can lose or gain a hit.

use super::ray::Ray;
use crate::math::{Real, Vector3};

/// The largest ray parameter of a hit: hits beyond it are ignored, whatever `t_max` is. It lies below the largest `f32`, so
/// that an interval can be widened without overflow.
pub(crate) const T_LIMIT: f32 = 1.701_411_8e38;

/// Relative widening of an interval at its far end: `2^-19`, 32 unit roundoffs `u`.
///
/// Let `p` be a point of a triangle that the watertight test ([`super::triangle`]) reports as hit, and `t` its parameter.
/// Rounding of the sheared corners puts the exact ray up to `4 u |dir| t + 6 u extent` beside `p` along each axis. [`grown`]
/// covers the second part. A slab distance has an error of `3 u`. So near ends are at most `t (1 + 7 u)`, and far ends at
/// least `t (1 - 7 u)`: the interval lacks at most 14 u (15 u without fused products).
const WIDEN: f64 = 1.0 / 524_288.0;

/// Growth of a shape's box relative to its largest extent: `2^-20`, 16 unit roundoffs (6 are needed, see [`WIDEN`]).
const GROW_BY_EXTENT: f64 = 1.0 / 1_048_576.0;

/// Growth relative to each coordinate: `2^-23`. It covers the rounding of the subtraction itself.
const GROW_BY_PLACE: f64 = f32::EPSILON as f64;

/// A ray prepared for the slab test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlabRay<R> {
    /// Origin.
    pub origin: Vector3<R>,
    /// Reciprocal of each direction component, correctly rounded. It is infinite, with the sign of the component, if that is
    /// zero or denormal.
    pub inverse: Vector3<R>,
}

impl<R: Real> SlabRay<R> {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(origin: Vector3<R>, dir: Vector3<R>) -> Self {
        Self::by(origin, dir, |x| R::one() / x)
    }

    /// As [`SlabRay::new`], with reciprocals computed by `reciprocal`.
    #[inline(always)]
    pub fn by(origin: Vector3<R>, dir: Vector3<R>, reciprocal: impl Fn(R) -> R) -> Self {
        Self { origin, inverse: Vector3::new(reciprocal(dir.x), reciprocal(dir.y), reciprocal(dir.z)) }
    }

    /// Clips the interval `t_min..=t_max` to the box. Returns the parameters of entry and exit. The ray hits the box if
    /// entry <= exit.
    #[inline(always)]
    pub fn clip(&self, lo: Vector3<R>, hi: Vector3<R>, t_min: R, t_max: R) -> (R, R) {
        let back = |inverse: R| inverse.lt(R::zero());
        let (x, y, z) = (back(self.inverse.x), back(self.inverse.y), back(self.inverse.z));
        let near = Vector3::new(R::select(x, hi.x, lo.x), R::select(y, hi.y, lo.y), R::select(z, hi.z, lo.z));
        let far = Vector3::new(R::select(x, lo.x, hi.x), R::select(y, lo.y, hi.y), R::select(z, lo.z, hi.z));
        self.clip_sorted(near, far, t_min, t_max)
    }

    /// As [`SlabRay::clip`], with the planes sorted: near ones first, as seen along the ray.
    ///
    /// A ray within a plane of the box gives `0 * inf`, a NaN. [`Real::min_or`] and [`Real::max_or`] ignore a NaN on their
    /// left. So that plane does not bound the interval, for either sign of the zero.
    #[inline(always)]
    pub fn clip_sorted(&self, near: Vector3<R>, far: Vector3<R>, t_min: R, t_max: R) -> (R, R) {
        let n = (near - self.origin).times(self.inverse);
        let f = (far - self.origin).times(self.inverse);
        let enter = n.x.max_or(n.y.max_or(n.z.max_or(t_min)));
        let leave = f.x.min_or(f.y.min_or(f.z.min_or(t_max)));
        (enter, widened(leave))
    }

    /// Clamps `t` to the interval in which the ray is inside the box. The mask is false if the ray misses the box.
    #[inline(always)]
    pub fn limit(&self, lo: Vector3<R>, hi: Vector3<R>, t: R) -> (R, R::Mask) {
        let limit = R::splat(f64::from(T_LIMIT));
        let (enter, leave) = self.clip(lo, hi, -limit, limit);
        (leave.min_or(enter.max_or(t)), enter.le(leave))
    }

    /// As [`SlabRay::limit`], with the planes sorted: near ones first, as seen along the ray.
    #[inline(always)]
    pub fn limit_sorted(&self, near: Vector3<R>, far: Vector3<R>, t: R) -> (R, R::Mask) {
        let limit = R::splat(f64::from(T_LIMIT));
        let (enter, leave) = self.clip_sorted(near, far, -limit, limit);
        (leave.min_or(enter.max_or(t)), enter.le(leave))
    }
}

/// Widens the far end of an interval by [`WIDEN`]. NaN for -inf; no number is below NaN.
#[inline(always)]
pub(crate) fn widened<R: Real>(leave: R) -> R {
    leave.abs().fma(R::splat(WIDEN), leave)
}

/// Grows the box `lo..=hi` of a shape by a few ulps on every side, as its intersection test needs ([`WIDEN`]).
#[inline(always)]
pub(crate) fn grown<R: Real>(lo: Vector3<R>, hi: Vector3<R>) -> (Vector3<R>, Vector3<R>) {
    let extent = hi - lo;
    let extent = extent.x.max_or(extent.y.max_or(extent.z));
    let pad = extent.fma(R::splat(GROW_BY_EXTENT), R::splat(f64::from(f32::MIN_POSITIVE)));
    let margin = |p: R| p.abs().fma(R::splat(GROW_BY_PLACE), pad);
    (
        Vector3::new(lo.x - margin(lo.x), lo.y - margin(lo.y), lo.z - margin(lo.z)),
        Vector3::new(hi.x + margin(hi.x), hi.y + margin(hi.y), hi.z + margin(hi.z)),
    )
}

/// Returns true if a ray can hit something: origin and direction are finite, the direction is not zero, and the interval is
/// not empty.
#[inline(always)]
pub(crate) fn is_traceable<R: Real>(origin: Vector3<R>, dir: Vector3<R>, t_min: R, t_max: R) -> R::Mask {
    let finite = |v: Vector3<R>| {
        let most = R::splat(f64::from(f32::MAX));
        v.x.abs().le(most) & v.y.abs().le(most) & v.z.abs().le(most)
    };
    finite(origin) & finite(dir) & dir.abs().max_component().gt(R::zero()) & t_min.lt(t_max)
}

/// The upper end of the interval in which a ray is tested, or `None` if the ray cannot hit anything.
pub(crate) fn upper_end(ray: &Ray) -> Option<f32> {
    let t_max = Real::min(ray.t_max, T_LIMIT);
    let sound = !ray.t_max.is_nan() && is_traceable(ray.origin.into(), ray.dir.into(), ray.t_min, t_max);
    sound.then_some(t_max)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn meets(origin: Vec3, dir: Vec3, lo: Vec3, hi: Vec3) -> bool {
        let (enter, leave) = SlabRay::new(origin.into(), dir.into()).clip(lo.into(), hi.into(), 0.0, T_LIMIT);
        enter <= leave
    }

    /// Case RB-03 of the catalogue.
    #[test]
    fn a_ray_within_a_face_meets_the_closed_box_for_either_sign_of_zero() {
        let (lo, hi) = (Vec3::splat(-1.0), Vec3::splat(2.0));
        for axis in 0..3 {
            for along in (0..3).filter(|&k| k != axis) {
                for (place, inside) in [(-1.0, true), (2.0, true), (0.5, true), (-1.000_001, false), (2.000_001, false)]
                {
                    for signs in 0..8 {
                        let zero = |k: usize| if signs >> k & 1 == 0 { 0.0 } else { -0.0 };
                        let mut dir = Vec3::new(zero(0), zero(1), zero(2));
                        dir[along] = if signs >> along & 1 == 0 { 1.0 } else { -1.0 };
                        let mut origin = Vec3::splat(0.25);
                        origin[axis] = place;
                        origin[along] = -5.0 * dir[along];
                        assert_eq!(meets(origin, dir, lo, hi), inside, "{origin} {dir}");
                    }
                }
            }
        }
    }

    /// Cases RB-01, RB-02 of the catalogue.
    #[test]
    fn a_ray_through_a_corner_meets_the_box_however_flat() {
        let mut state = 9_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let mut count = 0;
        for i in 0..300_000 {
            let lo = Vec3::new(next(), next(), next()) * 64.0;
            let mut hi = lo + Vec3::new(next(), next(), next());
            if i % 3 == 0 {
                hi[i / 3 % 3] = lo[i / 3 % 3];
            }
            let corner = Vec3::new(
                if i & 1 == 0 { lo.x } else { hi.x },
                if i & 2 == 0 { lo.y } else { hi.y },
                if i & 4 == 0 { lo.z } else { hi.z },
            );
            let dir = ((Vec3::new(next(), next(), next()) - 0.5) * 1024.0).round() / 1024.0;
            let origin = corner - dir * 4.0;
            let exact = (0..3).all(|k| f64::from(origin[k]) + 4.0 * f64::from(dir[k]) == f64::from(corner[k]));
            if exact && dir != Vec3::ZERO {
                assert!(meets(origin, dir, lo, hi), "{origin} {dir} {lo} {hi}");
                count += 1;
            }
        }
        assert!(count > 10_000, "{count}");
    }

    /// Case RB-09 of the catalogue.
    #[test]
    fn an_empty_box_is_never_met() {
        let specials = [0.0, -0.0, 1.0, -1.0, 1e-45, -1e-45, f32::MAX, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for &x in &specials {
            for &y in &specials {
                for &o in &specials {
                    for &t in &[0.0, -1e30, f32::NEG_INFINITY] {
                        let ray = SlabRay::<f32>::new(Vec3::new(o, x, 0.0).into(), Vec3::new(x, y, 1.0).into());
                        let (enter, leave) = ray.clip(Vec3::INFINITY.into(), Vec3::NEG_INFINITY.into(), t, T_LIMIT);
                        let met = enter <= leave;
                        assert!(!met, "{o} {x} {y}: {enter} {leave}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_grown_box_holds_the_box_with_room_to_spare() {
        let mut state = 7_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let magnitude = 10_f32.powi((state >> 8) as i32 % 19 - 9);
            ((state >> 4) as f32 / (1 << 28) as f32 * 2.0 - 1.0) * magnitude
        };
        for _ in 0..10_000 {
            let (a, b) = (Vec3::new(next(), next(), next()), Vec3::new(next(), next(), next()));
            let (lo, hi) = (a.min(b), a.max(b));
            let (wide_lo, wide_hi) = grown::<f32>(lo.into(), hi.into());
            let need = 8.0 * 2_f64.powi(-24) * f64::from((hi - lo).max_element());
            for k in 0..3 {
                assert!(f64::from(Vec3::from(wide_lo)[k]) <= f64::from(lo[k]) - need);
                assert!(f64::from(Vec3::from(wide_hi)[k]) >= f64::from(hi[k]) + need);
            }
        }
    }
}
