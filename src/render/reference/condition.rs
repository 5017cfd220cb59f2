//! Condition of a pixel: sensitivity of its value to small changes of its camera ray.

use std::f64::consts::FRAC_PI_4;

use super::{Prepared, film_ray};

impl Prepared<'_> {
    /// Returns the smallest change of the camera ray that changes the radiance at a film point by more than `tolerance`
    /// in any channel. Tries 1, 2, 4, ... ulps of `f32`, up to `most`, and returns `None` if none of them does. The ray
    /// is moved to eight sides: its direction by so many ulps of 1, or its origin by so many ulps of the eye's largest
    /// coordinate. The point is as in [`Prepared::camera_ray`].
    ///
    /// A value that changes within a few ulps lies at an edge or magnifies rounding, so it belongs to no single ray. An
    /// `f32` renderer rounds anew at every surface. So a path of many surfaces counts as moved by a few ulps for each.
    #[must_use]
    pub fn ulps_until_moved(&self, x: f64, y: f64, tolerance: f64, most: f64) -> Option<f64> {
        let (origin, dir) = self.camera_ray(x, y);
        let film = film_ray(x, y);
        let radiance = |origin, dir| self.trace_for(film, origin, dir).radiance.to_array();
        let here = radiance(origin, dir);
        let (right, up) = dir.any_orthonormal_pair();
        let reach = self.scene.camera.eye.as_dvec3().abs().max_element();
        let steps = std::iter::successors(Some(1.0), |ulps| Some(ulps * 2.0)).take_while(|&ulps| ulps <= most);
        steps.into_iter().find(|ulps| {
            (0..8).any(|turn| {
                let (sin, cos) = (f64::from(turn) * FRAC_PI_4).sin_cos();
                let step = (right * cos + up * sin) * (ulps * f64::from(f32::EPSILON));
                let moved = [(origin, (dir + step).normalize()), (origin + step * reach, dir)];
                let far = |there: [f64; 3]| there.iter().zip(here).any(|(a, b)| (a - b).abs() > tolerance);
                moved.iter().any(|&(origin, dir)| far(radiance(origin, dir)))
            })
        })
    }
}
