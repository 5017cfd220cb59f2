//! The test of most ray tracers.

use super::formula::{Meeting, TriangleTest, cross};
use super::lanes::Lanes;
use crate::math::Vector3;
use crate::simd::Reciprocal;

/// The test of Möller and Trumbore ("Fast, minimum storage ray/triangle intersection", Journal of Graphics Tools 2(1), 1997).
/// It solves `o + t d = (1 - u - v) a + u b + v c` by Cramer's rule, on both faces. The paper's epsilon is left out. It changes no
/// figure here, since no ray hits the triangles that it rejects.
///
/// Known failures: two triangles with a common edge compute `u`, `v` and `u + v` from different numbers. So rays through the
/// edge pass between them: a sixth of those aimed at one. `t` of a triangle seen nearly edge-on may have any value (Embree,
/// issue 387: 12 291, with every corner nearer than 600).
#[derive(Clone, Copy, Debug, Default)]
pub struct MollerTrumbore;

impl TriangleTest for MollerTrumbore {
    type Ray<R: Lanes> = (Vector3<R>, Vector3<R>);

    #[inline(always)]
    fn prepare_by<R: Lanes, D: Reciprocal>(origin: Vector3<R>, dir: Vector3<R>) -> Self::Ray<R> {
        (origin, dir)
    }

    #[inline(always)]
    fn meet_by<R: Lanes, D: Reciprocal>(&(origin, dir): &Self::Ray<R>, &[a, b, c]: &[Vector3<R>; 3]) -> Meeting<R> {
        let (first, second) = (b - a, c - a);
        let p = cross(dir, second);
        let determinant = first.dot(p);
        let scale = D::of(determinant);
        let from = origin - a;
        let u = from.dot(p) * scale;
        let q = cross(from, first);
        let v = dir.dot(q) * scale;
        let t = second.dot(q) * scale;
        let zero = R::zero();
        let hit = !determinant.eq(zero) & u.ge(zero) & v.ge(zero) & (u + v).le(R::one());
        Meeting { hit: hit & t.abs().lt(R::splat(f64::INFINITY)), t, u, v, settled: R::mask(0) }
    }
}
