//! Conversion of MTL materials.
//!
//! `illum` is MTL's own switch for the effects to simulate (Alias|Wavefront, "Material Template Library", 1995):
//!
//! | illum | the format's meaning | here |
//! |--:|---|---|
//! | 0 | constant colour `Kd` | emission `Kd + Ke`, no light needed |
//! | 1 | ambient and Lambert | `Ka`, `Kd` |
//! | 2 | and highlight | and `Ks`, `Ns` with the half vector: the format's `(H . N)^Ns` is Blinn's |
//! | 3 | and ray-traced reflection | and a mirror that reflects `Ks` |
//! | 4 | glass and reflection | a thin pane (`Ni`, Fresnel, `Tf`): light passes unbent |
//! | 5 | Fresnel reflection | a clear coat of index `Ni` on the base |
//! | 6 | refraction, Fresnel off | a dielectric (`Ni`, `Tf`) that reflects the fixed share `Ks` |
//! | 7 | refraction and Fresnel | a dielectric (`Ni`, `Tf`) |
//! | 8 | reflection without ray tracing | a mirror that reflects `Ks` of the environment |
//! | 9 | glass without ray tracing | a thin pane that reflects nothing and passes `Tf` |
//! | 10 | casts shadows on invisible surfaces | as 2, with a warning |
//!
//! Without `illum` it is 2, and there is no highlight if `Ks` or `Ns` is missing or 0. `Kd` defaults to mid-grey,
//! unless the material has a picture, emission, or is glass. `d` below 1 (or `Tr` above 0) makes a base of that
//! opacity. Glass (4, 6, 7, 9) is transparent by itself, so `d` is left out there with a warning. The reflection of 3,
//! 5 and 8 is left out with a warning where `d` applies. The format does not define the index of glass without `Ni`; it
//! is 1.5 here, with a warning.

use std::path::Path;

use super::library::Entry;
use super::scan::short;
use crate::load::assembly::Assembly;
use crate::load::source::folder_of;
use crate::scene::{
    Colour, Dispersion, FresnelRule, Highlight, HighlightModel, Interface, Material, Medium, MirrorSource, Rgb,
};
use crate::{Error, Result};

/// Converts an MTL entry to a material, with its medium and picture.
pub(super) fn material(entry: &Entry, assembly: &mut Assembly<'_>) -> Result<Material> {
    let values = &entry.values;
    let colour = |c: Option<[f64; 3]>| c.map_or(Rgb::ZERO, rgb);
    let warn = |assembly: &mut Assembly<'_>, what: &str| {
        let kind = format!("material `{}`: {what}", short(&entry.name));
        assembly.reporter.warn(&entry.file, entry.line as usize, &kind, String::new)
    };
    let mut illum = values.illumination_model.unwrap_or(2);
    if illum == 10 {
        warn(assembly, "illum 10, shadows on invisible surfaces, is treated as 2")?;
        illum = 2;
    }
    let glass = matches!(illum, 4 | 6 | 7 | 9);
    let ks = colour(values.specular);
    let ior = if glass || illum == 5 { index(entry, assembly)? } else { 1.0 };
    let tint = entry.filter.unwrap_or(Rgb::ONE);

    let mut interface = match illum {
        3 => Interface::Mirror { reflectance: ks, source: MirrorSource::Traced },
        8 => Interface::Mirror { reflectance: ks, source: MirrorSource::Environment },
        4 => Interface::ThinDielectric { ior: ior as f32, rule: FresnelRule::Fresnel, tint },
        9 => Interface::ThinDielectric { ior: ior as f32, rule: FresnelRule::Fixed(Rgb::ZERO), tint },
        5 => Interface::Coated { ior: ior as f32 },
        6 | 7 => {
            let medium = Medium {
                name: entry.name.clone(),
                ior,
                dispersion: Dispersion::None,
                absorption: Rgb::ZERO,
                priority: 0,
            };
            let rule = if illum == 6 { FresnelRule::Fixed(ks) } else { FresnelRule::Fresnel };
            Interface::Dielectric { medium: assembly.add_medium(medium), rule, tint }
        }
        _ => Interface::Opaque,
    };
    if let Some(opacity) = values.dissolve.map(|d| d as f32).filter(|&d| d < 1.0) {
        if glass {
            warn(assembly, &format!("opacity {opacity} is left out: illum {illum} is transparent by itself"))?;
        } else {
            if interface != Interface::Opaque {
                warn(assembly, &format!("the reflection of illum {illum} is left out for its opacity of {opacity}"))?;
            }
            interface = Interface::Alpha { opacity };
        }
    }

    let emission = colour(values.emissive);
    let base = base(entry, glass || emission != Rgb::ZERO, assembly)?;
    if glass && base != Colour::Constant(Rgb::ZERO) {
        warn(assembly, "glass with a `Kd` shines with it in front of what is seen through it; `Kd 0` is clear")?;
    }
    let (diffuse, emission) = match (illum, base) {
        (0, Colour::Constant(kd)) => (Colour::Constant(Rgb::ZERO), emission + kd),
        (0, picture) => {
            warn(assembly, "a constant picture (illum 0) is lit like illum 1")?;
            (picture, emission)
        }
        (_, base) => (base, emission),
    };
    if let (Interface::Mirror { reflectance, .. }, Colour::Constant(kd)) = (interface, &diffuse)
        && (reflectance + *kd).max_element() > 1.0 + 1e-6
    {
        warn(assembly, "`Kd` and `Ks` sum to more than 1: it gives back more light than it gets")?;
    }
    let highlight = match values.shininess {
        Some(exponent) if exponent > 0.0 && ks != Rgb::ZERO && illum >= 2 => {
            Some(Highlight { colour: ks, exponent: exponent as f32, model: HighlightModel::BlinnPhong })
        }
        _ => None,
    };
    let ambient = if illum == 0 { Rgb::ZERO } else { colour(values.ambient) };
    let name = entry.name.clone();
    Ok(Material { name, ambient, diffuse, highlight, emission, interface, ..Material::default() })
}

