//! Infinite planes.

use glam::Vec3;

use super::slab::upper_end;
use super::{COORDINATE_LIMIT, Ray};
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

    /// Where `ray` meets the plane, from either side. This is what the eight-wide kernel means.
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let t_max = upper_end(ray)?;
        let t = intersect(ray.origin.into(), ray.dir.into(), self.point.into(), self.normal.into());
        (ray.t_min < t && t <= t_max).then_some(t)
    }
}

/// Where the line of each ray meets the plane; infinite or NaN where it runs along it.
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
