//! Materials of glTF, as the nearest ones with smooth surfaces.
//!
//! With base colour `c`, metallic share `m`, roughness `r`, transmission `t` and the index `n`:
//!
//! | glTF | here |
//! |---|---|
//! | `t` above 0, with a thickness | a dielectric of index `n`; light is tinted by `c t` at each surface and absorbed between |
//! | `t` above 0, without | a thin pane of index `n` with the tint `c t` |
//! | `m (1 - r)` at least 0.01 | a mirror that reflects `c m (1 - r)` |
//! | else, `n` with a visible reflection at `r` | a clear coat that reflects `F (1 - r)` of what `n` reflects, `F` |
//! | else | a matt surface |
//! | all | a base of albedo `c (1 - m)(1 - t) + c m r^2`, and the share `r` of the reflection as a highlight |
//! | unlit | a surface that emits `c` |

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::DVec3;
use gltf_json::material::{AlphaMode, Material as Given};
use gltf_json::validation::Checked;

use super::document::Document;
use super::extension::Fields;
use super::picture::Pictures;
use super::texture::{Placement, TextureRef};
use crate::Result;
use crate::load::assembly::Assembly;
use crate::load::pictures::{Picture, Use};
use crate::optics::{absorption_from_colour, cauchy_from_abbe};
use crate::scene::ranges::EXPONENTS;
use crate::scene::{
    Colour, Dispersion, FresnelRule, Highlight, HighlightModel, Interface, Material, Medium, MirrorSource, Relief, Rgb,
};

/// Roughness above which a surface counts as rough.
const ROUGH: f64 = 0.05;
/// Reflected share of a mirror or a coat below which a surface has none.
const LEAST_MIRROR: f64 = 0.01;
const LEAST_COAT: f64 = 1e-3;
/// Largest emission; products with it stay finite.
const MOST_EMISSION: f64 = 1e30;

/// Material of the scene, with the place of its picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Made {
    /// Index into `Scene::materials`.
    pub material: u32,
    /// Texture coordinates of the picture, if there is one.
    pub placement: Option<Placement>,
}

/// Converter of the materials of one file.
pub(super) struct Materials<'d, 'p> {
    pub document: &'d Document<'p>,
    pub pictures: Pictures,
    /// World length of 1 in the file.
    pub scale: f64,
    /// Material by index, and by whether the mesh has colours at its vertices; the last index is the default.
    made: HashMap<(usize, bool), Made>,
}

/// Properties of a surface, after the pictures that only their means enter.
struct Surface {
    name: String,
    base: DVec3,
    picture: Option<Picture>,
    /// Mean colour of the picture; white without one.
    mean: DVec3,
    alpha: f64,
    metallic: f64,
    roughness: f64,
    /// Mean emission.
    emission: DVec3,
    /// Picture of the emission, its factor and its place.
    glow: Option<(u32, DVec3, Placement)>,
    transmission: f64,
    ior: f64,
    /// Reflected share of the dielectric at normal incidence.
    reflected: f64,
}

impl<'d, 'p> Materials<'d, 'p> {
    pub(super) fn new(document: &'d Document<'p>, scale: f64) -> Self {
        Self { document, pictures: Pictures::default(), scale, made: HashMap::new() }
    }

    /// Returns the material of a primitive, `painted` if it has colours at its vertices. One that it does not name, or that
    /// does not exist, is the default.
    pub(super) fn get(&mut self, index: Option<usize>, painted: bool, assembly: &mut Assembly<'_>) -> Result<Made> {
        let materials = &self.document.root.materials;
        let slot = index.map_or(materials.len(), |i| i.min(materials.len()));
        if let Some(&made) = self.made.get(&(slot, painted)) {
            return Ok(made);
        }
        let made = match materials.get(slot) {
            Some(given) => self.make(given, slot, painted, assembly)?,
            None => Made { material: assembly.add_material(plain(painted))?, placement: None },
        };
        self.made.insert((slot, painted), made);
        Ok(made)
    }

