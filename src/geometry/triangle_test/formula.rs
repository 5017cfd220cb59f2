//! The trait of the tests, and arithmetic that several of them share.

use super::lanes::Lanes;
use crate::math::{Real, Vector3};
use crate::simd::{Division, Reciprocal};

/// The intersection of the line of a ray with a triangle. Lanes without a hit hold undefined values.
#[derive(Clone, Copy, Debug)]
pub struct Meeting<R: Real> {
    /// True if the line hits the triangle, on either face. The caller tests the ray interval.
    pub hit: R::Mask,
    /// Ray parameter.
    pub t: R,
    /// Weight of the second corner.
    pub u: R,
    /// Weight of the third corner.
    pub v: R,
    /// Lanes that the number type could not decide and `f64` did.
    pub settled: R::Mask,
}

/// A ray/triangle test.
pub trait TriangleTest: Copy + Send + Sync + 'static {
    /// A ray prepared for the test.
    type Ray<R: Lanes>: Copy;

    /// Prepares a ray, whose direction is finite and not zero, with quotients by `D`.
    fn prepare_by<R: Lanes, D: Reciprocal>(origin: Vector3<R>, dir: Vector3<R>) -> Self::Ray<R>;

    /// Intersects the line of the ray with the triangle, with quotients by `D`.
    fn meet_by<R: Lanes, D: Reciprocal>(ray: &Self::Ray<R>, corners: &[Vector3<R>; 3]) -> Meeting<R>;

    /// [`TriangleTest::prepare_by`] with true division.
    #[inline(always)]
    fn prepare<R: Lanes>(origin: Vector3<R>, dir: Vector3<R>) -> Self::Ray<R> {
        Self::prepare_by::<R, Division>(origin, dir)
    }

    /// [`TriangleTest::meet_by`] with true division.
    #[inline(always)]
    fn meet<R: Lanes>(ray: &Self::Ray<R>, corners: &[Vector3<R>; 3]) -> Meeting<R> {
        Self::meet_by::<R, Division>(ray, corners)
    }
}

/// The textbook cross product: a difference of two products for each component. [`Vector3::cross`] is more accurate and more
/// expensive than the one in the published tests.
#[inline(always)]
pub(super) fn cross<R: Real>(a: Vector3<R>, b: Vector3<R>) -> Vector3<R> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// Returns true if none of three numbers is negative, or none is positive.
#[inline(always)]
pub(super) fn same_side<R: Real>([a, b, c]: [R; 3]) -> R::Mask {
    a.min_or(b.min_or(c)).ge(R::zero()) | a.max_or(b.max_or(c)).le(R::zero())
}
