//! Surfaces too thin to bend light: panes, coats, and covers with holes.

use super::super::shading::Shading;
use super::super::surface::Surface8;
use super::lobes::{Lobe, Lobes, Optics};
use super::{WHITE, gather_boundaries, reflected, straight_on};
use crate::optics::{Boundary, Crossing, reflect};
use crate::scene::{Interface, Rgb};
use crate::simd::{F32x8, Vec3x8};

/// Shades panes; both faces count as one surface.
pub(super) fn thin<O: Optics>(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        let before = O::arriving(shading, surface, surface.shading);
        let (boundary, at) = face(shading, surface);
        let Lobes { reflection, transmission } = O::pane(shading, surface, &boundary, &at, &before);
        let tint =
            shading.colours(surface, |i| if let Interface::ThinDielectric { tint, .. } = i { *tint } else { Rgb::ONE });
        let dir = reflect(surface.incident, surface.shading);
        let weight = surface.weight.times(reflection.share);
        reflected::<O>(shading, surface, surface.active, dir, weight, &reflection.carried, depth);
        let weight = surface.weight.times(transmission.share).times(tint);
        straight_on::<O>(shading, surface, surface.active, weight, &transmission.carried, depth);
    }
}

/// Shades coats. Light that a coat does not reflect reaches the base.
pub(super) fn coated<O: Optics>(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        let before = O::arriving(shading, surface, surface.shading);
        let (boundary, at) = face(shading, surface);
        let Lobe { share, carried } = O::coat(&boundary, &at, &before);
        surface.base_weight = surface.weight.times(WHITE - share);
        let dir = reflect(surface.incident, surface.shading);
        reflected::<O>(shading, surface, surface.active, dir, surface.weight.times(share), &carried, depth);
    }
}

/// Shades covers with holes.
pub(super) fn alpha<O: Optics>(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        let mut opacity = Vec3x8::splat(Rgb::ONE);
        for k in 0..8 {
            opacity.set_lane(k, Rgb::splat(surface.opacity(shading.scene, k)));
        }
        surface.base_weight = surface.weight.times(opacity);
        let before = O::arriving(shading, surface, surface.shading);
        straight_on::<O>(shading, surface, surface.active, surface.weight.times(WHITE - opacity), &before, depth);
    }
}

/// Returns the boundary from the ray's medium into the coat or pane, and the crossing of the ray.
#[inline(always)]
fn face(shading: &Shading, surface: &Surface8) -> (Boundary<F32x8>, Crossing<F32x8>) {
    let boundary = gather_boundaries(|k| match *shading.interface(surface, k) {
        Interface::Coated { ior } | Interface::ThinDielectric { ior, .. } => {
            Boundary::new(shading.media.ior(surface.stack[k]), f64::from(ior))
        }
        _ => Boundary::new(1.0, 1.0),
    });
    let at = boundary.cross(-surface.incident.dot(surface.shading));
    (boundary, at)
}
