//! Light stage for lamps without extent: direct light on a stream of surfaces, and its shadow rays.

use glam::Vec3;

use super::base::Base8;
use super::queue::Spawn8;
use super::shading::Shading;
use super::surface::Surface8;
use crate::math::Real;
use crate::optics::reflect;
use crate::scene::{Falloff, Light, LightKind};
use crate::simd::{F32x8, Vec3x8};

/// Function that adds the light with the given scene index to surfaces with these bases. Where the light casts shadows,
/// it queues shadow rays weighted by the unoccluded light. Otherwise it adds the light to the pixels.
pub type LightStage = fn(&mut Shading, usize, &[Surface8], &[Base8]);

/// Picks the stage of a light; `shiny` says that some surfaces have highlights. Returns `None` for an area lamp.
#[must_use]
pub fn pick(light: &Light, shiny: bool, shadows: bool) -> Option<LightStage> {
    match light.kind {
        LightKind::Point { .. } => Some(pick_for::<FromPoint>(light.falloff, shiny, shadows)),
        LightKind::Spot { .. } => Some(pick_for::<FromSpot>(light.falloff, shiny, shadows)),
        LightKind::Directional { .. } => Some(pick_for::<FromAfar>(light.falloff, shiny, shadows)),
        LightKind::Sphere { .. } | LightKind::Rectangle { .. } => None,
    }
}

fn pick_for<S: Source>(falloff: Falloff, shiny: bool, shadows: bool) -> LightStage {
    match (falloff == Falloff::InverseSquare, shiny, shadows) {
        (false, false, false) => shine::<S, false, false, false>,
        (false, false, true) => shine::<S, false, false, true>,
        (false, true, false) => shine::<S, false, true, false>,
        (false, true, true) => shine::<S, false, true, true>,
        (true, false, false) => shine::<S, true, false, false>,
        (true, false, true) => shine::<S, true, false, true>,
        (true, true, false) => shine::<S, true, true, false>,
        (true, true, true) => shine::<S, true, true, true>,
    }
}

fn shine<S: Source, const PHYSICAL: bool, const SHINY: bool, const SHADOWS: bool>(
    shading: &mut Shading,
    light: usize,
    surfaces: &[Surface8],
    bases: &[Base8],
) {
    let light = &shading.scene.lights[light];
    let Some(source) = S::of(light) else { return };
    let intensity = Vec3x8::splat(light.intensity);
    let casts = light.shadows;
    for (surface, base) in surfaces.iter().zip(bases) {
        if !base.lit {
            continue;
        }
        let origin = surface.above();
        let (dir, distance, factor) = source.arrive::<PHYSICAL>(origin);
        let cos = dir.dot(surface.shading);
        // The light must lie on the viewer's side of both normals: smooth normals must not let light through the
        // surface.
        let facing = cos.gt(F32x8::ZERO) & dir.dot(surface.normal).gt(F32x8::ZERO);
        let lit = facing.bits() & surface.base_lanes;
        if lit == 0 {
            continue;
        }
        let lambert = if PHYSICAL { cos * F32x8::splat(std::f64::consts::FRAC_1_PI) } else { cos };
        let mut sent = base.diffuse * lambert;
        if SHINY {
            let bright = sent + base.highlight * lobe(base, surface, dir);
            sent = Vec3x8::select(base.shiny, bright, sent);
        }
        let arriving = factor.map_or(intensity, |factor| intensity * factor);
        let sent = sent.times(arriving).times(surface.base_weight);
        if !(SHADOWS && casts) {
            shading.accumulator.add_light8(lit, &surface.pixel, &sent);
            continue;
        }
        let dark = sent.x.eq(F32x8::ZERO) & sent.y.eq(F32x8::ZERO) & sent.z.eq(F32x8::ZERO);
        let admits = shading.shadow_admits;
        let new = Spawn8 { origin, t_max: distance, admits, ..surface.reflected(dir, sent) };
        shading.shadows.push8(lit & !dark.bits(), &new);
    }
}

/// Evaluates the highlight lobe, a cosine raised to the exponent, for unit directions to the light.
#[inline(always)]
pub(super) fn lobe(base: &Base8, surface: &Surface8, to_light: Vec3x8) -> F32x8 {
    let phong = -reflect(-to_light, surface.shading).dot(surface.incident);
    let blinn = (to_light - surface.incident).normalized().dot(surface.shading);
    let cos = Real::select(base.blinn, blinn, phong).max(F32x8::ZERO).min(F32x8::ONE);
    Real::pow(cos, base.exponent)
}

