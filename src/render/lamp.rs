//! Where a shadow ray to a lamp ends.

use crate::math::{Real, Vector3, gamma};

/// How far along a shadow ray of length `distance` surfaces count as in its way: all of it but for what rounding can
/// misplace a surface that the lamp itself stands on, or else a lamp on a ceiling would be shaded by it here and there.
///
/// The intersection test moves a surface by 8 unit roundoffs of the distance and 6 of the triangle's extent, for which
/// the coordinates at both ends stand here; a ray that comes in at an angle meets it as many times farther off as its
/// cosine is below 1. 32 roundoffs hold that down to a cosine of a quarter.
#[inline]
pub fn before_lamp<R: Real>(origin: Vector3<R>, dir: Vector3<R>, distance: R) -> R {
    let there = dir.fma(distance, origin);
    let most = origin.abs().max_component().max(there.abs().max_component());
    let end = distance - (distance + most) * R::splat(f64::from(gamma(32)));
    R::select(distance.lt(R::splat(f64::INFINITY)), end, distance)
}
