//! The test of the lecture notes.

use super::formula::{Meeting, TriangleTest, cross, same_side};
use super::lanes::Lanes;
use crate::math::Vector3;
use crate::simd::Reciprocal;

/// The test of the handwritten notes: the intersection with the triangle's plane, then the areas of the three triangles that
/// this point forms with the sides, projected along the dominant axis of the normal.
///
/// Source: the notes on ray tracing ("Intersection of ray and triangle"): `n = (v2 - v1) x (v3 - v1)`, `D = -n . v`,
/// `t = (-(n . o) - D) / (n . d)`, then "all three sub-triangles' cross product positive, or all negative: inside".
/// Corrections: the notes give the area as `1/2 |a x b|`, which has no sign to compare. Here it is the component of `a x b`
/// along the dropped axis. An area of zero (a point on a side) counts as inside, or every edge would be a gap. The notes ask
/// "what if `n . d` = 0!?": a ray in the triangle's plane misses.
///
/// Known failures: the point is rounded onto the plane separately for each triangle. Two neighbours may find it on different
/// sides of their common edge. So the test leaks at edges and corners, most of all far from the origin, where the point has
/// few digits left. For the same reason a ray may hit both neighbours. `t` of a triangle seen nearly edge-on is a quotient of
/// two rounding errors.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaneArea;

impl TriangleTest for PlaneArea {
    type Ray<R: Lanes> = (Vector3<R>, Vector3<R>);

    #[inline(always)]
    fn prepare_by<R: Lanes, D: Reciprocal>(origin: Vector3<R>, dir: Vector3<R>) -> Self::Ray<R> {
        (origin, dir)
    }

    #[inline(always)]
    fn meet_by<R: Lanes, D: Reciprocal>(&(origin, dir): &Self::Ray<R>, &[a, b, c]: &[Vector3<R>; 3]) -> Meeting<R> {
        let normal = cross(b - a, c - a);
        let along = normal.dot(dir);
        let t = D::quotient(normal.dot(a) - normal.dot(origin), along);
        let point = dir.fma(t, origin);

        let size = normal.abs();
        let x_longest = size.x.ge(size.y) & size.x.ge(size.z);
        let y_longest = size.y.ge(size.z);
        let flat = |p: Vector3<R>| {
            let first = R::select(x_longest, p.y, R::select(y_longest, p.z, p.x));
            let second = R::select(x_longest, p.z, R::select(y_longest, p.x, p.y));
            (first, second)
        };
        let whole = R::select(x_longest, normal.x, R::select(y_longest, normal.y, normal.z));
        let (p, a, b, c) = (flat(point), flat(a), flat(b), flat(c));
        // Twice the signed area of the point with one side.
        let area = |q: (R, R), r: (R, R)| (q.0 - p.0) * (r.1 - p.1) - (q.1 - p.1) * (r.0 - p.0);
        let areas = [area(b, c), area(c, a), area(a, b)];
        let zero = R::zero();
        let sound = !along.eq(zero) & !whole.eq(zero) & t.abs().lt(R::splat(f64::INFINITY));
        let scale = D::of(whole);
        Meeting { hit: same_side(areas) & sound, t, u: areas[1] * scale, v: areas[2] * scale, settled: R::mask(0) }
    }
}