/// Kind of light without extent.
trait Source: Sized + 'static {
    /// Returns the source if the light is of this kind.
    fn of(light: &Light) -> Option<Self>;

    /// Returns unit directions from `origin` to the light, distances, and the share of its intensity that arrives
    /// unoccluded on a facing surface. `None` stands for a share of 1. The factor 1/pi belongs to the surface.
    fn arrive<const PHYSICAL: bool>(&self, origin: Vec3x8) -> (Vec3x8, F32x8, Option<F32x8>);
}

struct FromPoint {
    position: Vec3,
}

struct FromSpot {
    position: Vec3,
    direction: Vec3,
    cos_inner: f32,
    cos_outer: f32,
}

struct FromAfar {
    towards: Vec3,
}

impl Source for FromPoint {
    fn of(light: &Light) -> Option<Self> {
        if let LightKind::Point { position } = light.kind { Some(Self { position }) } else { None }
    }

    #[inline(always)]
    fn arrive<const PHYSICAL: bool>(&self, origin: Vec3x8) -> (Vec3x8, F32x8, Option<F32x8>) {
        let (dir, distance) = towards(self.position, origin);
        (dir, distance, PHYSICAL.then(|| weakening(distance)))
    }
}

impl Source for FromSpot {
    fn of(light: &Light) -> Option<Self> {
        let LightKind::Spot { position, direction, cos_inner, cos_outer } = light.kind else { return None };
        Some(Self { position, direction, cos_inner, cos_outer })
    }

    #[inline(always)]
    fn arrive<const PHYSICAL: bool>(&self, origin: Vec3x8) -> (Vec3x8, F32x8, Option<F32x8>) {
        let (dir, distance) = towards(self.position, origin);
        let cos = -dir.dot(Vec3x8::splat(self.direction));
        let cone = cone(cos, self.cos_inner, self.cos_outer);
        (dir, distance, Some(if PHYSICAL { weakening(distance) * cone } else { cone }))
    }
}

impl Source for FromAfar {
    fn of(light: &Light) -> Option<Self> {
        if let LightKind::Directional { direction } = light.kind { Some(Self { towards: -direction }) } else { None }
    }

    #[inline(always)]
    fn arrive<const PHYSICAL: bool>(&self, _origin: Vec3x8) -> (Vec3x8, F32x8, Option<F32x8>) {
        (Vec3x8::splat(self.towards), F32x8::INFINITY, None)
    }
}

/// Returns unit directions and distances to a point. At the point itself the direction is NaN, every comparison with it
/// is false, and the surface stays unlit.
#[inline(always)]
fn towards(position: Vec3, origin: Vec3x8) -> (Vec3x8, F32x8) {
    let way = Vec3x8::splat(position) - origin;
    let distance = way.length();
    (way * (F32x8::ONE / distance), distance)
}

#[inline(always)]
fn weakening(distance: F32x8) -> F32x8 {
    F32x8::ONE / (distance * distance)
}

/// Returns the spot light's factor: 1 inside the inner cone, 0 outside the outer one, and a smooth step between.
#[inline(always)]
fn cone(cos: F32x8, cos_inner: f32, cos_outer: f32) -> F32x8 {
    let inside = cos.ge(F32x8::from(cos_inner));
    let s = (cos - F32x8::from(cos_outer)) / F32x8::from(cos_inner - cos_outer);
    let s = s.max(F32x8::ZERO).min(F32x8::ONE);
    let step = s * s * (F32x8::from(3.0) - (s + s));
    Real::select(inside, F32x8::ONE, Real::select(cos.le(F32x8::from(cos_outer)), F32x8::ZERO, step))
}

/// Returns the factor of a spot light as [`cone`] does, for one number of any precision.
pub(super) fn within_cone<R: Real<Mask = bool>>(cos: R, inner: R, outer: R) -> R {
    if cos.ge(inner) {
        return R::one();
    }
    if cos.le(outer) {
        return R::zero();
    }
    let s = (cos - outer) / (inner - outer);
    s * s * (R::splat(3.0) - (s + s))
}
