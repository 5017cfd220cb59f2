//! Mirrors and metals, which reflect light and transmit none.

use super::super::shading::Shading;
use super::super::sky::Sky;
use super::super::surface::Surface8;
use super::lobes::{Lobe, Optics};
use super::reflected;
use crate::optics::reflect;
use crate::scene::{Interface, Rgb};
use crate::simd::F32x8;

fn reflectance(interface: &Interface) -> Rgb {
    if let Interface::Mirror { reflectance, .. } = interface { *reflectance } else { Rgb::ZERO }
}

/// Shades mirrors whose reflected rays are traced.
pub(super) fn traced<O: Optics>(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        let share = shading.colours(surface, reflectance);
        let carried = O::mirror(&O::arriving(shading, surface, surface.shading));
        let dir = reflect(surface.incident, surface.shading);
        reflected::<O>(shading, surface, surface.active, dir, surface.weight.times(share), &carried, depth);
    }
}

/// Shades mirrors that look up the environment, ignoring occluders.
pub(super) fn of_environment<S: Sky>(shading: &mut Shading, surfaces: &mut [Surface8], _depth: usize) {
    let scene = shading.scene;
    for surface in surfaces {
        let share = shading.colours(surface, reflectance);
        let seen = S::radiance(&scene.environment, &scene.textures, &reflect(surface.incident, surface.shading));
        let sent = seen.times(surface.weight.times(share));
        shading.accumulator.add_radiance8(surface.active, &surface.pixel, &sent);
    }
}

/// Shades metals.
pub(super) fn conductor<O: Optics>(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        // A metal's index is relative to the medium in front of it.
        let outside = F32x8::from_fn(|k| shading.media.ior(surface.stack[k]) as f32);
        let relative = F32x8::ONE / outside;
        let eta = shading.colours(surface, |i| if let Interface::Conductor { eta, .. } = i { *eta } else { Rgb::ONE });
        let k = shading.colours(surface, |i| if let Interface::Conductor { k, .. } = i { *k } else { Rgb::ZERO });
        let cos_i = -surface.incident.dot(surface.shading);
        let before = O::arriving(shading, surface, surface.shading);
        let Lobe { share, carried } = O::metal(cos_i, eta * relative, k * relative, &before);
        let dir = reflect(surface.incident, surface.shading);
        reflected::<O>(shading, surface, surface.active, dir, surface.weight.times(share), &carried, depth);
    }
}
