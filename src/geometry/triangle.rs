//! The watertight ray/triangle test of Woop, Benthin & Wald (JCGT 2013), written once for one ray and one triangle,
//! for one ray and eight triangles and for eight rays and one triangle: each of them gives a lane the same bits.
//!
//! The ray is made the axis of its longest direction component by a shear, and the three signed edge functions say
//! on which side of each edge it passes. They are plain products and differences: two triangles that share an edge
//! get exactly opposite values, and a value that is not zero has the right sign, since rounding is monotone. Where
//! one is zero, or so small that underflow may have eaten it, `f64` decides, in which these products are exact. So
//! the sheared corners are told apart without error, and every ray through a shared edge or corner meets a triangle.
//!
//! `t` is an average of the corners' own parameters with weights that are never negative, limited to the ray's way
//! through the triangle's box: however thin the triangle, `t` lies where it lies.

use glam::Vec3;

use super::Ray;
use super::slab::{SlabRay, T_LIMIT, grown, is_traceable};
use crate::math::{Real, Vector3};

/// Sums of edge functions below this may have lost digits to underflow: 2^-100.
const SMALL_SUM: f64 = 7.888_609_052_210_118e-31;

/// The longest axis of a direction, x before y before z among equals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis<M> {
    /// It is x.
    pub is_x: M,
    /// It is y.
    pub is_y: M,
}

impl<M: Copy> Axis<M> {
    /// Turns the axes cyclically so that the longest one is last.
    #[inline(always)]
    pub fn turn<R: Real<Mask = M>>(&self, v: Vector3<R>) -> Vector3<R> {
        let pick = |x, y, z| R::select(self.is_x, x, R::select(self.is_y, y, z));
        Vector3::new(pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z))
    }
}

/// A ray prepared for the test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay<R> {
    /// Start, with its axes turned by [`Axis::turn`].
    pub origin: Vector3<R>,
    /// Minus the slopes of the direction along its first and second axis over the last.
    pub shear: (R, R),
    /// The longest component of the direction.
    pub dz: R,
}

/// The corners of a triangle seen along the ray, and its edge functions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges<R> {
    /// Corners, relative to the ray's start; x and y sheared, z not.
    corners: [Vector3<R>; 3],
    /// Edge function opposite to each corner.
    value: [R; 3],
}

/// What solving for `t`, `u` and `v` gave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solution<R: Real> {
    /// Ray parameter.
    pub t: R,
    /// Weight of the second corner.
    pub u: R,
    /// Weight of the third corner.
    pub v: R,
    /// Lanes that only [`Edges::exact`] can tell.
    pub doubtful: R::Mask,
}

impl<R: Real> ShearedRay<R> {
    /// From start and direction, with the axis that was chosen.
    #[inline(always)]
    pub fn new(origin: Vector3<R>, dir: Vector3<R>) -> (Self, Axis<R::Mask>) {
        let d = dir.abs();
        let is_x = d.x.ge(d.y) & d.x.ge(d.z);
        let axis = Axis { is_x, is_y: !is_x & d.y.ge(d.z) };
        let dir = axis.turn(dir);
        (Self { origin: axis.turn(origin), shear: (-(dir.x / dir.z), -(dir.y / dir.z)), dz: dir.z }, axis)
    }

    /// The edge functions of the triangle whose corners, with axes turned, are given.
    #[inline(always)]
    pub fn edges(&self, corners: &[Vector3<R>; 3]) -> Edges<R> {
        let seen = |p: Vector3<R>| {
            let p = p - self.origin;
            Vector3::new(self.shear.0.fma(p.z, p.x), self.shear.1.fma(p.z, p.y), p.z)
        };
        let (a, b, c) = (seen(corners[0]), seen(corners[1]), seen(corners[2]));
        let value = [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x];
        Edges { corners: [a, b, c], value }
    }
}

