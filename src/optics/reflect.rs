//! Mirror directions.

use crate::math::{Real, Vector3};

/// Returns `i - 2 (i . n) n`: the mirror image of a direction of travel. (The slides' `v + 2 (n . v) n` is for a vector
/// that points back along the ray. With an incident one the result would be up to three times as long.)
#[inline(always)]
pub fn reflect<R: Real>(incident: Vector3<R>, normal: Vector3<R>) -> Vector3<R> {
    let twice_cos = R::splat(-2.0) * incident.dot(normal);
    normal.fma(twice_cos, incident)
}
