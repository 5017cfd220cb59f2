//! Shadow rays that pass straight through transmissive surfaces.

use super::media::StackId;
use super::queue::{Chunk, Rgb8};
use super::shading::Shading;
use super::split::{Optics, OpticsVisitor, dispatch, gather_boundaries};
use super::surface::{HitRef, Surface8};
use crate::geometry::Hit8;
use crate::optics::{Boundary, FresnelModel};
use crate::scene::{FresnelRule, Interface, Rgb};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Function that weakens shadow rays at the transmissive surfaces they hit, and restarts them behind.
pub type PassStage = fn(&mut Shading, &mut Chunk, &[Hit8], &[HitRef], &[Surface8]);

/// Function that applies absorption between the last surface and the light, for some lanes of a packet.
pub type FinishStage = fn(&Shading, &mut Chunk, usize, u8);

/// Picks the pass stage for a Fresnel formula, with or without absorption. The variant for touching surfaces always
/// absorbs.
#[must_use]
pub fn pick(model: FresnelModel, absorbing: bool, touching: bool) -> PassStage {
    struct Pick {
        absorbing: bool,
        touching: bool,
    }
    impl OpticsVisitor for Pick {
        type Output = PassStage;
        fn visit<O: Optics>(self) -> PassStage {
            match (self.absorbing, self.touching) {
                (_, true) => pass::<O, true, true>,
                (true, false) => pass::<O, true, false>,
                (false, false) => pass::<O, false, false>,
            }
        }
    }
    dispatch(model, Pick { absorbing, touching })
}

/// Applies absorption on the last segment, where media absorb.
pub fn finish(shading: &Shading, chunk: &mut Chunk, packet: usize, lanes: u8) {
    let state = &mut chunk.states[packet];
    let t = chunk.rays[packet].t_max + state.lead;
    if let Some(left) = shading.absorbed(lanes, &state.stack, t) {
        state.weight = state.weight.times(left);
    }
}

fn pass<O: Optics, const ABSORBING: bool, const TOUCHING: bool>(
    shading: &mut Shading,
    chunk: &mut Chunk,
    hits: &[Hit8],
    refs: &[HitRef],
    surfaces: &[Surface8],
) {
    for (refs, surface) in refs.chunks(8).zip(surfaces) {
        let t = F32x8::from_fn(|k| refs.get(k).map_or(0.0, |&r| hits[r as usize >> 3].t.lane(r as usize & 7)));
        let mut weight = surface.weight;
        if ABSORBING {
            let lead = F32x8::from_fn(|k| {
                refs.get(k).map_or(0.0, |&r| chunk.states[r as usize >> 3].lead.lane(r as usize & 7))
            });
            if let Some(left) = shading.absorbed(surface.active, &surface.stack, t + lead) {
                weight = weight.times(left);
            }
        }
        let mut beyond = surface.stack;
        let before = O::arriving(shading, surface, surface.normal);
        let (passed, carried) = passed::<O, TOUCHING>(shading, surface, &mut beyond, &before);
        weight = weight.times(passed);
        let extra = O::leaving(&carried, surface.incident);
        let origin = surface.below();
        let lead = surface.lead(surface.incident);
        for (k, &r) in refs.iter().enumerate() {
            let (packet, lane) = (r as usize >> 3, r as usize & 7);
            let ray = &mut chunk.rays[packet];
            let state = &mut chunk.states[packet];
            let rest = ray.t_max.lane(lane) - t.lane(k) - lead.lane(k);
            ray.origin.set_lane(lane, origin.lane(k));
            ray.t_max.set_lane(lane, rest);
            state.weight.set_lane(lane, weight.lane(k));
            state.stack[lane] = beyond[k];
            if TOUCHING {
                state.passes[lane] = surface.onward[k];
            }
            state.lead.set_lane(lane, lead.lane(k));
            if let Some(extra) = &extra {
                chunk.extras[packet].put(lane, extra, k);
            }
            if weight.lane(k) == Rgb::ZERO {
                ray.active &= !(1 << lane);
            }
        }
    }
}

/// Returns the share that each of eight transmissive surfaces transmits without bending; sets the media `beyond`.
#[inline(always)]
fn passed<O: Optics, const TOUCHING: bool>(
    shading: &mut Shading,
    surface: &Surface8,
    beyond: &mut [StackId; 8],
    before: &O::Carried,
) -> (Rgb8, O::Carried) {
    let mut boundaries = [Boundary::<f32>::new(1.0, 1.0); 8];
    let mut tint = Vec3x8::splat(Rgb::ONE);
    let mut fixed = Vec3x8::splat(Rgb::ZERO);
    let (mut by_rule, mut thin) = (0_u8, 0_u8);
    for k in 0..8 {
        match *shading.interface(surface, k) {
            Interface::Dielectric { rule, tint: colour, .. } => {
                let crossed = if TOUCHING { shading.shadow_arrivals.crossed(surface, k) } else { None };
                let body = shading.media.body_of(surface.hit[k].geometry).unwrap_or(0);
                let crossing = match crossed {
                    Some(crossed) => shading.media.cross_all(surface.stack[k], crossed),
                    None => shading.media.cross(surface.stack[k], body, surface.front.lane(k)),
                };
                beyond[k] = crossing.beyond;
                if crossing.unmatched && surface.active >> k & 1 != 0 {
                    shading.unmatched_exits.add(surface.hit[k].geometry);
                }
                if crossing.real {
                    boundaries[k] = crossing.thin_side;
                    tint.set_lane(k, colour);
                    if let FresnelRule::Fixed(share) = rule {
                        by_rule |= 1 << k;
                        fixed.set_lane(k, share);
                    }
                }
            }
            Interface::ThinDielectric { ior, rule, tint: colour } => {
                boundaries[k] = Boundary::new(shading.media.ior(surface.stack[k]), f64::from(ior));
                thin |= 1 << k;
                tint.set_lane(k, colour);
                if let FresnelRule::Fixed(share) = rule {
                    by_rule |= 1 << k;
                    fixed.set_lane(k, share);
                }
            }
            Interface::Alpha { .. } => tint.set_lane(k, Rgb::splat(1.0 - surface.opacity(shading.scene, k))),
            Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => {
                tint.set_lane(k, Rgb::ZERO);
            }
        }
    }
    let boundary = gather_boundaries(|k| boundaries[k]);
    let cos_i = -surface.incident.dot(surface.normal);
    let at = boundary.cross(cos_i);
    let rule = (Mask8::from_bits(by_rule), fixed);
    let reflected = O::through(&boundary, &at, Mask8::from_bits(thin), rule, before);
    ((Vec3x8::splat(Rgb::ONE) - reflected.share).times(tint), reflected.carried)
}
