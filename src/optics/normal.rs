//! Shading normals that send no light through the surface.

use super::reflect::reflect;
use crate::math::{LaneMask, Real, Vector3};

/// Smallest sine of the angle between a surface and a secondary direction that an interpolated normal determined:
/// 2^-10, a twentieth of a degree.
const LEAST_RISE: f64 = 1.0 / 1024.0;

/// Returns the shading normal, bent towards the geometric one just far enough that the mirror direction of `incident`
/// rises above the surface by 2^-10. If `incident` arrives at a smaller sine, that sine is enough. Both normals are of
/// unit length and on the incident side of the surface. A normal that needs no bending is returned to the bit.
///
/// Near grazing incidence rounding spoils a bent normal. The geometric normal replaces it if it faces away, or if its
/// mirror direction rises by less than half of what it should; so it does for a shading normal that is NaN. The mirror
/// direction about the geometric normal rises as far as `incident` comes down.
#[inline(always)]
pub fn consistent_normal<R: Real>(incident: Vector3<R>, geometric: Vector3<R>, shading: Vector3<R>) -> Vector3<R> {
    let mirrored = reflect(incident, shading);
    let rise = mirrored.dot(geometric);
    // A ray that grazes the surface need not leave more steeply than it came.
    let least = R::splat(LEAST_RISE).min(-incident.dot(geometric));
    let rises = rise.ge(least);
    if rises.all() {
        return shading;
    }
    let lifted = tilted(mirrored, geometric, rise, least);
    let halfway = lifted - incident;
    let bent = halfway.normalized();
    // Below a millionth the difference of two unit vectors consists of rounding.
    let usable = halfway.length_squared().gt(R::splat(1e-12))
        & incident.dot(bent).lt(R::zero())
        & reflect(incident, bent).dot(geometric).ge(least * R::splat(0.5));
    Vector3::select(rises, shading, Vector3::select(usable, bent, geometric))
}

/// Returns a refracted direction, bent just far enough that it sinks below the surface by 2^-10. A direction that does
/// so already is returned to the bit. `geometric` faces the incident side. A direction so close to it that rounding
/// decides its bearing, and one that is not a number, is replaced by straight down.
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

/// Returns the unit vector in the half plane of `direction` and `normal` with the component `wanted` along `normal`.
/// `rise` is the component of `direction`. The result is NaN or infinite if the two are parallel.
#[inline(always)]
fn tilted<R: Real>(direction: Vector3<R>, normal: Vector3<R>, rise: R, wanted: R) -> Vector3<R> {
    let along = normal.fma(-rise, direction);
    let scale = (R::one() - wanted * wanted).sqrt() / along.length();
    normal.fma(wanted, along * scale)
}
