//! Whether a pixel's value belongs to its camera ray at all.

use std::f64::consts::FRAC_PI_4;

use super::Prepared;

/// How far a camera ray is moved, in ulps of 1.
const ULPS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

impl Prepared<'_> {
    /// Whether the radiance at a point of the film moves by more than `tolerance` in any channel when the camera ray
    /// through it moves by a few ulps of `f32`: its direction by up to 8 of them, or its origin by as many of the
    /// eye's largest coordinate, to eight sides. So it is along edges and on paths that magnify roundings, and no
    /// renderer in `f32` can be held to a value there. The point is as in [`Prepared::camera_ray`].
    #[must_use]
    pub fn is_ill_conditioned(&self, x: f64, y: f64, tolerance: f64) -> bool {
        let (origin, dir) = self.camera_ray(x, y);
        let here = self.radiance_along(origin, dir);
        let (right, up) = dir.any_orthonormal_pair();
        let reach = self.scene.camera.eye.as_dvec3().abs().max_element();
        ULPS.iter().any(|ulps| {
            (0..8).any(|turn| {
                let (sin, cos) = (f64::from(turn) * FRAC_PI_4).sin_cos();
                let step = (right * cos + up * sin) * (ulps * f64::from(f32::EPSILON));
                let moved = [(origin, (dir + step).normalize()), (origin + step * reach, dir)];
                let far = |there: [f64; 3]| there.iter().zip(here).any(|(a, b)| (a - b).abs() > tolerance);
                moved.iter().any(|&(origin, dir)| far(self.radiance_along(origin, dir)))
            })
        })
    }
}