    fn make(&mut self, given: &Given, index: usize, painted: bool, assembly: &mut Assembly<'_>) -> Result<Made> {
        let extensions = given.extensions.as_ref().map(|e| &e.others);
        let of = |name: &str| Fields::of(extensions, name);
        let pbr = &given.pbr_metallic_roughness;
        let texture = pbr.base_color_texture.as_ref().map(TextureRef::of);
        let mut surface = self.surface(given, index, assembly)?;
        let unlit = of("KHR_materials_unlit").is_some();
        let mut interface = Interface::Opaque;
        let (base, m, r) = (surface.base, surface.metallic, surface.roughness);
        let mut diffuse = base * ((1.0 - m) * (1.0 - surface.transmission) + m * r * r);
        let opacity = self.opacity(given, &surface, assembly)?;
        if unlit {
            surface.emission = base * surface.mean;
            surface.glow = surface.picture.zip(texture).map(|(picture, t)| (picture.texture, base, t.placement));
            diffuse = DVec3::ZERO;
            if let Some((opacity, mask)) = opacity {
                interface = Interface::Alpha { opacity: opacity as f32, mask };
            }
        } else if surface.transmission > 0.0 {
            interface = self.transparent(given, &surface, assembly)?;
            if opacity.is_some() {
                self.warn(assembly, "the alpha of a material that transmits light is left out", &surface.name)?;
            }
        } else if let Some((opacity, mask)) = opacity {
            interface = Interface::Alpha { opacity: opacity as f32, mask };
            let reflects = m * (1.0 - r) >= LEAST_MIRROR || surface.reflected * (1.0 - r) >= LEAST_COAT;
            if reflects {
                self.warn(assembly, "the reflection of a material with alpha is left out", &surface.name)?;
            }
        } else if m * (1.0 - r) >= LEAST_MIRROR {
            let reflectance = base * surface.mean * m * (1.0 - r);
            interface = Interface::Mirror { reflectance: rgb(reflectance), source: MirrorSource::Traced };
        } else {
            let coat = surface.reflected * (1.0 - r);
            let coat = of("KHR_materials_clearcoat").map_or(Ok(coat), |f| self.coat(coat, f, &surface, assembly))?;
            if coat >= LEAST_COAT {
                interface = Interface::Coated { ior: ior_of(coat) as f32 };
            }
        }
        if r > ROUGH && !unlit {
            let kind = "rough surfaces are drawn as smooth ones with a matt base and highlights";
            self.warn(assembly, kind, &format!("{}, roughness {r:.2}", surface.name))?;
        }
        for (name, what) in [
            ("KHR_materials_anisotropy", "anisotropy"),
            ("KHR_materials_diffuse_transmission", "diffuse transmission"),
            ("KHR_materials_iridescence", "iridescence"),
            ("KHR_materials_sheen", "sheen"),
        ] {
            if of(name).is_some() {
                self.warn(assembly, &format!("{what} is left out"), &surface.name)?;
            }
        }
        let lit = diffuse != DVec3::ZERO;
        let picture = surface.picture.filter(|_| lit).map(|p| p.texture);
        let colour = colour(picture, rgb(diffuse), painted && lit);
        let masked = matches!(interface, Interface::Alpha { mask: Some(_), .. });
        let mut placement = texture.filter(|_| picture.is_some() || masked).map(|t| t.placement);
        let mut glow = None;
        if let Some((picture, factor, place)) = surface.glow {
            if placement.is_none_or(|p| p == place) {
                glow = Some(self::colour(Some(picture), rgb(factor), painted && unlit));
                placement = Some(place);
            } else {
                let kind = "a picture of emission with texture coordinates of its own is replaced by its mean";
                self.warn(assembly, kind, &surface.name)?;
            }
        }
        if painted && unlit && glow.is_none() {
            glow = Some(self::colour(None, rgb(base), true));
        }
        let mut relief = None;
        if let Some(normal) = given.normal_texture.as_ref().filter(|_| !unlit) {
            let set = normal.tex_coord;
            let at = TextureRef::new(normal.index.value(), set, normal.extensions.as_ref().map(|e| &e.others));
            if placement.is_none_or(|p| p == at.placement) {
                let picture = self.pictures.picture(self.document, at.texture, Use::Codes, assembly)?;
                let strength = if normal.scale.is_finite() { normal.scale } else { 1.0 };
                relief = picture.map(|p| Relief { texture: p.texture, strength });
                placement = relief.map(|_| at.placement).or(placement);
            } else {
                let kind = "a picture of normals with texture coordinates of its own is left out";
                self.warn(assembly, kind, &surface.name)?;
            }
        }
        let rough = (r > ROUGH && !unlit && interface_is_opaque(interface)).then(|| highlight(&surface)).flatten();
        let material = Material {
            name: surface.name,
            ambient: Rgb::ZERO,
            diffuse: colour,
            highlight: rough,
            emission: rgb(surface.emission),
            glow,
            relief,
            interface,
        };
        Ok(Made { material: assembly.add_material(material)?, placement })
    }

