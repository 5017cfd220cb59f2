//! Conversion of MTL materials, as the programs mean them that write them.
//!
//! `illum` is MTL's own switch for the effects to simulate (Alias|Wavefront, "Material Template Library", 1995):
//!
//! | illum | the format's meaning | here |
//! |--:|---|---|
//! | 0 | constant colour `Kd` | emission `Kd + Ke`, no light needed |
//! | 1 | ambient and Lambert | `Ka`, `Kd` |
//! | 2 | and highlight | and `Ks`, `Ns` with the half vector: the format's `(H . N)^Ns` is Blinn's |
//! | 3 | and ray-traced reflection | and a mirror that reflects `Ks` |
//! | 4 | glass and reflection | with a `Kd` a base of opacity `d`; else a thin pane (`Ni`, Fresnel, `Tf`) |
//! | 5 | Fresnel reflection | a clear coat of index `Ni` on the base |
//! | 6 | refraction, Fresnel off | as 4, but without `Kd` a dielectric (`Ni`, `Tf`) that reflects the fixed share `Ks` |
//! | 7 | refraction and Fresnel | a dielectric (`Ni`, `Tf`); `Ni 1` with a `Kd` as 4 |
//! | 8 | reflection without ray tracing | a mirror that reflects `Ks` of the environment |
//! | 9 | glass without ray tracing | as 4, but without `Kd` a thin pane that reflects nothing and passes `Tf` |
//! | 10 | casts shadows on invisible surfaces | as 2, with a warning |
//!
//! Without `illum` it is 2, and there is no highlight if `Ks` or `Ns` is missing or 0. `Kd` defaults to mid-grey,
//! unless the material has a picture, emission, or is glass. `d` (else 1 minus `Tr`) is the share of the base; the rest
//! passes. So 4, 6 and 9 with a `Kd` and without `d` are opaque, and glass passes the share 1 - `d` of what it would
//! pass. Maya writes no `d`, but `Tf` for it, with `illum 4` and `Ni 1`. The reflection of 3, 5 and 8 is left out with a
//! warning where `d` applies. The format does not define the index of glass without `Ni`; it is 1.5 here, with a
//! warning. A picture's alpha channel, or `map_d` in its place, multiplies the opacity.
//!
//! Of the extension for physically based materials `Pm` makes a mirror of colour `Kd`, and `Pc` a clear coat; roughness
//! (`Pr`) is left out with a warning.

use std::path::Path;

use super::library::Entry;
use super::map::Map;
use super::names::files;
use super::text::{short, shown};
use crate::load::assembly::Assembly;
use crate::load::pictures::{Picture, Use};
use crate::load::source::folder_of;
use crate::scene::{
    Colour, Dispersion, FresnelRule, Highlight, HighlightModel, Interface, Material, Medium, MirrorSource, Rgb, Wrap,
};
use crate::{Error, Result};

/// Index of glass whose material names none.
const USUAL_INDEX: f64 = 1.5;
/// Share from which on a coat counts as one.
const COAT: f32 = 0.5;

/// Material, with the change of texture coordinates that its picture asks for.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub material: Material,
    /// Factor and shift.
    pub uv: Option<[[f32; 2]; 2]>,
}

/// Converts an MTL entry to a material, with its medium and pictures. `coloured` is true if the model has colours at its
/// vertices.
pub(super) fn material(entry: &Entry, coloured: bool, assembly: &mut Assembly<'_>) -> Result<Made> {
    let maker = Maker { entry, coloured };
    maker.make(assembly)
}

struct Maker<'e> {
    entry: &'e Entry,
    coloured: bool,
}

/// Base of a material.
struct Base {
    colour: Colour,
    /// Coverage by a picture.
    mask: Option<u32>,
    uv: Option<[[f32; 2]; 2]>,
}

