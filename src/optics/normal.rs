//! Shading normals that never send light through the surface.

use super::reflect;
use crate::math::{LaneMask, Real, Vector3};

/// The least sine of the angle between a secondary direction and the surface it leaves, where only an interpolated
/// normal decided that direction: 2^-10, a twentieth of a degree.
const LEAST_RISE: f64 = 1.0 / 1024.0;

/// The shading normal bent just far enough towards the geometric one that the mirror direction of `incident` about
/// it rises above the surface by 2^-10, or as far as `incident` comes down on it where that is less. Both
/// normals are of unit length and on the incident side of the surface. A normal that needs no bending comes back to
/// the bit.
///
/// Near grazing incidence rounding spoils a bent normal; one that faces away or whose mirror direction does not rise
/// by half of what it should gives way to the geometric normal, whose mirror direction rises as far as `incident` comes down. So does a
/// shading normal that is NaN.
#[inline(always)]
pub fn consistent_normal<R: Real>(incident: Vector3<R>, geometric: Vector3<R>, shading: Vector3<R>) -> Vector3<R> {
    let mirrored = reflect(incident, shading);
    let rise = mirrored.dot(geometric);
    // A ray that itself grazes the surface cannot leave more steeply than it came.
    let least = R::splat(LEAST_RISE).min(-incident.dot(geometric));
    let rises = rise.ge(least);
    if rises.all() {
        return shading;
    }
    let lifted = tilted(mirrored, geometric, rise, least);
    let halfway = lifted - incident;
    let bent = halfway.normalized();
    // Below a millionth the difference of two unit vectors is all rounding.
    let usable = halfway.length_squared().gt(R::splat(1e-12))
        & incident.dot(bent).lt(R::zero())
        & reflect(incident, bent).dot(geometric).ge(least * R::splat(0.5));
    Vector3::select(rises, shading, Vector3::select(usable, bent, geometric))
}

/// A refracted direction bent just far enough that it sinks below the surface by 2^-10; one that does so
/// already comes back to the bit. `geometric` faces the incident side. What points so nearly straight up
/// that rounding decides its bearing, and what is not a number, comes back as straight down.
#[inline(always)]
pub fn below_surface<R: Real>(refracted: Vector3<R>, geometric: Vector3<R>) -> Vector3<R> {
    let rise = refracted.dot(geometric);
    let least = R::splat(-LEAST_RISE);
    let sinks = rise.le(least);
    if sinks.all() {
        return refracted;
    }
    let lowered = tilted(refracted, geometric, rise, least);
    let usable = lowered.dot(geometric).le(least * R::splat(0.5));
    Vector3::select(sinks, refracted, Vector3::select(usable, lowered, -geometric))
}

/// The unit vector in the half plane of `direction` and `normal` whose component along `normal` is `wanted`, where that
/// of `direction` is `rise`; NaN or infinite where they are parallel.
#[inline(always)]
fn tilted<R: Real>(direction: Vector3<R>, normal: Vector3<R>, rise: R, wanted: R) -> Vector3<R> {
    let along = normal.fma(-rise, direction);
    let scale = (R::one() - wanted * wanted).sqrt() / along.length();
    normal.fma(wanted, along * scale)
}
