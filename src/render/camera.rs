//! Camera rays.

use glam::{DVec3, Vec3};

use crate::geometry::Ray;
use crate::math::Real;
use crate::scene::{Camera, Projection};
use crate::simd::{F32x8, Vec3x8};

/// Precomputed camera frame, which turns a film position into a ray by two multiplications.
///
/// The frame is computed in `f64` and rounded once, so that a scene gives the same rays on every machine.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    eye: Vec3,
    forward: Vec3,
    /// Vector to the right, per film unit (half the picture height).
    right: Vec3,
    /// Vector up, per film unit.
    up: Vec3,
    pinhole: bool,
    /// Film units per pixel.
    pixel: f32,
    half_width: f32,
    half_height: f32,
}

impl Lens {
    /// Returns the lens of `camera` for a picture of `width` by `height` pixels.
    #[must_use]
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let forward = (camera.target.as_dvec3() - camera.eye.as_dvec3()).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let (pinhole, half_extent) = match camera.projection {
            Projection::Pinhole { vfov } => (true, (f64::from(vfov).to_radians() * 0.5).tan()),
            Projection::Orthographic { height } => (false, f64::from(height) * 0.5),
        };
        let round = |v: DVec3| v.as_vec3();
        Self {
            eye: camera.eye,
            forward: round(forward),
            right: round(right * half_extent),
            up: round(up * half_extent),
            pinhole,
            pixel: (2.0 / f64::from(height)) as f32,
            half_width: width as f32 * 0.5,
            half_height: height as f32 * 0.5,
        }
    }

    /// Returns the ray through a film position, as [`Lens::rays8`] does: of unit direction, from the eye to infinity.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let (origin, dir) = self.rays8(x.into(), y.into());
        Ray::new(origin.lane(0), dir.lane(0))
    }

    /// Returns origins and unit directions of the rays through film positions in pixels. `x` counts from the left edge
    /// and `y` from the top, so the first pixel's centre is (0.5, 0.5).
    #[inline]
    #[must_use]
    pub fn rays8(&self, x: F32x8, y: F32x8) -> (Vec3x8, Vec3x8) {
        let pixel = F32x8::from(self.pixel);
        let across = Vec3x8::splat(self.right) * ((x - F32x8::from(self.half_width)) * pixel);
        let rise = Vec3x8::splat(self.up) * ((F32x8::from(self.half_height) - y) * pixel);
        let offset = across + rise;
        let (eye, forward) = (Vec3x8::splat(self.eye), Vec3x8::splat(self.forward));
        if self.pinhole { (eye, (forward + offset).normalized()) } else { (eye + offset, forward) }
    }
}

/// Returns the film offset, in pixels, of sample `i` of `n` along one axis: the middle of its cell.
#[must_use]
pub fn sample_offset(i: u32, n: u32) -> F32x8 {
    F32x8::splat((f64::from(i) + 0.5) / f64::from(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_looks_at_the_target_and_the_corners_span_the_angle() {
        let camera = Camera {
            eye: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::new(1.0, 2.0, -7.0),
            up: Vec3::Y,
            projection: Projection::Pinhole { vfov: 90.0 },
            medium: None,
        };
        let lens = Lens::new(&camera, 200, 100);
        let (o, d) = lens.rays8(F32x8::from(100.0), F32x8::new([50.0, 0.0, 100.0, 50.0, 50.0, 50.0, 50.0, 50.0]));
        assert_eq!(o.lane(0), camera.eye);
        assert!((d.lane(0) - Vec3::NEG_Z).length() < 1e-6);
        // The top edge is 45 degrees up, the bottom one 45 down.
        assert!((d.lane(1) - Vec3::new(0.0, 0.5_f32.sqrt(), -(0.5_f32.sqrt()))).length() < 1e-6);
        assert!((d.lane(2) - Vec3::new(0.0, -(0.5_f32.sqrt()), -(0.5_f32.sqrt()))).length() < 1e-6);
        let (_, right) = lens.rays8(F32x8::from(150.0), F32x8::from(50.0));
        assert!(right.lane(0).x > 0.4, "x runs right");
    }

    #[test]
    fn orthographic_rays_are_parallel_and_as_far_apart_as_the_height_says() {
        let camera = Camera { projection: Projection::Orthographic { height: 4.0 }, ..Camera::default() };
        let lens = Lens::new(&camera, 10, 10);
        let (o, d) = lens.rays8(F32x8::from(5.0), F32x8::new([0.0, 10.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0]));
        assert!((o.lane(0).distance(o.lane(1)) - 4.0).abs() < 1e-5);
        assert_eq!(d.lane(0), d.lane(1));
    }
}
