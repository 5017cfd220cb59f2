//! Camera rays of the `f64` renderer.

use glam::DVec3;

use crate::scene::{Camera, Projection, Settings};

/// Returns origin and unit direction of the ray through column `x` and row `y` of the film. Both are in pixels from the
/// upper left corner, so pixel (i, j) is centred at (i + 0.5, j + 0.5).
pub(super) fn ray(camera: &Camera, settings: &Settings, x: f64, y: f64) -> (DVec3, DVec3) {
    let eye = camera.eye.as_dvec3();
    let [right, up, forward] = camera.frame();
    let (width, height) = (f64::from(settings.width), f64::from(settings.height));
    // From -1 to 1 over the picture's height; pixels are square.
    let across = (2.0 * x - width) / height;
    let above = 1.0 - 2.0 * y / height;
    match camera.projection {
        Projection::Pinhole { vfov } => {
            let reach = (0.5 * f64::from(vfov).to_radians()).tan();
            (eye, (forward + right * (across * reach) + up * (above * reach)).normalize())
        }
        Projection::Map(kind) => {
            let dir = kind.direction(x, y, settings.height);
            (eye, (right * dir.x + up * dir.y - forward * dir.z).normalize())
        }
        Projection::Orthographic { height } => {
            let half = 0.5 * f64::from(height);
            (eye + right * (across * half) + up * (above * half), forward)
        }
    }
}
