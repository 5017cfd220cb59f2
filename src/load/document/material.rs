//! Reader of `[[material]]`.

use glam::DVec3;

use super::Reader;
use super::refraction::{index, ior};
use super::table::{Table, Value};
use crate::Result;
use crate::load::assembly::Assembly;
use crate::load::catalogue;
use crate::optics::absorption_from_colour;
use crate::scene::{Colour, FresnelRule, Highlight, HighlightModel, Interface, Material, Medium, MirrorSource, Rgb};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Diffuse,
    Emissive,
    Mirror,
    Conductor,
    Dielectric,
    Thin,
    Coated,
    Alpha,
}

const KINDS: [(&str, Kind); 8] = [
    ("diffuse", Kind::Diffuse),
    ("emissive", Kind::Emissive),
    ("mirror", Kind::Mirror),
    ("conductor", Kind::Conductor),
    ("dielectric", Kind::Dielectric),
    ("thin", Kind::Thin),
    ("coated", Kind::Coated),
    ("alpha", Kind::Alpha),
];

/// Reads a material whose name is known.
pub(super) fn material<'d>(
    reader: &Reader<'d>,
    table: &Table<'d>,
    name: &str,
    assembly: &mut Assembly<'_>,
) -> Result<Material> {
    let kind = table.need("type")?.choice(&KINDS)?;
    let interface = match kind {
        Kind::Diffuse | Kind::Emissive => Interface::Opaque,
        Kind::Mirror => Interface::Mirror {
            reflectance: table.or("reflectance", Rgb::ONE, Value::share)?,
            source: MirrorSource::Traced,
        },
        Kind::Conductor => conductor(table)?,
        Kind::Dielectric => {
            let (ior, dispersion) = index(table)?;
            let medium = Medium {
                name: name.to_owned(),
                ior,
                dispersion,
                absorption: absorption(table)?,
                priority: table.or("priority", 0, Value::signed)?,
            };
            Interface::Dielectric {
                medium: assembly.add_medium(medium),
                rule: FresnelRule::Fresnel,
                tint: table.or("tint", Rgb::ONE, Value::share)?,
            }
        }
        Kind::Thin => Interface::ThinDielectric {
            ior: ior(table, None)? as f32,
            rule: FresnelRule::Fresnel,
            tint: table.or("tint", Rgb::ONE, Value::share)?,
        },
        Kind::Coated => Interface::Coated { ior: ior(table, Some(1.5))? as f32 },
        Kind::Alpha => Interface::Alpha {
            opacity: table.need("opacity")?.number_where("from 0 to 1", |x| (0.0..=1.0).contains(&x))? as f32,
            mask: None,
        },
    };
    let diffuse = match kind {
        Kind::Diffuse | Kind::Coated | Kind::Alpha => base(reader, table, Rgb::splat(0.5), assembly)?,
        Kind::Mirror => base(reader, table, Rgb::ZERO, assembly)?,
        _ => Colour::Constant(Rgb::ZERO),
    };
    let emission = match kind {
        Kind::Emissive => table.need("emission")?.colour()?,
        _ => table.or("emission", Rgb::ZERO, Value::colour)?,
    };
    let material = Material {
        name: name.to_owned(),
        ambient: table.or("ambient", Rgb::ZERO, Value::colour)?,
        diffuse,
        highlight: table.opt("highlight", |v| highlight(&v.table("highlight")?))?,
        emission,
        glow: None,
        relief: None,
        interface,
    };
    table.finish()?;
    warn_of_gain(reader, table, &material, assembly)?;
    Ok(material)
}

