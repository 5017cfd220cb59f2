//! `vitrum info`.

pub(super) mod args;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use self::args::InfoArgs;
use super::options::Reading;
use super::verdict::Verdict;
use super::{backend, output};
use crate::Result;
use crate::load::{LoadReport, Loaded};
use crate::scene::{Colour, Interface, Scene};

/// Content of a file. Its JSON form is this, with the same names.
#[derive(Debug, serde::Serialize)]
struct Info {
    file: String,
    /// Corners of the box around all shapes but planes, in world coordinates; none if there is no such shape.
    bounds: Option<[[f64; 3]; 2]>,
    triangles: usize,
    objects: Vec<Object>,
    materials: Vec<Material>,
    /// Pictures, and the bytes that they take.
    pictures: Vec<Picture>,
    /// Faces that were left out, by reason.
    left_out: BTreeMap<&'static str, u64>,
    warnings: Vec<String>,
}

#[derive(Debug, serde::Serialize)]
struct Object {
    name: String,
    material: String,
    /// `mesh`, `sphere` or `plane`.
    shape: &'static str,
    triangles: usize,
    normals: bool,
    texture_coordinates: bool,
    colours: bool,
}

#[derive(Debug, serde::Serialize)]
struct Material {
    name: String,
    surface: &'static str,
    base: &'static str,
}

#[derive(Debug, serde::Serialize)]
struct Picture {
    file: String,
    width: u32,
    height: u32,
    bytes: usize,
}

/// Loads and tells.
pub(super) fn run(args: InfoArgs) -> Result<Verdict> {
    backend::start_threads(0)?;
    let Loaded { scene, report } = Reading::from(args.options).load(&args.scene, args.strict.strict)?;
    let info = Info::of(&args.scene, &scene, &report);
    if args.json {
        output::print_json(&info)?;
    } else {
        output::print(&info.text())?;
    }
    Ok(Verdict::Done)
}

impl Info {
    fn of(file: &Path, scene: &Scene, report: &LoadReport) -> Self {
        let object = |(i, object): (usize, &crate::scene::Object)| {
            let content = scene.content(i);
            Object {
                name: object.name.clone(),
                material: scene.materials[object.material as usize].name.clone(),
                shape: content.kind,
                triangles: content.triangles,
                normals: content.normals,
                texture_coordinates: content.uvs,
                colours: content.colours,
            }
        };
        let objects: Vec<Object> = scene.objects.iter().enumerate().map(object).collect();
        let material = |m: &crate::scene::Material| Material {
            name: m.name.clone(),
            surface: surface(&m.interface),
            base: match m.diffuse {
                Colour::Constant(c) if c == crate::scene::Rgb::ZERO => "black",
                Colour::Constant(_) => "colour",
                Colour::Image { .. } => "picture",
                Colour::Corners { .. } => "colours of corners",
                Colour::Checker { .. } => "checker",
            },
        };
        let picture = |t: &crate::scene::Texture| Picture {
            file: t.name.clone(),
            width: t.width,
            height: t.height,
            bytes: t.pixels.bytes(),
        };
        Self {
            file: file.display().to_string(),
            bounds: scene.bounds().map(|corners| corners.map(|p| p.to_array())),
            triangles: objects.iter().map(|o| o.triangles).sum(),
            objects,
            materials: scene.materials.iter().map(material).collect(),
            pictures: scene.textures.iter().map(picture).collect(),
            left_out: report.dropped.clone(),
            warnings: report.warnings.iter().map(ToString::to_string).collect(),
        }
    }

    fn text(&self) -> String {
        let mut out = format!("{}\n", self.file);
        // Writing to a string cannot fail.
        if let Some([lo, hi]) = self.bounds {
            let [lo, hi] = [lo, hi].map(|corner| corner.map(shortest).join(", "));
            let _ = writeln!(out, "bounds     [{lo}] to [{hi}]");
        }
        let _ = writeln!(out, "triangles  {}", self.triangles);
        for o in &self.objects {
            let has = [(o.normals, "normals"), (o.texture_coordinates, "texture coordinates"), (o.colours, "colours")];
            let has: Vec<&str> = has.into_iter().filter(|(there, _)| *there).map(|(_, name)| name).collect();
            let with = if has.is_empty() { String::new() } else { format!(", with {}", has.join(", ")) };
            let _ = match o.shape {
                "mesh" => writeln!(out, "object     {}: {} triangles of `{}`{with}", o.name, o.triangles, o.material),
                shape => writeln!(out, "object     {}: {shape} of `{}`", o.name, o.material),
            };
        }
        for m in &self.materials {
            let _ = writeln!(out, "material   {}: {}, {}", m.name, m.surface, m.base);
        }
        for p in &self.pictures {
            let _ = writeln!(out, "picture    {}: {} x {}, {} bytes", p.file, p.width, p.height, p.bytes);
        }
        for (reason, count) in &self.left_out {
            let _ = writeln!(out, "left out   {count} faces for {reason}");
        }
        for warning in &self.warnings {
            let _ = writeln!(out, "warning    {}", output::one_line(warning));
        }
        out
    }
}

/// Returns a coordinate with the digits that its precision needs.
fn shortest(x: f64) -> String {
    let narrow = x as f32;
    if f64::from(narrow) == x { format!("{narrow:?}") } else { format!("{x:?}") }
}

fn surface(interface: &Interface) -> &'static str {
    match interface {
        Interface::Opaque => "opaque",
        Interface::Mirror { .. } => "mirror",
        Interface::Conductor { .. } => "metal",
        Interface::Dielectric { .. } => "glass",
        Interface::ThinDielectric { .. } => "thin pane",
        Interface::Coated { .. } => "coated",
        Interface::Alpha { mask: Some(_), .. } => "cut-out",
        Interface::Alpha { .. } => "cover with holes",
    }
}
