//! Removal of effects from a scene's data.

use std::borrow::Cow;

use super::{Effect, EffectSet};
use crate::geometry::{Geometry, Shape};
use crate::scene::{
    Colour, Dispersion, Environment, FresnelRule, Interface, LightKind, LightsFrom, Rgb, Scene, ShadowRule, Texture,
};

/// Returns the scene without some effects, as [`Effect::left_out`] describes each. Refraction, total internal
/// reflection and contact are not part of a scene's data; renderers leave them out themselves. Shapes keep their
/// places, so a hierarchy built for the whole scene also serves the result.
#[must_use]
pub fn without(scene: &Scene, effects: EffectSet) -> Cow<'_, Scene> {
    let mut scene = Cow::Borrowed(scene);
    for effect in effects.iter() {
        if !matches!(effect, Effect::Refraction | Effect::TotalInternalReflection | Effect::Touching) {
            take_out(scene.to_mut(), effect);
        }
    }
    scene
}

fn take_out(scene: &mut Scene, effect: Effect) {
    let (textures, geometry) = (&scene.textures, &scene.geometry);
    let materials = scene.materials.iter_mut();
    let opaque_where = |what: fn(&Interface) -> bool| {
        move |m: &mut crate::scene::Material| {
            if what(&m.interface) {
                m.interface = Interface::Opaque;
            }
        }
    };
    match effect {
        Effect::Ambient => scene.ambient = Rgb::ZERO,
        Effect::Emission => materials.for_each(|m| (m.emission, m.glow) = (Rgb::ZERO, None)),
        Effect::Diffuse => materials.for_each(|m| m.diffuse = Colour::Constant(Rgb::ZERO)),
        Effect::Highlight => materials.for_each(|m| m.highlight = None),
        Effect::HardShadows => {
            scene.lights.iter_mut().for_each(|l| l.shadows = false);
            scene.settings.shine_shadows = false;
        }
        Effect::EmissiveLight => scene.settings.lights_from = LightsFrom::only(false, scene.admitted().sky),
        Effect::SkyLight => scene.settings.lights_from = LightsFrom::only(scene.admitted().emissive, false),
        Effect::SoftShadows => {
            for light in &mut scene.lights {
                if let (true, Some(position)) = (light.kind.is_extended(), light.kind.position()) {
                    light.kind = LightKind::Point { position };
                }
            }
        }
        Effect::Dispersion => scene.media.iter_mut().for_each(|m| m.dispersion = Dispersion::None),
        Effect::ShadowsThroughGlass => scene.settings.shadows = ShadowRule::Opaque,
        Effect::Mirror => materials.for_each(opaque_where(|i| matches!(i, Interface::Mirror { .. }))),
        Effect::Conductor => materials.for_each(opaque_where(|i| matches!(i, Interface::Conductor { .. }))),
        Effect::Coats => materials.for_each(opaque_where(|i| matches!(i, Interface::Coated { .. }))),
        Effect::Alpha => materials.for_each(opaque_where(|i| matches!(i, Interface::Alpha { .. }))),
        Effect::ThinPanes => materials.for_each(|m| {
            if matches!(m.interface, Interface::ThinDielectric { .. }) {
                m.interface = Interface::Alpha { opacity: 0.0, mask: None };
            }
        }),
        Effect::FresnelSplit => materials.for_each(|m| {
            if let Interface::Dielectric { rule, .. } | Interface::ThinDielectric { rule, .. } = &mut m.interface
                && *rule == FresnelRule::Fresnel
            {
                *rule = FresnelRule::Fixed(Rgb::ZERO);
            }
        }),
        Effect::Absorption => scene.media.iter_mut().for_each(|m| m.absorption = Rgb::ZERO),
        Effect::NestedMedia => scene.media.iter_mut().skip(1).for_each(|m| m.priority = i32::MAX),
        Effect::Environment => scene.environment = Environment::Constant(Rgb::ZERO),
        Effect::Textures => materials.for_each(|m| {
            m.diffuse = Colour::Constant(mean(&m.diffuse, textures, geometry));
            m.glow = None;
        }),
        Effect::InterpolatedNormals => {
            materials.for_each(|m| m.relief = None);
            for geometry in &mut scene.geometry {
                if let Shape::Mesh(mesh) = &mut geometry.shape {
                    (mesh.normals, mesh.normal_indices) = (Vec::new(), Vec::new());
                }
            }
        }
        Effect::Refraction | Effect::TotalInternalReflection | Effect::Touching => {}
    }
}

fn mean(colour: &Colour, textures: &[Texture], geometry: &[Geometry]) -> Rgb {
    match colour {
        Colour::Constant(c) => *c,
        Colour::Checker { even, odd, .. } => (*even + *odd) * 0.5,
        Colour::Image { texture, scale } => of_all(textures[*texture as usize].pixels.iter()) * *scale,
        Colour::Corners { texture, scale } => {
            let corners = geometry.iter().flat_map(|g| match &g.shape {
                Shape::Mesh(mesh) => mesh.colours.as_slice(),
                Shape::Sphere(_) | Shape::Plane(_) => &[],
            });
            let picture = texture.map_or(Rgb::ONE, |t| of_all(textures[t as usize].pixels.iter()));
            of_all(corners.copied()) * picture * *scale
        }
    }
}

fn of_all(colours: impl Iterator<Item = Rgb>) -> Rgb {
    let (sum, count) = colours.fold((glam::DVec3::ZERO, 0_usize), |(sum, count), c| (sum + c.as_dvec3(), count + 1));
    (sum / count.max(1) as f64).as_vec3()
}
