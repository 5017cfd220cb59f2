//! Boundaries of transparent solids and liquids: reflection and refraction.

use std::marker::PhantomData;

use super::super::bodies::{Entering, LookedUp};
use super::super::limit::Limit;
use super::super::media::{FanId, StackId, Transition};
use super::super::outcome::RayKind;
use super::super::queue::{Rgb8, Spawn8};
use super::super::shading::Shading;
use super::super::surface::Surface8;
use super::disperse::disperse;
use super::lobes::{Lobes, Optics};
use super::{SplitStage, gather_boundaries, lane_bits, reflected};
use crate::choice::Choice as _;
use crate::math::Real;
use crate::optics::{
    Boundary, Crossing, Refracted, RefractionFormula, RefractionModel, RefractionVisitor, Stable, below_surface,
    reflect,
};
use crate::scene::{FresnelRule, Interface, MOST_PASSES, Rgb};
use crate::simd::{F32x8, Mask8, Vec3x8, set_lanes};

/// Picks the stage for a refraction formula. The variant for touching surfaces also handles dispersion, by looking up
/// at run time whether media disperse.
#[must_use]
pub(super) fn pick<O: Optics>(model: RefractionModel, dispersing: bool, touching: bool) -> SplitStage {
    struct Pick<O> {
        dispersing: bool,
        touching: bool,
        optics: PhantomData<O>,
    }
    impl<O: Optics> RefractionVisitor for Pick<O> {
        type Output = SplitStage;
        fn visit<R: RefractionFormula>(self, _formula: R) -> SplitStage {
            match (self.dispersing, self.touching) {
                (_, true) => split::<O, R, true, true>,
                (true, false) => split::<O, R, true, false>,
                (false, false) => split::<O, R, false, false>,
            }
        }
    }
    model.dispatch(Pick::<O> { dispersing, touching, optics: PhantomData })
}

fn split<O: Optics, R: RefractionFormula, const DISPERSING: bool, const TOUCHING: bool>(
    shading: &mut Shading,
    surfaces: &mut [Surface8],
    depth: usize,
) {
    let formula = R::with_constant(shading.refraction.number().map(|(constant, _)| constant));
    let total_is_lost = shading.total_is_lost;
    for surface in surfaces {
        let Entered { boundary, beyond, fans } = enter::<TOUCHING>(shading, surface, depth);
        let mut lanes = surface.base_lanes;
        if DISPERSING {
            lanes &= !disperse::<O::Formula, R>(shading, surface, lanes, &fans, &formula, depth);
        }
        if lanes == 0 {
            continue;
        }
        let at = boundary.cross(-surface.incident.dot(surface.shading));
        let lanes = if total_is_lost { lose(shading, surface, lanes & at.total.bits(), lanes) } else { lanes };
        let before = O::arriving(shading, surface, surface.shading);
        let Lobes { reflection, transmission } = O::boundary(shading, surface, &boundary, &at, &before);

        let dir = reflect(surface.incident, surface.shading);
        reflected::<O>(
            shading,
            surface,
            lanes,
            dir,
            surface.weight.times(reflection.share),
            &reflection.carried,
            depth,
        );

        let refracting = lanes & !at.total.bits();
        if refracting != 0 {
            let weight = surface.weight.times(transmission.share).times(tints(shading, surface));
            let light = Refraction { boundary, at, weight, beyond };
            refracted::<O, R>(shading, surface, refracting, &light, &transmission.carried, &formula, depth);
        }
    }
}

/// Light that crosses a boundary.
pub(super) struct Refraction {
    pub boundary: Boundary<F32x8>,
    pub at: Crossing<F32x8>,
    pub weight: Rgb8,
    /// Media beyond the boundary.
    pub beyond: [StackId; 8],
}

/// Emits refracted rays.
#[inline(always)]
pub(super) fn refracted<O: Optics, R: RefractionFormula>(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    light: &Refraction,
    carried: &O::Carried,
    formula: &R,
    depth: usize,
) {
    let Refraction { boundary, at, weight, beyond } = light;
    let Refracted { mut direction, mut total } = formula.refract(boundary, surface.incident, surface.shading, at);
    if R::FLAT_ONLY {
        // Only what lies behind a plane is raised as a whole.
        let flat = Mask8::from_bits(shading.flat(surface, lanes));
        let bent = Stable.refract(boundary, surface.incident, surface.shading, at);
        direction = Vec3x8::select(flat, direction, bent.direction);
        total |= bent.total & !flat;
    }
    let dir = direction.normalized();
    let dir = Vec3x8::select(surface.interpolated, below_surface(dir, surface.normal), dir);
    // Light that is not bent keeps its direction to the bit.
    let straight = boundary.kc.eq(F32x8::ZERO);
    let dir = Vec3x8::select(straight, surface.incident, dir);
    // A formula may fail to give a direction where one exists; the ray's weight is then truncated.
    let lost = total.bits() & !straight.bits() & lanes;
    shading.accumulator.add_ended8(Limit::Asked, lost, &surface.pixel, weight);
    let lanes = lanes & !lost;
    let lanes = if R::MAPPED { in_maps(shading, surface, lanes, &dir, light) } else { lanes };
    let extra = O::leaving(carried, dir);
    let new = Spawn8 { stack: beyond, extra: extra.as_ref(), ..surface.transmitted(dir, *weight) };
    shading.spawn(lanes, &new, RayKind::Transmitted, depth);
}