impl Maker<'_> {
    fn warn(&self, assembly: &mut Assembly<'_>, what: &str) -> Result<()> {
        let kind = format!("material `{}`: {what}", short(self.entry.name.as_bytes()));
        assembly.reporter.warn(&self.entry.file, self.entry.line as usize, &kind, String::new)
    }

    fn make(&self, assembly: &mut Assembly<'_>) -> Result<Made> {
        let values = &self.entry.values;
        let colour = |c: Option<[f64; 3]>| c.map_or(Rgb::ZERO, rgb);
        let mut illum = values.illumination_model.unwrap_or(2);
        if illum == 10 {
            self.warn(assembly, "illum 10, shadows on invisible surfaces, is treated as 2")?;
            illum = 2;
        }
        let emission = colour(values.emissive);
        let ks = colour(values.specular);
        let glass = self.is_glass(illum);
        let Base { colour: base, mask, uv } = self.base(glass || emission != Rgb::ZERO, assembly)?;

        let (mut interface, mut base) = self.interface(illum, glass, ks, base, assembly)?;
        if let (Interface::Opaque, true) = (&interface, illum < 3 || matches!(illum, 4 | 6 | 7 | 9)) {
            (interface, base) = self.physical(base, assembly)?;
        }
        if let Some(mask) = mask {
            interface = match interface {
                Interface::Opaque => Interface::Alpha { opacity: 1.0, mask: Some(mask) },
                Interface::Alpha { opacity, .. } => Interface::Alpha { opacity, mask: Some(mask) },
                other => {
                    self.warn(assembly, "the holes of its picture are left out: it reflects or is glass")?;
                    other
                }
            };
        }
        if glass && base != Colour::Constant(Rgb::ZERO) && values.dissolve.is_none() {
            self.warn(
                assembly,
                "glass with a `Kd` shines with it in front of what is seen through it; `Kd 0` is clear",
            )?;
        }
        let (diffuse, emission) = match (illum, base) {
            (0, Colour::Constant(kd)) => (Colour::Constant(Rgb::ZERO), emission + kd),
            (0, picture) => {
                self.warn(assembly, "a constant picture (illum 0) is lit like illum 1")?;
                (picture, emission)
            }
            (_, base) => (base, emission),
        };
        if let (Interface::Mirror { reflectance, .. }, Colour::Constant(kd)) = (interface, &diffuse)
            && (reflectance + *kd).max_element() > 1.0 + 1e-6
        {
            self.warn(assembly, "`Kd` and `Ks` sum to more than 1: it gives back more light than it gets")?;
        }
        let highlight = match values.shininess {
            Some(exponent) if exponent > 0.0 && ks != Rgb::ZERO && illum >= 2 => {
                Some(Highlight { colour: ks, exponent: exponent as f32, model: HighlightModel::BlinnPhong })
            }
            _ => None,
        };
        let ambient = if illum == 0 { Rgb::ZERO } else { colour(values.ambient) };
        let name = self.entry.name.clone();
        let material = Material { name, ambient, diffuse, highlight, emission, interface, ..Material::default() };
        Ok(Made { material, uv })
    }

    /// Returns true if the material has a base of its own: a picture, or a `Kd` that is not black.
    fn has_base(&self) -> bool {
        self.entry.picture.is_some() || self.entry.values.diffuse.is_some_and(|kd| kd != [0.0; 3])
    }

    /// Returns true if the material is glass, as far as `illum` and `Ni` say, and not a base with a share.
    fn is_glass(&self, illum: u8) -> bool {
        match illum {
            4 | 6 | 9 => !self.has_base(),
            7 => !self.has_base() || self.entry.values.optical_density != Some(1.0),
            _ => false,
        }
    }

    /// Returns the interface, and the base below it.
    fn interface(
        &self,
        illum: u8,
        glass: bool,
        ks: Rgb,
        base: Colour,
        assembly: &mut Assembly<'_>,
    ) -> Result<(Interface, Colour)> {
        let opacity = self.entry.values.dissolve.map(|d| d as f32);
        if glass {
            // A base of opacity `d`, of which glass has the rest.
            let covered = opacity.filter(|&d| d < 1.0).unwrap_or(0.0);
            let tint = self.entry.filter.unwrap_or(Rgb::ONE) * (1.0 - covered);
            let base = if opacity.is_some_and(|d| d < 1.0) { scaled(base, covered) } else { base };
            let ior = self.index(assembly)?;
            let interface = match illum {
                4 => Interface::ThinDielectric { ior: ior as f32, rule: FresnelRule::Fresnel, tint },
                9 => Interface::ThinDielectric { ior: ior as f32, rule: FresnelRule::Fixed(Rgb::ZERO), tint },
                _ => {
                    let medium = Medium {
                        name: self.entry.name.clone(),
                        ior,
                        dispersion: Dispersion::None,
                        absorption: Rgb::ZERO,
                        priority: 0,
                    };
                    let rule = if illum == 6 { FresnelRule::Fixed(ks) } else { FresnelRule::Fresnel };
                    Interface::Dielectric { medium: assembly.add_medium(medium), rule, tint }
                }
            };
            return Ok((interface, base));
        }
        let reflecting = match illum {
            3 => Interface::Mirror { reflectance: ks, source: MirrorSource::Traced },
            8 => Interface::Mirror { reflectance: ks, source: MirrorSource::Environment },
            5 => Interface::Coated { ior: self.index(assembly)? as f32 },
            _ => Interface::Opaque,
        };
        let opacity = match opacity {
            None if matches!(illum, 4 | 6 | 9) => self.opacity_of_maya(assembly)?,
            opacity => opacity,
        };
        match opacity.filter(|&d| d < 1.0) {
            Some(opacity) => {
                if reflecting != Interface::Opaque {
                    let what = format!("the reflection of illum {illum} is left out for its opacity of {opacity}");
                    self.warn(assembly, &what)?;
                }
                Ok((Interface::Alpha { opacity, mask: None }, base))
            }
            None => Ok((reflecting, base)),
        }
    }

    /// Returns the opacity of a material without `d` that has a transmission filter and no index, as Maya writes it.
    fn opacity_of_maya(&self, assembly: &mut Assembly<'_>) -> Result<Option<f32>> {
        let unbent = self.entry.values.optical_density.is_none_or(|n| n == 1.0);
        let Some(filter) = self.entry.filter.filter(|&f| unbent && f != Rgb::ONE) else { return Ok(None) };
        let opacity = filter.element_sum() / 3.0;
        let what =
            format!("`Tf` without `d` counts as an opacity of {opacity}, as Maya writes it; `d` says it clearly");
        self.warn(assembly, &what)?;
        Ok(Some(opacity))
    }

    /// Applies the extension for physically based materials to an opaque base.
    fn physical(&self, base: Colour, assembly: &mut Assembly<'_>) -> Result<(Interface, Colour)> {
        let Entry { metallic, roughness, coat, .. } = *self.entry;
        if metallic > 0.0 {
            if roughness > 0.0 {
                self.warn(assembly, "a rough metal (`Pr` above 0) is shown as a smooth one")?;
            }
            return Ok(match &base {
                Colour::Constant(kd) => {
                    let mirror = Interface::Mirror { reflectance: *kd * metallic, source: MirrorSource::Traced };
                    (mirror, scaled(base, 1.0 - metallic))
                }
                _ => {
                    self.warn(assembly, "a metal (`Pm`) with a picture is shown as matt")?;
                    (Interface::Opaque, base)
                }
            });
        }
        if coat >= COAT {
            return Ok((Interface::Coated { ior: USUAL_INDEX as f32 }, base));
        }
        Ok((Interface::Opaque, base))
    }

    /// Returns the index of a material that needs one.
    fn index(&self, assembly: &mut Assembly<'_>) -> Result<f64> {
        match self.entry.values.optical_density {
            Some(n) if (1e-3..=1e3).contains(&n) => Ok(n),
            Some(n) if n > 1e3 => {
                self.warn(assembly, &format!("`Ni {n}` counts as 1000; a refractive index is between 0.001 and 1000"))?;
                Ok(1e3)
            }
            Some(n) => {
                let what = format!("`Ni {n}` counts as not given, 1.5; a refractive index is between 0.001 and 1000");
                self.warn(assembly, &what)?;
                Ok(USUAL_INDEX)
            }
            None => {
                self.warn(assembly, "glass without a refractive index `Ni` has 1.5; give one")?;
                Ok(USUAL_INDEX)
            }
        }
    }

    /// Returns the base. Without a colour in the file it is black if `dark`, else mid-grey, or white under the colours of
    /// vertices.
    fn base(&self, dark: bool, assembly: &mut Assembly<'_>) -> Result<Base> {
        let kd = self.entry.values.diffuse.map(rgb);
        let (mut mask, mut uv) = (None, None);
        let mut picture = None;
        if let Some(map) = &self.entry.picture
            && let Some(Picture { texture, alpha }) = self.picture(map, Use::Colour, assembly)?
        {
            (picture, mask, uv) = (Some(texture), alpha, changed(map));
        }
        if let Some(map) = &self.entry.mask
            && let Some(Picture { texture, .. }) = self.picture(map, Use::Mask(map.channel), assembly)?
        {
            if picture.is_some() && uv != changed(map) {
                self.warn(assembly, "the texture options of `map_d` are left out; those of `map_Kd` count")?;
            } else {
                uv = changed(map);
            }
            mask = Some(texture);
        }
        let colour = match picture {
            Some(texture) => {
                let scale = match kd {
                    // Written by exporters that use the picture alone.
                    Some(Rgb::ZERO) => {
                        self.warn(assembly, "a picture whose `Kd` is 0 counts as if `Kd` were 1")?;
                        Rgb::ONE
                    }
                    kd => kd.unwrap_or(Rgb::ONE),
                };
                if self.coloured {
                    self.warn(assembly, "the colours of vertices are left out; its picture gives the colour")?;
                }
                Colour::Image { texture, scale }
            }
            None if self.coloured && !dark && kd != Some(Rgb::ZERO) => {
                Colour::Corners { texture: None, scale: kd.unwrap_or(Rgb::ONE) }
            }
            None => Colour::Constant(kd.unwrap_or(if dark { Rgb::ZERO } else { Rgb::splat(0.5) })),
        };
        Ok(Base { colour, mask, uv })
    }

    /// Finds and reads a picture; one that cannot be had is left out with a warning.
    fn picture(&self, map: &Map, usage: Use, assembly: &mut Assembly<'_>) -> Result<Option<Picture>> {
        let file: &Path = &self.entry.file;
        let line = map.line as usize;
        let name = shown(&map.file);
        let found = match assembly.root.find(folder_of(file), &files(&map.file), &short(name.as_bytes())) {
            Ok(found) => found,
            Err(e) => {
                assembly.reporter.warn(file, line, &format!("picture left out: {e}"), String::new)?;
                return Ok(None);
            }
        };
        if found.beside {
            let kind = format!("picture `{}` is taken from beside the file", short(name.as_bytes()));
            assembly.reporter.warn(file, line, &kind, String::new)?;
        }
        let wrap = [if map.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2];
        match assembly.picture_for(&found.path, usage, wrap) {
            Ok(picture) => Ok(Some(picture)),
            Err(e @ (Error::File { .. } | Error::Io { .. } | Error::Limit(_))) if !assembly.options.strict => {
                assembly.reporter.warn(file, line, &format!("picture left out: {e}"), String::new)?;
                Ok(None)
            }
            Err(e) => Err(e),
        }
    }
}

/// Returns the factor and shift that a picture's options ask for, unless they change nothing.
fn changed(map: &Map) -> Option<[[f32; 2]; 2]> {
    Some([map.scale, map.offset]).filter(|change| *change != [[1.0; 2], [0.0; 2]])
}

fn rgb(colour: [f64; 3]) -> Rgb {
    Rgb::from(colour.map(|c| c as f32))
}

/// Returns a colour times `share`.
fn scaled(colour: Colour, share: f32) -> Colour {
    match colour {
        Colour::Constant(c) => Colour::Constant(c * share),
        Colour::Image { texture, scale } => Colour::Image { texture, scale: scale * share },
        Colour::Corners { texture, scale } => Colour::Corners { texture, scale: scale * share },
        Colour::Checker { even, odd, size, offset } => {
            Colour::Checker { even: even * share, odd: odd * share, size, offset }
        }
    }
}
