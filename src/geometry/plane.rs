//! Infinite planes.

use glam::Vec3;

use super::COORDINATE_LIMIT;
use crate::math::{Real, Vector3};

/// The points `p` with `normal . (p - point) = 0`; the outside is where the normal points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point on it, in scene units.
    pub point: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

impl Plane {
    /// Whether rays can meet it: a point within [`COORDINATE_LIMIT`] and a normal that is one.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        let near = self.point.abs().cmple(Vec3::splat(COORDINATE_LIMIT)).all();
        near && self.normal.is_finite() && (self.normal.length_squared() - 1.0).abs() < 1e-3
    }
}

/// Where the line of each ray meets the plane; infinite or NaN where it runs along it.
#[inline(always)]
pub(crate) fn intersect<R: Real>(origin: Vector3<R>, dir: Vector3<R>, point: Vector3<R>, normal: Vector3<R>) -> R {
    (point - origin).dot(normal) / dir.dot(normal)
}