    /// Reads the numbers of a material, and the means of pictures that vary them.
    fn surface(&mut self, given: &Given, index: usize, assembly: &mut Assembly<'_>) -> Result<Surface> {
        let extensions = given.extensions.as_ref().map(|e| &e.others);
        let of = |name: &str| Fields::of(extensions, name);
        let share = |x: f64| x.clamp(0.0, 1.0);
        let name = given.name.clone().filter(|n| !n.is_empty()).unwrap_or_else(|| format!("material {index}"));
        let pbr = &given.pbr_metallic_roughness;
        let [r, g, b, alpha] = pbr.base_color_factor.0.map(|c| share(f64::from(c)));
        let [mut metallic, mut roughness] =
            [pbr.metallic_factor.0, pbr.roughness_factor.0].map(|x| share(f64::from(x)));
        let picture = match &pbr.base_color_texture {
            Some(info) => {
                let usage = match given.alpha_mode {
                    Checked::Valid(AlphaMode::Mask) => Use::Cut(cut(given, alpha)),
                    _ => Use::Srgb,
                };
                self.pictures.picture(self.document, TextureRef::of(info).texture, usage, assembly)?
            }
            None => None,
        };
        if let Some(info) = pbr.metallic_roughness_texture.as_ref().filter(|_| metallic > 0.0 || roughness > 0.0) {
            let mean = self.varied(TextureRef::of(info), "metallic and roughness", &name, assembly)?;
            roughness *= mean[1];
            metallic *= mean[2];
        }
        let strength = of("KHR_materials_emissive_strength").map_or(1.0, |f| f.number("emissiveStrength", 1.0));
        let mut emission = DVec3::from(given.emissive_factor.0.map(f64::from)) * strength;
        emission = emission.map(|c| if c > 0.0 { c.min(MOST_EMISSION) } else { 0.0 });
        let mut glow = None;
        if let (Some(info), true) = (&given.emissive_texture, emission != DVec3::ZERO) {
            let at = TextureRef::of(info);
            if let Some(picture) = self.pictures.picture(self.document, at.texture, Use::Srgb, assembly)? {
                glow = Some((picture.texture, emission, at.placement));
                emission *= mean_of(assembly, picture.texture);
            }
        }
        glow = glow.filter(|_| emission != DVec3::ZERO);
        let mut transmission = 0.0;
        if let Some(fields) = of("KHR_materials_transmission") {
            transmission = share(fields.number("transmissionFactor", 0.0)) * (1.0 - metallic);
            if let (Some(t), true) = (TextureRef::in_extension(fields, "transmissionTexture"), transmission > 0.0) {
                transmission *= self.varied(t, "transmission", &name, assembly)?[0];
            }
        }
        let ior = of("KHR_materials_ior").map_or(1.5, |f| f.number("ior", 1.5));
        let ior = if (1.0..=1e3).contains(&ior) {
            ior
        } else {
            self.warn(assembly, "a refractive index below 1 or above 1000 counts as 1.5", &name)?;
            1.5
        };
        let mut reflected = ((ior - 1.0) / (ior + 1.0)).powi(2);
        if let Some(fields) = of("KHR_materials_specular") {
            let colour = DVec3::from(fields.numbers("specularColorFactor", [1.0; 3])).max(DVec3::ZERO);
            let tint = colour.element_sum() / 3.0;
            reflected = (reflected * tint).min(1.0) * share(fields.number("specularFactor", 1.0));
            if colour.max_element() - colour.min_element() > 1e-3 {
                self.warn(assembly, "the colour of a specular reflection counts by its mean", &name)?;
            }
            for map in ["specularTexture", "specularColorTexture"] {
                if fields.get(map).is_some() {
                    self.warn(assembly, "pictures of the specular reflection are left out", &name)?;
                }
            }
        }
        let base = DVec3::new(r, g, b);
        // A picture of light may exceed 1, which no surface reflects.
        let mean = picture.map_or(DVec3::ONE, |p| mean_of(assembly, p.texture).min(DVec3::ONE));
        Ok(Surface {
            name,
            base,
            picture,
            mean,
            glow,
            alpha,
            metallic,
            roughness,
            emission,
            transmission,
            ior,
            reflected,
        })
    }

