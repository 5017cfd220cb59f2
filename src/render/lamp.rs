//! End of a shadow ray to a lamp.

use crate::math::{Real, Vector3, gamma};

/// Returns the `t_max` for occlusion along a shadow ray of length `distance`. It lies slightly before the lamp, by the
/// amount that rounding can misplace a surface on which the lamp itself stands. Otherwise a ceiling would shade its own
/// lamp in places.
///
/// The intersection test moves a surface by up to 8 unit roundoffs of the distance and 6 of the triangle's extent. The
/// coordinates at both ends of the ray stand in for that extent. At an angle the error grows by one over the cosine. 32
/// roundoffs suffice down to a cosine of 1/4.
/// cosine is below 1. 32 roundoffs hold that down to a cosine of a quarter.
#[inline]
pub fn before_lamp<R: Real>(origin: Vector3<R>, dir: Vector3<R>, distance: R) -> R {
    let there = dir.fma(distance, origin);
    let most = origin.abs().max_component().max(there.abs().max_component());
    let end = distance - (distance + most) * R::splat(f64::from(gamma(32)));
    R::select(distance.lt(R::splat(f64::INFINITY)), end, distance)
}
