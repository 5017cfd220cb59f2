//! `[[light]]`.

use glam::{DVec3, Vec3};

use super::table::{Table, Value};
use crate::Result;
use crate::load::transform::sin_cos_degrees;
use crate::scene::{Falloff, Light, LightKind};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Point,
    Spot,
    Directional,
}

/// Reads the `i`th light.
pub(super) fn light(table: &Table<'_>, i: usize) -> Result<Light> {
    let name = table.opt("name", |v| v.text().map(str::to_owned))?.unwrap_or_else(|| format!("light {}", i + 1));
    let kinds = [("point", Kind::Point), ("spot", Kind::Spot), ("directional", Kind::Directional)];
    let kind = match table.need("type")?.choice(&kinds)? {
        Kind::Point => LightKind::Point { position: table.need("position")?.point()? },
        Kind::Spot => {
            let position = table.need("position")?.point()?;
            let direction = direction(table, position)?.as_vec3();
            let half = |key, default: f64| {
                table.or(key, default, |v| v.number_where("from 0 to 90 degrees", |x| (0.0..=90.0).contains(&x)))
            };
            let (inner, outer) = (half("inner", 20.0)?, half("outer", 30.0)?);
            if inner > outer {
                return Err(
                    table.error(format!("the spot's inner half angle, {inner}, exceeds its outer one, {outer}"))
                );
            }
            let cos = |degrees: f64| sin_cos_degrees(degrees).1 as f32;
            LightKind::Spot { position, direction, cos_inner: cos(inner), cos_outer: cos(outer) }
        }
        Kind::Directional => LightKind::Directional { direction: direction(table, Vec3::ZERO)?.as_vec3() },
    };
    let light = Light {
        name,
        kind,
        intensity: table.need("intensity")?.colour()?,
        falloff: table.or("falloff", Falloff::InverseSquare, |v| {
            v.choice(&[("inverse-square", Falloff::InverseSquare), ("none", Falloff::None)])
        })?,
        shadows: table.or("shadows", true, Value::boolean)?,
    };
    table.finish()?;
    Ok(light)
}

/// Where the light goes: along `direction`, or from `position` towards `target`.
fn direction(table: &Table<'_>, position: Vec3) -> Result<DVec3> {
    let (given, target) = (table.get("direction"), table.get("target"));
    match (given, target) {
        (Some(v), None) => v.direction(),
        (None, Some(v)) => {
            // A directional light may say where it seems to come from.
            let from = table.or("position", position, Value::point)?;
            let way = v.triple()? - from.as_dvec3();
            way.try_normalize().ok_or_else(|| v.error(format!("the light's target is its position, {from}")))
        }
        (Some(_), Some(v)) => Err(v.error("a light has either a direction or a target, not both")),
        (None, None) => Err(table.error("the light needs a direction or a target")),
    }
}
