//! Camera rays.

use glam::{DVec3, Vec3};

use crate::geometry::Ray;
use crate::math::Real;
use crate::optics::PlanarReflection;
use crate::scene::{Camera, MapKind, Projection};
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
    /// Environment map whose texels are the pixels, and its rows.
    map: Option<(MapKind, u32)>,
    /// Film units per pixel.
    pixel: f32,
    half_width: f32,
    half_height: f32,
}

impl Lens {
    /// Returns the lens of `camera` for a picture of `width` by `height` pixels.
    #[must_use]
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        Self::framed(camera, width, height, camera.eye, |direction| direction)
    }

    /// Returns the lens of the mirror image of `camera`: its eye and its frame through the matrix, in `f64`. An odd number of
    /// mirrors gives a left-handed frame, so that each pixel sees what the mirror shows there.
    #[must_use]
    pub fn mirrored(camera: &Camera, width: u32, height: u32, mirror: &PlanarReflection<f64>) -> Self {
        let eye = DVec3::from(mirror.point(camera.eye.as_dvec3().into())).as_vec3();
        Self::framed(camera, width, height, eye, |direction| mirror.direction(direction.into()).into())
    }

    fn framed(camera: &Camera, width: u32, height: u32, eye: Vec3, turned: impl Fn(DVec3) -> DVec3) -> Self {
        let [right, up, forward] = camera.frame();
        let (pinhole, half_extent) = match camera.projection {
            Projection::Pinhole { vfov } => (true, (f64::from(vfov).to_radians() * 0.5).tan()),
            Projection::Orthographic { height } => (false, f64::from(height) * 0.5),
            Projection::Map(_) => (true, 1.0),
        };
        let map = match camera.projection {
            Projection::Map(kind) => Some((kind, height)),
            Projection::Pinhole { .. } | Projection::Orthographic { .. } => None,
        };
        let round = |v: DVec3| turned(v).as_vec3();
        Self {
            eye,
            forward: round(forward),
            right: round(right * half_extent),
            up: round(up * half_extent),
            pinhole,
            map,
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
        if let Some((kind, rows)) = self.map {
            return (Vec3x8::splat(self.eye), self.texels8(kind, rows, x, y));
        }
        let pixel = F32x8::from(self.pixel);
        let across = Vec3x8::splat(self.right) * ((x - F32x8::from(self.half_width)) * pixel);
        let rise = Vec3x8::splat(self.up) * ((F32x8::from(self.half_height) - y) * pixel);
        let offset = across + rise;
        let (eye, forward) = (Vec3x8::splat(self.eye), Vec3x8::splat(self.forward));
        if self.pinhole { (eye, (forward + offset).normalized()) } else { (eye + offset, forward) }
    }

    /// Returns unit directions of the texels of an environment map.
    #[cold]
    fn texels8(&self, kind: MapKind, rows: u32, x: F32x8, y: F32x8) -> Vec3x8 {
        let mut out = Vec3x8::splat(self.forward);
        for lane in 0..8 {
            let dir = kind.direction(f64::from(x.lane(lane)), f64::from(y.lane(lane)), rows);
            let [right, up, forward] = [self.right, self.up, self.forward].map(|axis| axis.as_dvec3());
            out.set_lane(lane, (right * dir.x + up * dir.y - forward * dir.z).normalize().as_vec3());
        }
        out
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
    fn a_mirrored_lens_sends_the_mirror_images_of_all_rays_and_is_left_handed() {
        let floor = PlanarReflection::new(Vec3::new(0.0, -1.0, 0.0).as_dvec3().into(), DVec3::Y.into());
        for projection in [Projection::Pinhole { vfov: 40.0 }, Projection::Orthographic { height: 3.0 }] {
            let camera = Camera { eye: Vec3::new(1.0, 2.0, 3.0), projection, ..Camera::default() };
            let [plain, mirrored] = [Lens::new(&camera, 60, 40), Lens::mirrored(&camera, 60, 40, &floor)].map(|lens| {
                let (o, d) = lens.rays8(F32x8::from(17.0), F32x8::from(5.0));
                (o.lane(0), d.lane(0), lens.right.cross(lens.forward).dot(lens.up))
            });
            let image = |v: Vec3, height: f32| Vec3::new(v.x, -height - v.y, v.z);
            assert!((mirrored.0 - image(plain.0, 2.0)).length() < 1e-6);
            assert!((mirrored.1 - image(plain.1, 0.0)).length() < 1e-6);
            assert!(plain.2 > 0.0 && mirrored.2 < 0.0, "the mirror image of a right hand is a left hand");
        }
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