fn rgb(colour: [f64; 3]) -> Rgb {
    Rgb::from(colour.map(|c| c as f32))
}

/// Returns the index of a material that needs one.
fn index(entry: &Entry, assembly: &mut Assembly<'_>) -> Result<f64> {
    if let Some((n, line)) = entry.wrong_index {
        return Err(Error::at(
            &entry.file,
            line as usize,
            format!("`Ni {n}`: a refractive index is between 0.001 and 1000"),
        ));
    }
    match entry.values.optical_density {
        Some(n) => Ok(n),
        None => {
            let kind = format!("material `{}` has no refractive index `Ni`; it is 1.5", short(&entry.name));
            assembly.reporter.warn(&entry.file, entry.line as usize, &kind, String::new)?;
            Ok(1.5)
        }
    }
}

/// Returns the diffuse colour. If the file gives none, it is black if `dark`, else mid-grey.
fn base(entry: &Entry, dark: bool, assembly: &mut Assembly<'_>) -> Result<Colour> {
    let kd = entry.values.diffuse.map(rgb);
    if let Some(name) = &entry.values.diffuse_texture {
        match assembly.root.resolve(folder_of(&entry.file), name) {
            Ok(path) => {
                let scale = match kd {
                    // Written by exporters that use the picture alone.
                    Some(Rgb::ZERO) => {
                        warn_of_black_picture(entry, assembly)?;
                        Rgb::ONE
                    }
                    kd => kd.unwrap_or(Rgb::ONE),
                };
                return Ok(Colour::Image { texture: assembly.picture(&path)?, scale });
            }
            Err(e) => picture_left_out(entry, &e, assembly)?,
        }
    }
    let default = if dark { Rgb::ZERO } else { Rgb::splat(0.5) };
    Ok(Colour::Constant(kd.unwrap_or(default)))
}

fn warn_of_black_picture(entry: &Entry, assembly: &mut Assembly<'_>) -> Result<()> {
    let kind = "a picture whose `Kd` is 0 counts as if `Kd` were 1";
    assembly.reporter.warn(&entry.file, entry.picture_line as usize, kind, String::new)
}

fn picture_left_out(entry: &Entry, why: &str, assembly: &mut Assembly<'_>) -> Result<()> {
    let file: &Path = &entry.file;
    assembly.reporter.warn(file, entry.picture_line as usize, &format!("picture left out: {why}"), String::new)
}
