//! The test of Embree's robust mode, in Plücker coordinates.

use super::formula::{Meeting, TriangleTest, cross};
use super::lanes::Lanes;
use crate::math::Vector3;
use crate::simd::Reciprocal;

/// The test by the side of each edge on which the ray passes: the product of their Plücker coordinates. Its form is that of
/// Embree 4's robust mode (`kernels/geometry/triangle_intersector_pluecker.h`). Corners are relative to the ray's origin. The
/// edge functions `d . ((p - q) x (p + q))` must have one sign, to within an ulp of their sum. `t` comes from the normal.
///
/// Two triangles that share an edge get exactly opposite values for it, so that no ray passes between them there.
///
/// Known failures: more than two triangles meet at a corner, and the roundings of their edges may disagree. The tolerance of
/// an ulp covers most of these rays. It also lets a ray hit a triangle beside which it passes. `t` of a triangle seen nearly
/// edge-on is a quotient of two rounding errors.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pluecker;

impl TriangleTest for Pluecker {
    type Ray<R: Lanes> = (Vector3<R>, Vector3<R>);

    #[inline(always)]
    fn prepare_by<R: Lanes, D: Reciprocal>(origin: Vector3<R>, dir: Vector3<R>) -> Self::Ray<R> {
        (origin, dir)
    }

    #[inline(always)]
    fn meet_by<R: Lanes, D: Reciprocal>(&(origin, dir): &Self::Ray<R>, &[a, b, c]: &[Vector3<R>; 3]) -> Meeting<R> {
        let (a, b, c) = (a - origin, b - origin, c - origin);
        let (ca, ab, bc) = (c - a, a - b, b - c);
        let u = cross(ca, c + a).dot(dir);
        let v = cross(ab, a + b).dot(dir);
        let w = cross(bc, b + c).dot(dir);
        let sum = u + v + w;
        let slack = sum.abs() * R::splat(2.0 * R::ROUNDOFF);
        let least = u.min_or(v.min_or(w));
        let most = u.max_or(v.max_or(w));
        let inside = least.ge(-slack) | most.le(slack);

        let normal = cross(ca, ab);
        let along = normal.dot(dir);
        let t = D::quotient(a.dot(normal), along);
        let scale = D::of(sum);
        let weight = |e: R| (e * scale).max(R::zero()).min(R::one());
        let zero = R::zero();
        let sound = !along.eq(zero) & !sum.eq(zero) & t.abs().lt(R::splat(f64::INFINITY));
        Meeting { hit: inside & sound, t, u: weight(u), v: weight(v), settled: R::mask(0) }
    }
}
