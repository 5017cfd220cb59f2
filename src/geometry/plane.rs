//! Infinite planes.

use glam::Vec3;

use super::limit::COORDINATE_LIMIT;
use super::ray::Ray;
use super::slab::upper_end;
use crate::math::{Real, Vector3};

/// An infinite plane: the points `p` with `normal . (p - point) = 0`. The normal points outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point on the plane, in scene units.
    pub point: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

impl Plane {
    /// Returns true if rays can hit the plane: the point is within [`COORDINATE_LIMIT`] and the normal is of unit length.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        let near = self.point.abs().cmple(Vec3::splat(COORDINATE_LIMIT)).all();
        near && self.normal.is_finite() && (self.normal.length_squared() - 1.0).abs() < 1e-3
    }

    /// Intersects `ray` with the plane, from either side. Returns `t`. This scalar test defines the eight-wide kernel.
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let t_max = upper_end(ray)?;
        let t = intersect(ray.origin.into(), ray.dir.into(), self.point.into(), self.normal.into());
        (ray.t_min < t && t <= t_max).then_some(t)
    }
}

/// Intersects the line of each ray with the plane. Returns `t`, which is infinite or NaN if the line is parallel to it.
#[inline(always)]
pub(crate) fn intersect<R: Real>(origin: Vector3<R>, dir: Vector3<R>, point: Vector3<R>, normal: Vector3<R>) -> R {
    (point - origin).dot(normal) / dir.dot(normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_met_from_either_side_but_not_along_it() {
        let floor = Plane { point: Vec3::new(7.0, 1.0, -3.0), normal: Vec3::Y };
        assert_eq!(floor.intersect(&Ray::new(Vec3::ZERO, Vec3::Y)), Some(1.0));
        assert_eq!(floor.intersect(&Ray::new(Vec3::Y * 3.0, Vec3::new(1.0, -0.5, 0.0))), Some(4.0));
        assert_eq!(floor.intersect(&Ray::new(Vec3::ZERO, -Vec3::Y)), None);
        assert_eq!(floor.intersect(&Ray::new(Vec3::ZERO, Vec3::X)), None);
        assert_eq!(floor.intersect(&Ray::new(Vec3::Y, Vec3::X)), None);
        assert_eq!(floor.intersect(&Ray { t_min: 1.0, ..Ray::new(Vec3::ZERO, Vec3::Y) }), None);
    }
}
