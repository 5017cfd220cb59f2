//! Colour lookup by position and by direction.

use glam::{DVec2, DVec3};

use super::surface::{Surface, equirectangular};
use crate::scene::map::turned_back;
use crate::scene::{Beyond, Colour, Environment, Interface, Scene};

/// Returns the colour of a surface.
pub(super) fn on_surface(scene: &Scene, colour: &Colour, at: &Surface) -> DVec3 {
    let (point, uv) = (at.point, at.uv);
    match colour {
        Colour::Constant(rgb) => rgb.as_dvec3(),
        Colour::Image { texture, scale } => scene.textures[*texture as usize].on_surface(uv.x, uv.y) * scale.as_dvec3(),
        Colour::Corners { texture, scale } => {
            let picture = texture.map_or(DVec3::ONE, |t| scene.textures[t as usize].on_surface(uv.x, uv.y));
            at.colour * picture * scale.as_dvec3()
        }
        Colour::Checker { even, odd, size, offset } => {
            let cube = ((point - offset.as_dvec3()) / f64::from(*size)).floor();
            let parity = (cube.x + cube.y + cube.z).rem_euclid(2.0);
            if parity == 0.0 { even.as_dvec3() } else { odd.as_dvec3() }
        }
    }
}

/// Returns the share that a surface with texture coordinates `uv` covers: below 1 only for [`Interface::Alpha`].
pub(super) fn opacity(scene: &Scene, interface: &Interface, uv: DVec2) -> f64 {
    match *interface {
        Interface::Alpha { opacity, mask } => {
            f64::from(opacity) * mask.map_or(1.0, |mask| scene.textures[mask as usize].on_surface(uv.x, uv.y).x)
        }
        _ => 1.0,
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
        Environment::Map { kind, texture, scale, rotation } => {
            let dir = turned_back(dir.as_vec3(), *rotation);
            (kind.look_up(&scene.textures[*texture as usize], dir) * *scale).as_dvec3()
        }
        Environment::LatLong { texture, scale, rotation } => {
            let uv = equirectangular(dir);
            // A rotation towards +x moves the picture's columns from -x to the direction of view.
            let u = uv.x - f64::from(*rotation) / std::f64::consts::TAU;
            scene.textures[*texture as usize].lookup(u, uv.y, Beyond::Hold) * scale.as_dvec3()
        }
    }
}
