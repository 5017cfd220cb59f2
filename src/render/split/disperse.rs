//! Dispersion: white light at boundaries of dispersive media, where each wavelength is refracted by itself.

use super::super::media::{FanId, StackId};
use super::super::shading::Shading;
use super::super::surface::Surface8;
use super::dielectric::{Refraction, refracted, ruled, tints};
use super::lobes::Unpolarised;
use super::{WHITE, gather_boundaries, lane_bits, reflected};
use crate::math::Real;
use crate::optics::{Boundary, FresnelFormula, RefractionFormula, SEPARATION, reflect};
use crate::scene::Rgb;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Splits the white rays in `lanes` into wavelengths where the refracted directions separate, given the fans of the
/// boundaries. The reflected part stays one white ray. Returns the lanes that were split, which are then complete.
pub(super) fn disperse<F: FresnelFormula, R: RefractionFormula>(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    fans: &[Option<FanId>; 8],
    formula: &R,
    depth: usize,
) -> u8 {
    if lanes & lane_bits(|k| fans[k].is_some()) == 0 {
        return 0;
    }
    let lanes = lanes & apart(shading, surface, fans);
    if lanes == 0 {
        return 0;
    }
    let cos_i = -surface.incident.dot(surface.shading);
    let tint = tints(shading, surface);
    let mut together = Vec3x8::splat(Rgb::ZERO);
    for k in 0..shading.media.bands() {
        let bands: [_; 8] = std::array::from_fn(|l| fans[l].map(|fan| shading.media.known_fan(fan).bands[k]));
        let boundary = gather_boundaries(|l| bands[l].map_or(Boundary::new(1.0, 1.0), |b| b.boundary));
        let band = Vec3x8::splat(shading.media.band_weight(k));
        let at = boundary.cross(cos_i);
        let share = ruled(shading, surface, Vec3x8::all(F::dielectric(&boundary, &at)), at.total);
        together = together + share.times(band);
        let refracting = lanes & !at.total.bits();
        if refracting != 0 {
            let weight = surface.weight.times((WHITE - share).times(band).times(tint));
            let beyond = bands.map(|b| b.map_or(StackId::default(), |b| b.beyond));
            let light = Refraction { boundary, at, weight, beyond };
            refracted::<Unpolarised<F>, R>(shading, surface, refracting, &light, &(), formula, depth);
        }
    }
    let dir = reflect(surface.incident, surface.shading);
    reflected::<Unpolarised<F>>(shading, surface, lanes, dir, surface.weight.times(together), &(), depth);
    lanes
}

/// Returns the lanes whose outermost wavelengths separate. They separate if their directions differ by more than
/// [`SEPARATION`] by the law of refraction, whichever formula bends the rays, or if only one of them is totally
/// reflected.
fn apart(shading: &mut Shading, surface: &Surface8, fans: &[Option<FanId>; 8]) -> u8 {
    for &fan in fans.iter().flatten() {
        shading.media.learn_fan(fan);
    }
    let cos_i = -surface.incident.dot(surface.shading);
    let [(first, first_total), (last, last_total)] = [0, 1].map(|end| {
        let boundary = gather_boundaries(|lane| {
            fans[lane].map_or(Boundary::new(1.0, 1.0), |fan| {
                let fan = shading.media.known_fan(fan);
                fan.bands[fan.outermost[end]].boundary
            })
        });
        let at = boundary.cross(cos_i);
        (boundary.refract(surface.incident, surface.shading, &at), at.total)
    });
    let far = (first - last).length_squared().gt(F32x8::splat(SEPARATION * SEPARATION));
    let one_total = (first_total | last_total) & !(first_total & last_total);
    let has_fan = Mask8::from_bits(lane_bits(|lane| fans[lane].is_some()));
    (((far & !first_total & !last_total) | one_total) & has_fan).bits()
}
