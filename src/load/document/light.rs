//! Reader of `[[light]]`.

use glam::DVec3;

use super::table::{Table, Value};
use crate::Result;
use crate::load::origin::Frame;
use crate::load::transform::sin_cos_degrees;
use crate::scene::ranges::LEAST_SINE_OF_EDGES;
use crate::scene::{Falloff, Light, LightKind, Spread};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Point,
    Spot,
    Directional,
    Sphere,
    Rectangle,
}

/// Reads the `i`th light and converts positions to `frame`.
pub(super) fn light(table: &Table<'_>, i: usize, frame: Frame) -> Result<Light> {
    let name = table.opt("name", |v| v.text().map(str::to_owned))?.unwrap_or_else(|| format!("light {}", i + 1));
    let kinds = [
        ("point", Kind::Point),
        ("spot", Kind::Spot),
        ("directional", Kind::Directional),
        ("sphere", Kind::Sphere),
        ("rectangle", Kind::Rectangle),
    ];
    let position = || table.need("position")?.place().map(|p| frame.local(p));
    let kind = match table.need("type")?.choice(&kinds)? {
        Kind::Point => LightKind::Point { position: position()?.as_vec3() },
        Kind::Spot => {
            let position = position()?;
            let direction = direction(table, position, frame)?.as_vec3();
            let half = |key, default: f64| {
                table.or(key, default, |v| v.number_where("from 0 to 90 degrees", |x| (0.0..=90.0).contains(&x)))
            };
            let (inner, outer) = (half("inner", 20.0)?, half("outer", 30.0)?);
            if inner > outer {
                return Err(table.error(format!(
                    "the spot's inner half angle, {inner}, exceeds its outer one, {outer}; exchange them"
                )));
            }
            let cos = |degrees: f64| sin_cos_degrees(degrees).1 as f32;
            LightKind::Spot { position: position.as_vec3(), direction, cos_inner: cos(inner), cos_outer: cos(outer) }
        }
        Kind::Directional => {
            LightKind::Directional { direction: direction(table, frame.local(DVec3::ZERO), frame)?.as_vec3() }
        }
        Kind::Sphere => {
            LightKind::Sphere { position: position()?.as_vec3(), radius: table.need("radius")?.positive()? as f32 }
        }
        Kind::Rectangle => rectangle(table, position()?, frame)?,
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

/// Smallest sine of the angle between a rectangle's plane and the direction in which it shines.
const LEAST_LIFT: f64 = 1e-3;

/// Reads a rectangle: its middle, its two edges, and the emitting side if the order of the edges does not define it.
fn rectangle(table: &Table<'_>, position: DVec3, frame: Frame) -> Result<LightKind> {
    let given = table.need("edges")?;
    let list = given.list()?;
    let [first, second] = list.as_slice() else {
        return Err(given.error(format!("`edges` are two vectors, not {}: [[x, y, z], [x, y, z]]", list.len())));
    };
    let mut edges = [first.place()?, second.place()?];
    let normal = edges[0].cross(edges[1]);
    let fits = normal.length() > LEAST_SINE_OF_EDGES * edges[0].length() * edges[1].length();
    let has_area_in_f32 = normal.as_vec3().length_squared() > 0.0;
    if !fits || !has_area_in_f32 {
        let message = format!(
            "the rectangle's edges, {} and {}, are parallel, so it has no area; turn one of them",
            edges[0], edges[1]
        );
        return Err(given.error(message));
    }
    let spread =
        table.or("spread", Spread::Cosine, |v| v.choice(&[("cosine", Spread::Cosine), ("even", Spread::Even)]))?;
    if let Some(aim) = table.get("direction").or_else(|| table.get("target")) {
        let lift = direction(table, position, frame)?.dot(normal.normalize());
        if lift.abs() < LEAST_LIFT {
            return Err(aim.error("the direction of the rectangle's light lies in its own plane; turn its edges"));
        }
        if lift < 0.0 {
            edges.swap(0, 1);
        }
    }
    let corner = position - (edges[0] + edges[1]) * 0.5;
    Ok(LightKind::Rectangle { corner: corner.as_vec3(), edges: edges.map(|e| e.as_vec3()), spread })
}

/// Reads the direction of a light: `direction`, or from `position`, in `frame`, towards `target`.
fn direction(table: &Table<'_>, position: DVec3, frame: Frame) -> Result<DVec3> {
    let (given, target) = (table.get("direction"), table.get("target"));
    match (given, target) {
        (Some(v), None) => v.direction(),
        (None, Some(v)) => {
            // A directional light may have a position, from which it points to the target.
            let from = table.opt("position", Value::place)?.map_or(position, |p| frame.local(p));
            let way = frame.shifted(v.triple()?) - from;
            way.try_normalize().ok_or_else(|| {
                v.error(format!("the light's target is its position, {}; move one of them", frame.world(from)))
            })
        }
        (Some(_), Some(v)) => Err(v.error("a light has either a `direction` or a `target`, not both")),
        (None, None) => Err(table.error("the light needs a `direction` or a `target`; give one of them")),
    }
}
