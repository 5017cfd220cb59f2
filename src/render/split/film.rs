//! What is too thin to bend light: panes, coats, and covers with holes.

use super::super::shading::Shading;
use super::super::surface::Surface8;
use super::dielectric::ruled;
use super::{WHITE, gather_boundaries, reflected, straight_on};
use crate::optics::{Boundary, FresnelFormula, reflect, thin_reflectance};
use crate::scene::{Interface, Rgb};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Panes: both faces at once.
pub(super) fn thin<F: FresnelFormula>(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        let (face, total) = face_reflectance::<F>(shading, surface);
        let share = ruled(shading, surface, Vec3x8::all(thin_reflectance(face)), total);
        let tint =
            shading.colours(surface, |i| if let Interface::ThinDielectric { tint, .. } = i { *tint } else { Rgb::ONE });
        let dir = reflect(surface.incident, surface.shading);
        reflected(shading, surface, surface.active, dir, surface.weight.times(share), depth);
        let weight = surface.weight.times(WHITE - share).times(tint);
        straight_on(shading, surface, surface.active, weight, depth);
    }
}

/// Coats: what they do not reflect reaches the base.
pub(super) fn coated<F: FresnelFormula>(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        let share = Vec3x8::all(face_reflectance::<F>(shading, surface).0);
        surface.base_weight = surface.weight.times(WHITE - share);
        let dir = reflect(surface.incident, surface.shading);
        reflected(shading, surface, surface.active, dir, surface.weight.times(share), depth);
    }
}

/// Covers with holes.
pub(super) fn alpha(shading: &mut Shading, surfaces: &mut [Surface8], depth: usize) {
    for surface in surfaces {
        let opacity =
            shading.colours(surface, |i| Rgb::splat(if let Interface::Alpha { opacity } = i { *opacity } else { 1.0 }));
        surface.base_weight = surface.weight.times(opacity);
        straight_on(shading, surface, surface.active, surface.weight.times(WHITE - opacity), depth);
    }
}

/// Fresnel reflectance of one face of coats and panes, from the medium the ray is in, and where it is total.
#[inline(always)]
fn face_reflectance<F: FresnelFormula>(shading: &Shading, surface: &Surface8) -> (F32x8, Mask8) {
    let boundary = gather_boundaries(|k| match *shading.interface(surface, k) {
        Interface::Coated { ior } | Interface::ThinDielectric { ior, .. } => {
            Boundary::new(shading.media.ior(surface.stack[k]), f64::from(ior))
        }
        _ => Boundary::new(1.0, 1.0),
    });
    let at = boundary.cross(-surface.incident.dot(surface.shading));
    (F::dielectric(&boundary, &at), at.total)
}
