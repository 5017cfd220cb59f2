//! Reader of `[camera]` and `[render]`.

use glam::{DVec3, Vec3};

use super::Names;
use super::table::{Table, Value};
use crate::load::LoadOptions;
use crate::load::assembly::Assembly;
use crate::load::origin::Frame;
use crate::optics::FEWEST_BANDS;
use crate::scene::ranges::{LEAST_SINE_OF_UP, LIGHT_SAMPLES, MOST_DEPTH, MOST_WAVELENGTHS, SAMPLES};
use crate::scene::{Camera, LampChoice, LampSampling, LightsFrom, Pattern, Projection, Settings, ShadowRule};
use crate::{Error, Result};

/// Returns eye and target in world coordinates.
pub(super) fn line_of_sight(table: Option<&Table<'_>>) -> Result<[DVec3; 2]> {
    let default = Camera::default();
    let (eye, target) = (default.eye.as_dvec3(), default.target.as_dvec3());
    let Some(table) = table else { return Ok([eye, target]) };
    Ok([table.or("eye", eye, Value::place)?, table.or("target", target, Value::place)?])
}

/// Reads `[camera]` and converts positions to `frame`.
pub(super) fn camera(
    table: Option<&Table<'_>>,
    frame: Frame,
    names: &Names,
    assembly: &mut Assembly<'_>,
) -> Result<Camera> {
    let sight = line_of_sight(table)?;
    let [eye, target] = sight.map(|p| frame.local(p).as_vec3());
    let default = Camera { eye, target, ..Camera::default() };
    let Some(table) = table else { return Ok(default) };
    let up = table.or("up", default.up, |v| v.direction().map(|d| d.as_vec3()))?;
    let orthographic = table.or("projection", false, |v| v.choice(&[("pinhole", false), ("orthographic", true)]))?;
    let projection = if orthographic {
        Projection::Orthographic { height: table.or("height", 2.0, Value::positive)? as f32 }
    } else {
        let fits = |x: f64| (x as f32) > 0.0 && (x as f32) < 180.0;
        Projection::Pinhole {
            vfov: table.or("fov", 40.0, |v| v.number_where("above 0 and below 180 degrees", fits))? as f32,
        }
    };
    let medium = table.opt("medium", |v| names.medium(v, assembly))?;
    table.finish()?;

    let view = target.as_dvec3() - eye.as_dvec3();
    if view.length() <= f64::from(f32::EPSILON) * f64::from(eye.abs().max_element()) {
        let message = format!("the camera's eye and target are the same point, {}; move one of them", sight[0]);
        return Err(table.get("target").map_or_else(|| table.error(&message), |v| v.error(&message)));
    }
    let view = view.normalize();
    let mut camera = Camera { eye, target, up, projection, medium };
    if view.cross(up.as_dvec3()).length() < LEAST_SINE_OF_UP {
        camera.up = across(view);
        let span = table.get("up").or_else(|| table.get("target")).map_or(table.span.clone(), |v| v.span());
        let kind = format!(
            "the camera's up, {up}, is along its view, {}: {} is up instead; give another `up`",
            view.as_vec3(),
            camera.up
        );
        assembly.reporter.warn(table.source.file, table.source.line(span.start), &kind, String::new)?;
    }
    Ok(camera)
}

/// Returns a default up direction for a view that is parallel to the given `up`. It is +y, or -z if the view is within
/// 45 degrees of the y axis, so that a map seen from above has x to the right.
fn across(view: DVec3) -> Vec3 {
    if view.y.abs() > std::f64::consts::FRAC_1_SQRT_2 { Vec3::NEG_Z } else { Vec3::Y }
}

/// Reads `[render]`.
pub(super) fn settings(table: &Table<'_>, options: &LoadOptions) -> Result<Settings> {
    let default = Settings::default();
    let settings = Settings {
        width: table.or("width", default.width, |v| v.whole(1..=u32::MAX))?,
        height: table.or("height", default.height, |v| v.whole(1..=u32::MAX))?,
        samples: table.or("samples", default.samples, |v| v.whole(SAMPLES))?,
        max_depth: table.or("depth", default.max_depth, |v| v.whole(0..=MOST_DEPTH))?,
        cutoff: table
            .or("cutoff", f64::from(default.cutoff), |v| v.number_where("from 0 to 1", |x| (0.0..=1.0).contains(&x)))?
            as f32,
        shadows: table.or("shadows", default.shadows, |v| {
            v.choice(&[("straight", ShadowRule::Straight), ("opaque", ShadowRule::Opaque)])
        })?,
        lamps: lamps(table, default.lamps)?,
        lights_from: table
            .or("lights_from", default.lights_from, |v| v.choice(&LightsFrom::ALL.map(|from| (from.name(), from))))?,
        lamp_choice: table
            .or("lamps", default.lamp_choice, |v| v.choice(&LampChoice::ALL.map(|choice| (choice.name(), choice))))?,
        shine_shadows: default.shine_shadows,
        wavelengths: table.or("wavelengths", default.wavelengths, |v| v.whole(FEWEST_BANDS..=MOST_WAVELENGTHS))?,
    };
    table.finish()?;
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    if pixels > options.limits.film_pixels {
        let place = table.source.error(&table.span, format!("{} by {} pixels", settings.width, settings.height));
        return Err(Error::Limit(format!("{place} are more than the {} allowed", options.limits.film_pixels)));
    }
    Ok(settings)
}

fn lamps(table: &Table<'_>, default: LampSampling) -> Result<LampSampling> {
    let count = table.get("light_samples");
    let lamps = LampSampling {
        count: count.as_ref().map_or(Ok(default.count), |v| v.whole(LIGHT_SAMPLES))?,
        pattern: table.or("light_pattern", default.pattern, |v| {
            v.choice(&[("sobol", Pattern::Sobol), ("grid", Pattern::Grid)])
        })?,
        seed: table.or("light_seed", default.seed, |v| v.whole(0..=u32::MAX))?,
        probe: table.or("penumbra", default.probe, |v| v.choice(&[("probed", true), ("full", false)]))?,
    };
    let side = lamps.count.isqrt();
    if lamps.pattern == Pattern::Grid && side * side != lamps.count {
        let message = format!(
            "{} `light_samples` do not form a square grid; take {} or {}",
            lamps.count,
            side * side,
            (side + 1) * (side + 1)
        );
        return Err(count.map_or_else(|| table.error(&message), |v| v.error(&message)));
    }
    Ok(lamps)
}
