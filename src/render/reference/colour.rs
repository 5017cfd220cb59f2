//! Colour lookup by position and by direction.

use glam::{DVec2, DVec3};

use super::surface::equirectangular;
use crate::scene::{Beyond, Colour, Environment, Scene};

/// Returns the colour of a surface at `point` with texture coordinates `uv`.
pub(super) fn on_surface(scene: &Scene, colour: &Colour, point: DVec3, uv: DVec2) -> DVec3 {
    match colour {
        Colour::Constant(rgb) => rgb.as_dvec3(),
        Colour::Image { texture, scale } => {
            scene.textures[*texture as usize].lookup(uv.x, uv.y, Beyond::Repeat) * scale.as_dvec3()
        }
        Colour::Checker { even, odd, size, offset } => {
            let cube = ((point - offset.as_dvec3()) / f64::from(*size)).floor();
            let parity = (cube.x + cube.y + cube.z).rem_euclid(2.0);
            if parity == 0.0 { even.as_dvec3() } else { odd.as_dvec3() }
        }
    }
}

/// Returns the environment's radiance in the unit direction `dir`.
pub(super) fn of_environment(scene: &Scene, dir: DVec3) -> DVec3 {
    match &scene.environment {
        Environment::Constant(rgb) => rgb.as_dvec3(),
        Environment::Gradient { nadir, horizon, zenith } => {
            let end = if dir.y < 0.0 { nadir } else { zenith };
            horizon.as_dvec3().lerp(end.as_dvec3(), dir.y.abs())
        }
        Environment::LatLong { texture, scale, rotation } => {
            let uv = equirectangular(dir);
            // A rotation towards +x moves the picture's columns from -x to the direction of view.
            let u = uv.x - f64::from(*rotation) / std::f64::consts::TAU;
            scene.textures[*texture as usize].lookup(u, uv.y, Beyond::Hold) * scale.as_dvec3()
        }
    }
}
