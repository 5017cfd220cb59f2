//! The scene of a single model as a scene file, to be edited.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::bare::{ModelOptions, Up};
use super::source::folder_of;
use super::transform::SCALE_LIMIT;
use super::{LoadOptions, LoadReport, Loaded};
use crate::scene::{Environment, Falloff, LightKind, Projection, Rgb, Scene};
use crate::{Error, Result};

/// Returns the text of a scene file in `folder` that shows the model as [`scene`](super::scene) does, and the report on
/// the model. Rendered, both give the same bytes.
///
/// # Errors
/// As [`scene`](super::scene), and [`Error::Usage`] if the file is no model or too large for a scene file.
pub fn sketch(path: &Path, folder: &Path, options: &LoadOptions) -> Result<(String, LoadReport)> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return Err(Error::Usage(format!("{}: is a scene file already; name a model", path.display())));
    }
    let Loaded { scene, report } = super::scene(path, options)?;
    text(path, folder, &scene, &options.model).map(|text| (text, report))
}

fn text(path: &Path, folder: &Path, scene: &Scene, model: &ModelOptions) -> Result<String> {
    let here = absolute(folder)?;
    let mut roots = Vec::new();
    let mut file = |path: &Path| -> Result<String> {
        let path = absolute(path)?;
        Ok(match path.strip_prefix(&here) {
            Ok(below) => quoted(&below.display().to_string()),
            Err(_) => {
                let root = quoted(&folder_of(&path).display().to_string());
                if !roots.contains(&root) {
                    roots.push(root);
                }
                quoted(&path.display().to_string())
            }
        })
    };
    let name = file(path)?;
    let sky = model.environment.as_deref().map(&mut file).transpose()?;
    // A model of an extreme size has a unit of its own, which its scene has as a scale.
    let unit = scene.unit();
    if !(1.0 / SCALE_LIMIT..=SCALE_LIMIT).contains(&unit) {
        return Err(Error::Usage(format!(
            "{}: is too large or too small for a scene file, which scales by 1e-15 to 1e15; scale the model",
            path.display()
        )));
    }
    let place = |p: glam::Vec3| vector(scene.world(p.as_dvec3()) / unit);
    let mut out = format!("# The scene of {}, as `vitrum scene` wrote it.\n", path.display());
    // Writing to a string cannot fail.
    if !roots.is_empty() {
        let _ = writeln!(out, "\n[files]\nroots = [{}]", roots.join(", "));
    }
    let camera = &scene.camera;
    let _ = writeln!(out, "\n[camera]\neye = {}\ntarget = {}", place(camera.eye), place(camera.target));
    let _ = writeln!(out, "up = {}", vector(camera.up.as_dvec3()));
    let _ = match camera.projection {
        Projection::Pinhole { vfov } => writeln!(out, "fov = {vfov:?}"),
        Projection::Orthographic { height } => writeln!(out, "projection = \"orthographic\"\nheight = {height:?}"),
        Projection::Map(_) => Ok(()),
    };
    let _ = match (&scene.environment, sky) {
        (Environment::Gradient { nadir, horizon, zenith }, _) => writeln!(
            out,
            "\n[environment]\ntype = \"gradient\"\nnadir = {}\nhorizon = {}\nzenith = {}",
            rgb(*nadir),
            rgb(*horizon),
            rgb(*zenith)
        ),
        (_, Some(sky)) => writeln!(out, "\n[environment]\ntype = \"image\"\nfile = {sky}"),
        (Environment::Constant(colour), None) => {
            writeln!(out, "\n[environment]\ntype = \"constant\"\ncolor = {}", rgb(*colour))
        }
        _ => Ok(()),
    };
    for light in &scene.lights {
        let _ = writeln!(out, "\n[[light]]\nname = {}", quoted(&light.name));
        let _ = match light.kind {
            LightKind::Point { position } => writeln!(out, "type = \"point\"\nposition = {}", place(position)),
            LightKind::Directional { direction } => {
                let direction = super::model::direction_of(&light.name).unwrap_or(direction.as_dvec3());
                writeln!(out, "type = \"directional\"\ndirection = {}", vector(direction))
            }
            LightKind::Spot { position, direction, cos_inner, cos_outer } => writeln!(
                out,
                "type = \"spot\"\nposition = {}\ndirection = {}\ninner = {:?}\nouter = {:?}",
                place(position),
                vector(direction.as_dvec3()),
                degrees(cos_inner),
                degrees(cos_outer)
            ),
            // Models have no others.
            LightKind::Sphere { .. } | LightKind::Rectangle { .. } => Ok(()),
        };
        let _ = writeln!(out, "intensity = {}", rgb(light.intensity));
        if light.falloff == Falloff::None {
            out.push_str("falloff = \"none\"\n");
        }
        if !light.shadows {
            out.push_str("shadows = false\n");
        }
    }
    for (name, surface) in &model.materials {
        let _ = write!(out, "\n[[material]]\nname = {}\n{}", quoted(name), surface.toml());
    }
    let _ = writeln!(out, "\n[[mesh]]\nfile = {name}");
    if let Some(angle) = model.smooth {
        let _ = writeln!(out, "smooth = {angle:?}");
    }
    let scale = (scene.unit_exponent != 0).then(|| format!("scale = {:?}", 1.0 / unit));
    let turn = (model.up == Up::Z).then(|| format!("rotate = {}", vector(model.up.turn())));
    let transform: Vec<String> = [scale, turn].into_iter().flatten().collect();
    if !transform.is_empty() {
        let _ = writeln!(out, "transform = {{ {} }}", transform.join(", "));
    }
    if !model.materials.is_empty() {
        let pairs: Vec<String> = model.materials.iter().map(|(name, _)| format!("{0} = {0}", quoted(name))).collect();
        let _ = writeln!(out, "materials = {{ {} }}", pairs.join(", "));
    }
    Ok(out)
}

fn absolute(path: &Path) -> Result<PathBuf> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    std::fs::canonicalize(path).map_err(|e| Error::io(path, "read", e))
}

/// Returns a text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Returns the half angle of a cone, in degrees.
fn degrees(cos: f32) -> f64 {
    f64::from(cos).clamp(0.0, 1.0).acos().to_degrees()
}

fn vector(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

fn rgb(c: Rgb) -> String {
    format!("[{:?}, {:?}, {:?}]", c.x, c.y, c.z)
}