impl<R: Real> SlabRay<R> {
    /// `t` limited to the ray's way through the grown box of a triangle, and whether there is such a way.
    #[inline(always)]
    pub fn limit_to_triangle(&self, corners: &[Vector3<R>; 3], t: R) -> (R, R::Mask) {
        let [a, b, c] = *corners;
        let least = |a: R, b: R, c: R| a.min_or(b.min_or(c));
        let most = |a: R, b: R, c: R| a.max_or(b.max_or(c));
        let lo = Vector3::new(least(a.x, b.x, c.x), least(a.y, b.y, c.y), least(a.z, b.z, c.z));
        let hi = Vector3::new(most(a.x, b.x, c.x), most(a.y, b.y, c.y), most(a.z, b.z, c.z));
        let (lo, hi) = grown(lo, hi);
        self.limit(lo, hi, t)
    }
}

impl<R: Real> Edges<R> {
    /// Where the edge functions do not contradict a hit.
    #[inline(always)]
    pub fn may_hit(&self) -> R::Mask {
        let [u, v, w] = self.value;
        u.min_or(v.min_or(w)).ge(R::zero()) | u.max_or(v.max_or(w)).le(R::zero())
    }

    /// `t` and the weights, for lanes where [`Edges::may_hit`].
    #[inline(always)]
    pub fn solve(&self, ray: &ShearedRay<R>) -> Solution<R> {
        let [eu, ev, ew] = self.value;
        let sum = eu + ev + ew;
        let least = eu.abs().min_or(ev.abs().min_or(ew.abs()));
        let doubtful = least.eq(R::zero()) | sum.abs().lt(R::splat(SMALL_SUM));
        let scale = R::one() / sum;
        let (first, u, v) = (eu * scale, ev * scale, ew * scale);
        let [a, b, c] = self.corners;
        let t = first.fma(a.z, u.fma(b.z, v * c.z)) / ray.dz;
        // The share that is left for the third corner, so that 1 - u - v, too, is never negative.
        let u = u.min_or(R::one());
        let v = v.min_or(R::one() - u);
        Solution { t, u, v, doubtful }
    }
}

impl Edges<f32> {
    /// The verdict of `f64`, in which the edge functions are free of error: `t`, `u` and `v` of a hit.
    #[cold]
    #[inline(never)]
    pub fn exact(&self, dz: f32) -> Option<(f32, f32, f32)> {
        let [a, b, c] = self.corners.map(|p| Vector3::new(f64::from(p.x), f64::from(p.y), f64::from(p.z)));
        let (eu, ev, ew) = (c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
        let same_side = (eu >= 0.0 && ev >= 0.0 && ew >= 0.0) || (eu <= 0.0 && ev <= 0.0 && ew <= 0.0);
        let sum = eu + ev + ew;
        if !same_side || sum == 0.0 {
            return None;
        }
        let t = (eu * a.z + ev * b.z + ew * c.z) / sum / f64::from(dz);
        let u = ((ev / sum) as f32).min_or(1.0);
        Some((t as f32, u, ((ew / sum) as f32).min_or(1.0 - u)))
    }
}

impl<R: Real> Edges<R> {
    /// One lane, taken out by `lane`.
    #[inline(always)]
    pub fn map(&self, lane: impl Fn(R) -> f32) -> Edges<f32> {
        Edges {
            corners: self.corners.map(|p| Vector3::new(lane(p.x), lane(p.y), lane(p.z))),
            value: self.value.map(lane),
        }
    }
}

/// Where `ray` meets the triangle: parameter, weight of the second corner, weight of the third. Both faces count.
///
/// This is what the eight-wide kernels mean.
#[must_use]
pub fn intersect(ray: &Ray, corners: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let (origin, dir) = (ray.origin.into(), ray.dir.into());
    let t_max = Real::min(ray.t_max, T_LIMIT);
    if ray.t_max.is_nan() || !is_traceable(origin, dir, ray.t_min, t_max) {
        return None;
    }
    let (sheared, axis) = ShearedRay::<f32>::new(origin, dir);
    let corners = corners.map(Into::into);
    let edges = sheared.edges(&corners.map(|p| axis.turn(p)));
    if !edges.may_hit() {
        return None;
    }
    let solved = edges.solve(&sheared);
    let (t, u, v) = if solved.doubtful { edges.exact(sheared.dz)? } else { (solved.t, solved.u, solved.v) };
    let (t, crossed) = SlabRay::<f32>::new(origin, dir).limit_to_triangle(&corners, t);
    (crossed && ray.t_min < t && t <= t_max).then_some((t, u, v))
}
