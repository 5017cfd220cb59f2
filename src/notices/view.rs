//! Position of a box in the picture.

use glam::DVec3;

use crate::geometry::Aabb;
use crate::scene::{Projection, Scene};

/// Position of a box in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Extent {
    /// All of it is behind the camera.
    Behind,
    /// All of it is beyond one edge of the picture.
    Beside,
    /// Some of it may be visible; its larger side in pixels.
    Pixels(f64),
}

/// Axes and angles of a camera.
pub(super) struct View {
    eye: DVec3,
    /// Unit vectors to the right, up and forward.
    axes: [DVec3; 3],
    /// Half of the picture's width and height: tangents of angles, or lengths if rays are parallel.
    half: [f64; 2],
    parallel: bool,
    height: f64,
}

impl View {
    pub(super) fn of(scene: &Scene) -> Self {
        let (camera, settings) = (&scene.camera, &scene.settings);
        let eye = camera.eye.as_dvec3();
        let forward = (camera.target.as_dvec3() - eye).normalize_or_zero();
        let right = forward.cross(camera.up.as_dvec3()).normalize_or_zero();
        let (half, parallel) = match camera.projection {
            Projection::Pinhole { vfov } => ((f64::from(vfov).to_radians() * 0.5).tan(), false),
            Projection::Orthographic { height } => (f64::from(height) * 0.5, true),
            // It sees all around.
            Projection::Map(_) => (f64::INFINITY, false),
        };
        let height = f64::from(settings.height.max(1));
        let half = [half * f64::from(settings.width) / height, half];
        Self { eye, axes: [right, right.cross(forward), forward], half, parallel, height }
    }

    /// Returns the position of a box that is not empty.
    pub(super) fn extent(&self, bounds: &Aabb) -> Extent {
        let ends = [bounds.lo.as_dvec3(), bounds.hi.as_dvec3()];
        let corner = |k: usize| DVec3::new(ends[k & 1].x, ends[k >> 1 & 1].y, ends[k >> 2].z) - self.eye;
        let corners: [[f64; 3]; 8] = std::array::from_fn(|k| self.axes.map(|axis| axis.dot(corner(k))));
        if corners.iter().all(|c| c[2] <= 0.0) {
            return Extent::Behind;
        }
        // Distance of the picture's edge from the axis at the depth of a corner. It is below 0 behind the eye, which
        // makes this the test against the plane through the eye and that edge.
        let edge = |c: &[f64; 3], axis: usize| self.half[axis] * if self.parallel { 1.0 } else { c[2] };
        let beyond = |axis: usize, sign: f64| corners.iter().all(|c| sign * c[axis] > edge(c, axis));
        if (0..2).any(|axis| beyond(axis, 1.0) || beyond(axis, -1.0)) {
            return Extent::Beside;
        }
        if !self.parallel && corners.iter().any(|c| c[2] <= 0.0) {
            return Extent::Pixels(f64::INFINITY);
        }
        let side = |axis: usize| {
            let at = corners.iter().map(|c| if self.parallel { c[axis] } else { c[axis] / c[2] });
            let (lo, hi) = at.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
            hi - lo
        };
        Extent::Pixels(side(0).max(side(1)) * self.height / (2.0 * self.half[1]))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::{Camera, Settings};

    #[test]
    fn a_box_is_behind_beside_or_so_many_pixels_wide() {
        // The camera looks along -z. At a distance of 10 the picture is 20 units wide and high, ten pixels per unit.
        let camera = Camera {
            eye: Vec3::ZERO,
            target: -Vec3::Z,
            projection: Projection::Pinhole { vfov: 90.0 },
            ..Camera::default()
        };
        let settings = Settings { width: 200, height: 200, ..Settings::default() };
        let mut scene = Scene { camera, settings, ..Scene::default() };
        let flat = |centre: Vec3, half: f32| {
            let reach = Vec3::new(half, half, 0.0);
            Aabb { lo: centre - reach, hi: centre + reach }
        };
        let at = |scene: &Scene, centre, half| View::of(scene).extent(&flat(centre, half));
        assert_eq!(at(&scene, Vec3::Z * 10.0, 1.0), Extent::Behind);
        assert_eq!(at(&scene, Vec3::new(12.0, 0.0, -10.0), 1.0), Extent::Beside);
        assert_eq!(at(&scene, Vec3::new(0.0, -12.0, -10.0), 1.0), Extent::Beside);
        let Extent::Pixels(pixels) = at(&scene, Vec3::new(10.0, 0.0, -10.0), 1.0) else { panic!("part of it is seen") };
        assert!((pixels - 20.0).abs() < 1e-9, "{pixels}");
        scene.camera.projection = Projection::Orthographic { height: 20.0 };
        assert_eq!(at(&scene, Vec3::new(12.0, 0.0, -90.0), 1.0), Extent::Beside);
        let Extent::Pixels(pixels) = at(&scene, Vec3::Z * -90.0, 1.0) else { panic!("it is seen") };
        assert!((pixels - 20.0).abs() < 1e-9, "{pixels}");
    }
}
