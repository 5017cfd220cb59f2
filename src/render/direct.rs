//! The base of a surface: what it emits, its ambient share, and what lights add; with the shadow rays that decide.

use glam::Vec3;

use super::accumulate::Accumulator;
use super::lookup::{Edge, bilinear, checker_is_even};
use super::queue::{Queue, Rgb8, Spawn8};
use super::surface::Surface8;
use crate::geometry::GeometryMask;
use crate::math::Real;
use crate::optics::reflect;
use crate::scene::{Colour, Falloff, HighlightModel, Light, LightKind, Material, Scene};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Eight bases, gathered from their materials.
struct Base8 {
    diffuse: Rgb8,
    highlight: Rgb8,
    exponent: F32x8,
    /// Lanes whose highlight is Blinn's rather than Phong's.
    blinn: Mask8,
    /// What needs no light: emission and the ambient share.
    glow: Rgb8,
    lit: bool,
    shiny: bool,
}

/// Whether a material sends anything but secondary rays.
#[must_use]
pub fn has_base(material: &Material) -> bool {
    material.diffuse != Colour::Constant(Vec3::ZERO)
        || material.highlight.is_some()
        || material.emission != Vec3::ZERO
        || material.ambient != Vec3::ZERO
}

/// Adds the base of the surfaces in `lanes`, each times `share`, to their pixels: at once what needs no shadow ray, and
/// the rest to `shadows`, whose weights are what arrives if nothing is in the way.
pub fn shade_base(
    scene: &Scene,
    surface: &Surface8,
    lanes: u8,
    share: Rgb8,
    accumulator: &mut Accumulator,
    shadows: &mut Queue,
    admits: GeometryMask,
) {
    let base = Base8::gather(scene, surface);
    let weight = surface.weight.times(share);
    accumulator.add_radiance8(lanes, &surface.pixel, &base.glow.times(weight));
    if !base.lit {
        return;
    }
    let origin = surface.above();
    for light in &scene.lights {
        let (dir, distance, arriving) = arrive(light, origin);
        let cos = dir.dot(surface.shading);
        // On the viewer's side of both normals: smooth normals must not let light through the surface.
        let facing = cos.gt(F32x8::ZERO) & dir.dot(surface.normal).gt(F32x8::ZERO);
        let lit = facing.bits() & lanes;
        if lit == 0 {
            continue;
        }
        let lambert = match light.falloff {
            Falloff::InverseSquare => cos * F32x8::splat(std::f64::consts::FRAC_1_PI),
            Falloff::None => cos,
        };
        let mut sent = base.diffuse * lambert;
        if base.shiny {
            sent = sent + base.highlight * base.lobe(surface, dir);
        }
        let sent = sent.times(arriving).times(weight);
        if !light.shadows {
            accumulator.add_radiance8(lit, &surface.pixel, &sent);
            continue;
        }
        let dark = sent.x.eq(F32x8::ZERO) & sent.y.eq(F32x8::ZERO) & sent.z.eq(F32x8::ZERO);
        let new = Spawn8 {
            origin,
            dir,
            t_max: distance,
            admits,
            weight: sent,
            pixel: &surface.pixel,
            stack: &surface.stack,
            lead: surface.lead(dir),
            passes: &[0; 8],
        };
        shadows.push8(lit & !dark.bits(), &new);
    }
}

impl Base8 {
    fn gather(scene: &Scene, surface: &Surface8) -> Self {
        let mut base = Self {
            diffuse: Vec3x8::splat(Vec3::ZERO),
            highlight: Vec3x8::splat(Vec3::ZERO),
            exponent: F32x8::ZERO,
            blinn: Mask8::NONE,
            glow: Vec3x8::splat(Vec3::ZERO),
            lit: false,
            shiny: false,
        };
        let mut blinn = 0;
        for k in 0..8 {
            let material = &scene.materials[surface.material[k] as usize];
            let diffuse = colour(scene, &material.diffuse, surface, k);
            base.diffuse.set_lane(k, diffuse);
            base.lit |= diffuse != Vec3::ZERO;
            base.glow.set_lane(k, material.emission + material.ambient * scene.ambient);
            if let Some(highlight) = material.highlight {
                base.highlight.set_lane(k, highlight.colour);
                base.exponent.set_lane(k, highlight.exponent);
                blinn |= u8::from(highlight.model == HighlightModel::BlinnPhong) << k;
                base.shiny = true;
                base.lit = true;
            }
        }
        base.blinn = Mask8::from_bits(blinn);
        base
    }

    /// The highlight's cosine to its exponent, for unit directions to the light.
    fn lobe(&self, surface: &Surface8, to_light: Vec3x8) -> F32x8 {
        let phong = -reflect(-to_light, surface.shading).dot(surface.incident);
        let blinn = (to_light - surface.incident).normalized().dot(surface.shading);
        let cos = Real::select(self.blinn, blinn, phong).max(F32x8::ZERO).min(F32x8::ONE);
        Real::pow(cos, self.exponent)
    }
}

fn colour(scene: &Scene, colour: &Colour, surface: &Surface8, k: usize) -> Vec3 {
    match colour {
        Colour::Constant(c) => *c,
        Colour::Image { texture, scale } => {
            bilinear(&scene.textures[*texture as usize], surface.uv(scene, k), Edge::Repeat) * *scale
        }
        Colour::Checker { even, odd, size, offset } => {
            if checker_is_even(surface.point.lane(k), *size, *offset) {
                *even
            } else {
                *odd
            }
        }
    }
}

/// Unit directions from `origin` to the light, distances, and what arrives there unshadowed on a facing surface
/// (without `pi`, which is the surface's affair).
fn arrive(light: &Light, origin: Vec3x8) -> (Vec3x8, F32x8, Rgb8) {
    let intensity = Vec3x8::splat(light.intensity);
    match light.kind {
        LightKind::Directional { direction } => (Vec3x8::splat(-direction), F32x8::INFINITY, intensity),
        LightKind::Point { position } => {
            let (dir, distance) = towards(position, origin);
            (dir, distance, intensity * weakening(light.falloff, distance))
        }
        LightKind::Spot { position, direction, cos_inner, cos_outer } => {
            let (dir, distance) = towards(position, origin);
            let cos = -dir.dot(Vec3x8::splat(direction));
            let cone = cone(cos, cos_inner, cos_outer);
            (dir, distance, intensity * (weakening(light.falloff, distance) * cone))
        }
    }
}

/// Unit directions and distances to a point. At the point itself the direction is NaN, every comparison with it
/// false, and the surface unlit.
fn towards(position: Vec3, origin: Vec3x8) -> (Vec3x8, F32x8) {
    let way = Vec3x8::splat(position) - origin;
    let distance = way.length();
    (way * (F32x8::ONE / distance), distance)
}

fn weakening(falloff: Falloff, distance: F32x8) -> F32x8 {
    match falloff {
        Falloff::InverseSquare => F32x8::ONE / (distance * distance),
        Falloff::None => F32x8::ONE,
    }
}

/// The spot light's factor: 1 inside the inner cone, 0 outside the outer one, a smooth step between.
fn cone(cos: F32x8, cos_inner: f32, cos_outer: f32) -> F32x8 {
    let inside = cos.ge(F32x8::from(cos_inner));
    let s = (cos - F32x8::from(cos_outer)) / F32x8::from(cos_inner - cos_outer);
    let s = s.max(F32x8::ZERO).min(F32x8::ONE);
    let step = s * s * (F32x8::from(3.0) - (s + s));
    Real::select(inside, F32x8::ONE, Real::select(cos.le(F32x8::from(cos_outer)), F32x8::ZERO, step))
}