    /// Returns the mean of a picture that varies a property, of which there is one value here.
    fn varied(&mut self, texture: TextureRef, what: &str, name: &str, assembly: &mut Assembly<'_>) -> Result<[f64; 3]> {
        let Some(mean) = self.pictures.mean(self.document, texture.texture, assembly)? else { return Ok([1.0; 3]) };
        self.warn(assembly, &format!("pictures of {what} are replaced by their mean"), name)?;
        Ok(mean)
    }

    /// Returns the opacity of a surface that shows what is behind it, and the picture that varies it.
    fn opacity(
        &mut self,
        given: &Given,
        surface: &Surface,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<(f64, Option<u32>)>> {
        let mask = surface.picture.and_then(|p| p.alpha);
        match given.alpha_mode {
            Checked::Valid(AlphaMode::Blend) => {
                Ok(Some((surface.alpha, mask)).filter(|&(a, mask)| a < 1.0 || mask.is_some()))
            }
            // Without an alpha channel the picture covers wholly.
            Checked::Valid(AlphaMode::Mask) if mask.is_none() => {
                Ok((surface.alpha < cutoff(given)).then_some((0.0, None)))
            }
            Checked::Valid(AlphaMode::Mask) => Ok(Some((1.0, mask))),
            Checked::Valid(AlphaMode::Opaque) => Ok(None),
            Checked::Invalid => {
                self.warn(assembly, "an alpha mode that is not known counts as opaque", &surface.name)?;
                Ok(None)
            }
        }
    }

    /// Returns the interface of a surface that transmits light: that of a solid if the material has a thickness, else
    /// that of a thin pane.
    fn transparent(&mut self, given: &Given, surface: &Surface, assembly: &mut Assembly<'_>) -> Result<Interface> {
        let extensions = given.extensions.as_ref().map(|e| &e.others);
        let volume = Fields::of(extensions, "KHR_materials_volume");
        let tint = surface.base * surface.mean * surface.transmission;
        let tint = rgb(tint);
        let Some(volume) = volume.filter(|v| v.number("thicknessFactor", 0.0) > 0.0) else {
            return Ok(Interface::ThinDielectric { ior: surface.ior as f32, rule: FresnelRule::Fresnel, tint });
        };
        let colour = DVec3::from(volume.numbers("attenuationColor", [1.0; 3])).clamp(DVec3::ZERO, DVec3::ONE);
        let distance = volume.number("attenuationDistance", f64::INFINITY) * self.scale;
        let absorption = if distance > 0.0 && distance.is_finite() {
            absorption_from_colour(colour.as_vec3(), (distance as f32).max(f32::MIN_POSITIVE))
        } else {
            Rgb::ZERO
        };
        let dispersion =
            Fields::of(extensions, "KHR_materials_dispersion").map_or(0.0, |f| f.number("dispersion", 0.0));
        let dispersion = match dispersion {
            d if d > 0.0 && surface.ior > 1.0 => {
                // An Abbe number below 5 is no glass, and its index may fall below 1.
                let [a, b] = cauchy_from_abbe(surface.ior, (20.0 / d).clamp(5.0, 1e3));
                Dispersion::Cauchy([a, b, 0.0])
            }
            _ => Dispersion::None,
        };
        let medium = Medium { name: surface.name.clone(), ior: surface.ior, dispersion, absorption, priority: 0 };
        Ok(Interface::Dielectric { medium: assembly.add_medium(medium), rule: FresnelRule::Fresnel, tint })
    }

    /// Returns the reflected share of a coat over a surface that reflects `coat` itself.
    fn coat(&mut self, coat: f64, fields: Fields<'_>, surface: &Surface, assembly: &mut Assembly<'_>) -> Result<f64> {
        let mut strength = fields.number("clearcoatFactor", 0.0).clamp(0.0, 1.0);
        let mut roughness = fields.number("clearcoatRoughnessFactor", 0.0).clamp(0.0, 1.0);
        if let (Some(t), true) = (TextureRef::in_extension(fields, "clearcoatTexture"), strength > 0.0) {
            strength *= self.varied(t, "clearcoat", &surface.name, assembly)?[0];
        }
        if let (Some(t), true) = (TextureRef::in_extension(fields, "clearcoatRoughnessTexture"), roughness > 0.0) {
            roughness *= self.varied(t, "clearcoat roughness", &surface.name, assembly)?[1];
        }
        if fields.get("clearcoatNormalTexture").is_some() {
            self.warn(assembly, "pictures of the normals of a coat are left out", &surface.name)?;
        }
        // Two layers: what the first one passes, the second one reflects.
        let first = 0.04 * strength * (1.0 - roughness);
        Ok(first + (1.0 - first) * coat)
    }

    fn warn(&self, assembly: &mut Assembly<'_>, kind: &str, material: &str) -> Result<()> {
        let name: String = material.chars().take(80).collect();
        assembly.reporter.warn(self.document.path, 0, kind, || format!(": material {name}"))
    }
}

/// Returns the material of primitives that name none: white and matt, for a fully rough metal is no better.
fn plain(painted: bool) -> Material {
    Material { diffuse: colour(None, Rgb::ONE, painted), ..Material::default() }
}

/// Returns a colour by a picture, by the colours of vertices if `painted`, or one for all.
fn colour(picture: Option<u32>, scale: Rgb, painted: bool) -> Colour {
    match (picture, painted) {
        (texture, true) => Colour::Corners { texture, scale },
        (Some(texture), false) => Colour::Image { texture, scale },
        (None, false) => Colour::Constant(scale),
    }
}

fn cutoff(given: &Given) -> f64 {
    given.alpha_cutoff.map_or(0.5, |c| f64::from(c.0))
}

/// Returns the smallest code of alpha that covers, under a factor on alpha.
fn cut(given: &Given, factor: f64) -> u8 {
    let least = (cutoff(given) / factor.max(1e-6) * 255.0).ceil();
    // Nothing covers if not even the largest code does; 255 then stands for that.
    least.clamp(0.0, 255.0) as u8
}

fn interface_is_opaque(interface: Interface) -> bool {
    matches!(interface, Interface::Opaque | Interface::Coated { .. } | Interface::Mirror { .. })
}

/// Returns the highlight of a rough surface: the lobe of its facets with the share `r` of its reflection.
fn highlight(surface: &Surface) -> Option<Highlight> {
    let (m, r) = (surface.metallic, surface.roughness);
    // Blinn's lobe of facets with a slope of r^2 (Walter et al. 2007), normalised.
    let exponent = (2.0 / r.powi(4) - 2.0).clamp(*EXPONENTS.start(), *EXPONENTS.end());
    let reflected = surface.base * surface.mean * m + surface.reflected * (1.0 - m);
    let colour = reflected * (r * (exponent + 2.0) / (8.0 * PI));
    let highlight = Highlight { colour: rgb(colour), exponent: exponent as f32, model: HighlightModel::BlinnPhong };
    (colour != DVec3::ZERO).then_some(highlight)
}

/// Returns the index of a dielectric that reflects `share` at normal incidence.
fn ior_of(share: f64) -> f64 {
    let root = share.clamp(0.0, 0.99).sqrt();
    (1.0 + root) / (1.0 - root)
}

fn mean_of(assembly: &Assembly<'_>, texture: u32) -> DVec3 {
    let pixels = &assembly.scene.textures[texture as usize].pixels;
    pixels.iter().fold(DVec3::ZERO, |sum, p| sum + p.as_dvec3()) / pixels.len().max(1) as f64
}

fn rgb(colour: DVec3) -> Rgb {
    colour.as_vec3()
}
