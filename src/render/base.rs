//! Base stage: emission, ambient light, and the albedo and highlight that the light stages use.

use glam::Vec3;

use super::lookup::{checker_is_even, on_surface};
use super::queue::Rgb8;
use super::shading::Shading;
use super::surface::Surface8;
use crate::scene::{Colour, HighlightModel, Material, Scene};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Base reflection parameters of eight surfaces, gathered from their materials.
#[derive(Clone, Copy, Debug)]
pub struct Base8 {
    /// Lambert albedo.
    pub diffuse: Rgb8,
    /// Colour of the highlight.
    pub highlight: Rgb8,
    /// Exponent of the highlight.
    pub exponent: F32x8,
    /// Lanes with a Blinn-Phong highlight; the others use Phong's.
    pub blinn: Mask8,
    /// Lanes that have a highlight.
    pub shiny: Mask8,
    /// True if any lane reflects light from lamps.
    pub lit: bool,
}

/// Function that gathers the bases of a stream of surfaces, and adds emission and ambient light to their pixels.
pub type BaseStage = fn(&mut Shading, &[Surface8], &mut Vec<Base8>);

/// Returns true if a material reflects lamp or ambient light, or emits.
#[must_use]
pub fn has_base(material: &Material) -> bool {
    material.answers_light() || material.emission != Vec3::ZERO || material.ambient != Vec3::ZERO
}

/// Picks the base stage by the properties that occur among the materials: textures (`textured`), highlights (`shiny`),
/// and emission or ambient light (`glowing`).
#[must_use]
pub fn pick(textured: bool, shiny: bool, glowing: bool) -> BaseStage {
    match (textured, shiny, glowing) {
        (false, false, false) => gather::<false, false, false>,
        (false, false, true) => gather::<false, false, true>,
        (false, true, false) => gather::<false, true, false>,
        (false, true, true) => gather::<false, true, true>,
        (true, false, false) => gather::<true, false, false>,
        (true, false, true) => gather::<true, false, true>,
        (true, true, false) => gather::<true, true, false>,
        (true, true, true) => gather::<true, true, true>,
    }
}

fn gather<const TEXTURED: bool, const SHINY: bool, const GLOWING: bool>(
    shading: &mut Shading,
    surfaces: &[Surface8],
    bases: &mut Vec<Base8>,
) {
    let scene = shading.scene;
    bases.clear();
    for surface in surfaces {
        let mut base = Base8 {
            diffuse: Vec3x8::splat(Vec3::ZERO),
            highlight: Vec3x8::splat(Vec3::ZERO),
            exponent: F32x8::ZERO,
            blinn: Mask8::NONE,
            shiny: Mask8::NONE,
            lit: false,
        };
        let mut glow = Vec3x8::splat(Vec3::ZERO);
        let (mut blinn, mut shiny, mut glowing) = (0, 0, 0);
        for k in 0..8 {
            let material = &scene.materials[surface.material[k] as usize];
            let diffuse = colour::<TEXTURED>(scene, &material.diffuse, surface, k);
            base.diffuse.set_lane(k, diffuse);
            base.lit |= diffuse != Vec3::ZERO;
            if GLOWING {
                let emission = match &material.glow {
                    Some(glow) if TEXTURED => colour::<TEXTURED>(scene, glow, surface, k),
                    _ => material.emission,
                };
                let sent = emission + material.ambient * scene.ambient;
                glow.set_lane(k, sent);
                glowing |= u8::from(sent != Vec3::ZERO) << k;
            }
            if let (true, Some(highlight)) = (SHINY, material.highlight) {
                base.highlight.set_lane(k, highlight.colour);
                base.exponent.set_lane(k, highlight.exponent);
                blinn |= u8::from(highlight.model == HighlightModel::BlinnPhong) << k;
                shiny |= 1 << k;
                base.lit = true;
            }
        }
        (base.blinn, base.shiny) = (Mask8::from_bits(blinn), Mask8::from_bits(shiny));
        if GLOWING {
            let sent = glow.times(surface.base_weight);
            shading.accumulator.add_radiance8(surface.base_lanes & glowing, &surface.pixel, &sent);
        }
        bases.push(base);
    }
}

#[inline(always)]
fn colour<const TEXTURED: bool>(scene: &Scene, colour: &Colour, surface: &Surface8, k: usize) -> Vec3 {
    match colour {
        Colour::Constant(c) => *c,
        Colour::Image { texture, scale } if TEXTURED => {
            on_surface(&scene.textures[*texture as usize], surface.uv(scene, k)) * *scale
        }
        Colour::Corners { texture, scale } if TEXTURED => {
            let picture = texture.map(|t| on_surface(&scene.textures[t as usize], surface.uv(scene, k)));
            surface.corner_colour(scene, k) * picture.unwrap_or(Vec3::ONE) * *scale
        }
        Colour::Checker { even, odd, size, offset } if TEXTURED => {
            if checker_is_even(surface.point.lane(k), *size, *offset) { *even } else { *odd }
        }
        Colour::Image { .. } | Colour::Corners { .. } | Colour::Checker { .. } => Vec3::ZERO,
    }
}