fn conductor(table: &Table<'_>) -> Result<Interface> {
    match (table.get("metal"), table.get("eta"), table.get("k")) {
        (Some(v), None, None) => {
            let metal = catalogue::metal(v.text()?).map_err(|e| v.error(e))?;
            Ok(Interface::Conductor { eta: metal.eta, k: metal.k })
        }
        (None, Some(eta), Some(k)) => {
            let value = eta.colour()?;
            if value.min_element() < 1e-3 || value.max_element() > 1e3 {
                return Err(eta.error(format!("`eta` is {value}; it must be between 0.001 and 1000")));
            }
            let extinction = k.colour()?;
            if extinction.max_element() > 1e3 {
                return Err(k.error(format!("`k` is {extinction}; it must be at most 1000")));
            }
            Ok(Interface::Conductor { eta: value, k: extinction })
        }
        _ => Err(table.error("a conductor needs either `metal`, or both `eta` and `k`")),
    }
}

/// Reads the absorption: `absorption`, or the `color` left after `distance`.
fn absorption(table: &Table<'_>) -> Result<Rgb> {
    let distance = table.get("distance");
    match (table.get("absorption"), table.get("color")) {
        (Some(_), Some(v)) => Err(v.error("give either `absorption` or `color` at a `distance`, not both")),
        (absorption, None) => {
            if let Some(v) = distance {
                return Err(
                    v.error("`distance` needs a `color`, which is left after it; give one, or leave `distance` out")
                );
            }
            absorption.map_or(Ok(Rgb::ZERO), |v| v.colour())
        }
        (None, Some(v)) => {
            let over = distance.map(|d| d.positive()).transpose()?.unwrap_or(1.0) as f32;
            Ok(absorption_from_colour(v.share()?, over))
        }
    }
}

/// Reads the diffuse colour: `color`, `texture` or `checker`.
fn base<'d>(reader: &Reader<'d>, table: &Table<'d>, default: Rgb, assembly: &mut Assembly<'_>) -> Result<Colour> {
    let (color, texture, checker) = (table.get("color"), table.get("texture"), table.get("checker"));
    if let (Some(_), Some(v)) = (&texture, &checker) {
        return Err(v.error("give either `texture` or `checker`, not both"));
    }
    if let Some(v) = texture {
        let path = reader.path(&v, assembly)?;
        let scale = color.map_or(Ok(Rgb::ONE), |c| c.share())?;
        return Ok(Colour::Image { texture: assembly.picture(&path)?, scale });
    }
    if let Some(v) = checker {
        if let Some(c) = color {
            return Err(c.error("give either `color` or `checker`, not both"));
        }
        let table = v.table("checker")?;
        let (even, odd) = (table.need("even")?.share()?, table.need("odd")?.share()?);
        let size = table.or("size", 1.0, Value::positive)?;
        let corner = table.or("offset", DVec3::ZERO, Value::place)?;
        table.finish()?;
        assembly.add_checker(corner, size);
        let colour = Colour::Checker { even, odd, size: size as f32, offset: corner.as_vec3() };
        return Ok(colour);
    }
    color.map_or(Ok(default), |c| c.share()).map(Colour::Constant)
}

fn highlight(table: &Table<'_>) -> Result<Highlight> {
    let highlight = Highlight {
        colour: table.or("color", Rgb::ONE, Value::colour)?,
        exponent: table.need("exponent")?.number_where("from 0 to 1e6", |x| (0.0..=1e6).contains(&x))? as f32,
        model: table.or("model", HighlightModel::Phong, |v| {
            v.choice(&[("phong", HighlightModel::Phong), ("blinn-phong", HighlightModel::BlinnPhong)])
        })?,
    };
    table.finish()?;
    Ok(highlight)
}

/// Warns about a mirror that reflects more light than it receives.
fn warn_of_gain(
    reader: &Reader<'_>,
    table: &Table<'_>,
    material: &Material,
    assembly: &mut Assembly<'_>,
) -> Result<()> {
    if let (Interface::Mirror { reflectance, .. }, Colour::Constant(diffuse)) = (material.interface, &material.diffuse)
    {
        let sum = (reflectance + *diffuse).max_element();
        if sum > 1.0 + 1e-6 {
            let line = reader.source.line(table.span.start);
            let kind = format!(
                "material `{}` gives back more light than it gets: its reflectance and colour sum to {sum}",
                material.name
            );
            assembly.reporter.warn(reader.source.file, line, &kind, String::new)?;
        }
    }
    Ok(())
}