/// Looks light up that enters bodies with a map. Returns the other lanes.
#[inline(never)]
fn in_maps(shading: &mut Shading, surface: &Surface8, lanes: u8, dir: &Vec3x8, light: &Refraction) -> u8 {
    let Some(bodies) = shading.bodies else { return lanes };
    let Refraction { boundary, weight, .. } = light;
    let entering = Entering { surface, lanes, dir: *dir, weight, eta: boundary.eta };
    let LookedUp { radiance, ended, left } = {
        let scratch = shading.own_scratch.get_or_insert_default();
        bodies.look_up(shading.scene, shading.proxy, &entering, scratch)
    };
    shading.accumulator.add_radiance8(lanes & !left, &surface.pixel, &radiance);
    shading.accumulator.add_ended8(Limit::Asked, lanes & !left, &surface.pixel, &ended);
    shading.without_body_map += u64::from(left.count_ones());
    left
}

/// Gathers the tints of the dielectric surfaces.
#[inline(always)]
pub(super) fn tints(shading: &Shading, surface: &Surface8) -> Rgb8 {
    shading.colours(surface, |i| if let Interface::Dielectric { tint, .. } = i { *tint } else { Rgb::ONE })
}

/// Boundaries that eight rays cross.
struct Entered {
    boundary: Boundary<F32x8>,
    /// Media beyond.
    beyond: [StackId; 8],
    /// Fans of the wavelengths of white light.
    fans: [Option<FanId>; 8],
}

/// Ends the rays of the lanes `lost`, and returns the other lanes of `all`.
#[cold]
fn lose(shading: &mut Shading, surface: &Surface8, lost: u8, all: u8) -> u8 {
    shading.accumulator.add_ended8(Limit::Asked, lost, &surface.pixel, &surface.weight);
    all & !lost
}

/// Looks up the boundary of each lane and the media beyond. Rays at surfaces that are no boundary pass on; the other
/// lanes are left in `base_lanes`.
#[inline(always)]
fn enter<const TOUCHING: bool>(shading: &mut Shading, surface: &mut Surface8, depth: usize) -> Entered {
    let mut transitions = [None::<Transition>; 8];
    for (k, slot) in transitions.iter_mut().enumerate() {
        let crossing = if TOUCHING {
            shading.transition(surface, k)
        } else {
            let body = shading.media.body_of(surface.hit[k].geometry);
            body.map(|body| shading.media.cross(surface.stack[k], body, surface.front.lane(k)))
        };
        if let Some(crossing) = crossing {
            if crossing.unmatched && surface.active >> k & 1 != 0 {
                shading.unmatched_exits.add(surface.hit[k].geometry);
            }
            *slot = Some(crossing);
        }
    }
    let beyond = transitions.map(|t| t.map_or(StackId::default(), |t| t.beyond));
    let real = lane_bits(|k| transitions[k].is_some_and(|t| t.real));
    surface.base_lanes = surface.active & real;
    let absent = surface.active & !real;
    if absent != 0 {
        pass::<TOUCHING>(shading, surface, absent, &beyond, depth);
    }
    let boundary = gather_boundaries(|k| transitions[k].map_or(Boundary::new(1.0, 1.0), |t| t.boundary));
    Entered { boundary, beyond, fans: transitions.map(|t| t.and_then(|t| t.fan)) }
}

/// Passes rays straight through surfaces that are no boundary, at the same depth and weight.
fn pass<const TOUCHING: bool>(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    beyond: &[StackId; 8],
    depth: usize,
) {
    let passes = surface.passes.map(|n| n + 1);
    let spent = lane_bits(|k| passes[k] > MOST_PASSES) & lanes;
    shading.accumulator.add_ended8(Limit::Passes, spent, &surface.pixel, &surface.weight);
    let mut counts = passes;
    if TOUCHING {
        for lane in set_lanes(lanes & !spent) {
            counts[lane] = shading.touching.count_passes(surface.onward[lane], passes[lane]);
        }
    }
    let extra = shading.extra(surface);
    let ahead = surface.transmitted(surface.incident, surface.weight);
    let new = Spawn8 { stack: beyond, passes: &counts, extra: extra.as_ref(), ..ahead };
    shading.queue(RayKind::Transmitted, depth).push8(lanes & !spent, &new);
}

/// Returns the reflected share by each lane's rule: `fresnel`, or a fixed share unless reflection is total.
#[inline(always)]
pub(super) fn ruled(shading: &Shading, surface: &Surface8, fresnel: Rgb8, total: Mask8) -> Rgb8 {
    let (fixed, share) = fixed_shares(shading, surface, fresnel);
    Vec3x8::select(fixed & !total, share, fresnel)
}

/// Returns the lanes with a fixed share, and the shares of all lanes: fixed, or else `fresnel`.
#[inline(always)]
pub(super) fn fixed_shares(shading: &Shading, surface: &Surface8, fresnel: Rgb8) -> (Mask8, Rgb8) {
    let mut fixed = 0;
    let mut share = fresnel;
    for k in 0..8 {
        if let Interface::Dielectric { rule: FresnelRule::Fixed(colour), .. }
        | Interface::ThinDielectric { rule: FresnelRule::Fixed(colour), .. } = *shading.interface(surface, k)
        {
            fixed |= 1 << k;
            share.set_lane(k, colour);
        }
    }
    (Mask8::from_bits(fixed), share)
}
