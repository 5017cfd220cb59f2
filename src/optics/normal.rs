//! Shading normals that never send light through the surface.

use super::reflect;
use crate::math::{LaneMask, Real, Vector3};

/// The least sine of the angle between a secondary direction and the surface it leaves, where only an interpolated
/// normal decided that direction: 2^-10, a twentieth of a degree.
const LEAST_RISE: f64 = 1.0 / 1024.0;

/// The shading normal bent just far enough towards the geometric one that the mirror direction of `incident` about
/// it rises above the surface by [`LEAST_RISE`]. Both normals face the incident side. A normal that needs no bending
/// comes back to the bit.
#[inline(always)]
pub fn consistent_normal<R: Real>(incident: Vector3<R>, geometric: Vector3<R>, shading: Vector3<R>) -> Vector3<R> {
    let mirrored = reflect(incident, shading);
    let rise = mirrored.dot(geometric);
    let least = R::splat(LEAST_RISE);
    // A ray that itself grazes the surface cannot leave more steeply than it came.
    let least = least.min(-incident.dot(geometric));
    let sinks = rise.lt(least);
    if !sinks.any() {
        return shading;
    }
    let lifted = geometric.fma(least - rise, mirrored).normalized();
    let bent = (lifted - incident).normalized();
    Vector3::select(sinks, bent, shading)
}

/// A refracted direction bent just far enough that it sinks below the surface by [`LEAST_RISE`]; one that does so
/// already comes back to the bit. `geometric` faces the incident side.
#[inline(always)]
pub fn below_surface<R: Real>(refracted: Vector3<R>, geometric: Vector3<R>) -> Vector3<R> {
    let rise = refracted.dot(geometric);
    let least = R::splat(-LEAST_RISE);
    let stays = rise.gt(least);
    if !stays.any() {
        return refracted;
    }
    let lowered = geometric.fma(least - rise, refracted).normalized();
    Vector3::select(stays, lowered, refracted)
}
