//! OBJ models with their MTL materials.
//!
//! `tobj` reads them, behind a pre-pass of our own (`scan`, `library`) that checks every statement, keeps the lines
//! of faces, and writes a text that `tobj` cannot misread. What `tobj` is left to do is read the numbers and index
//! the triangles of each material.

mod library;
mod lines;
mod mtl;
mod parts;
mod polygon;
mod scan;

use std::collections::HashMap;
use std::path::Path;

use self::library::Library;
use super::assembly::Assembly;
use super::smooth::smooth;
use super::source::{folder_of, read};
use super::transform::{Transform, flip};
use crate::geometry::{Shape, TriMesh};
use crate::scene::{Material, Origin};
use crate::{Error, Result};

/// How a model is taken into a scene.
pub(super) struct Request<'a> {
    /// What messages call it.
    pub name: String,
    /// The material of all of it; its own where none is given.
    pub material: Option<u32>,
    /// Bend in degrees up to which faces without normals are shaded smoothly; flat where none is given.
    pub smooth: Option<f64>,
    /// Whether to turn it inside out.
    pub flip: bool,
    /// Where it is put.
    pub transform: Transform,
    /// The error that says what is wrong with the transform, at its own place.
    pub wrong_transform: &'a dyn Fn(String) -> Error,
}

/// Reads a model into the scene: one shape a material.
pub(super) fn load(path: &Path, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<()> {
    let limits = assembly.options.limits;
    let bytes = read(path, limits.file_bytes)?;
    let text = text(path, &bytes, assembly)?;
    let scan = scan::scan(path, &text, &limits, &mut assembly.reporter)?;
    drop(text);
    drop(bytes);

    let materials = match request.material {
        Some(material) => vec![material; scan.uses.len()],
        None => materials(path, &scan, assembly)?,
    };
    let dropped_before = assembly.reporter.dropped_so_far();
    let parts = parts::parts(path, &scan, &materials, &mut assembly.reporter)?;
    assembly.reporter.model(path, scan.faces.len(), dropped_before);
    if parts.is_empty() {
        return Err(Error::file(path, "has no triangles"));
    }
    assembly.take_triangles(parts.iter().map(|p| p.triangles.len() as u64).sum())?;
    let meshes = parts::meshes(path, &scan, &parts, &mut assembly.reporter)?;
    drop(scan);
    for (part, mut mesh) in parts.into_iter().zip(meshes) {
        place(request, &mut mesh)?;
        let material = &assembly.scene.materials[part.group as usize].name;
        let name =
            if request.material.is_some() { request.name.clone() } else { format!("{}/{material}", request.name) };
        let origin = Origin { file: path.display().to_string(), line: 0, triangle_lines: part.lines };
        assembly.add(name, Shape::Mesh(mesh), part.group, origin)?;
    }
    Ok(())
}

/// The file as text; what is not UTF-8 can only be in names and comments.
fn text<'b>(path: &Path, bytes: &'b [u8], assembly: &mut Assembly<'_>) -> Result<std::borrow::Cow<'b, str>> {
    if let Err(e) = std::str::from_utf8(bytes) {
        let at = e.valid_up_to();
        let line = 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
        let kind = "bytes that are not UTF-8 are read as the replacement character";
        assembly.reporter.warn(path, line, kind, || format!(": byte 0x{:02x} at offset {at}", bytes[at]))?;
    }
    Ok(String::from_utf8_lossy(bytes))
}

/// The material of each name that faces use.
fn materials(path: &Path, scan: &scan::Scan, assembly: &mut Assembly<'_>) -> Result<Vec<u32>> {
    let mut library = Library::default();
    for (name, line) in &scan.libraries {
        match assembly.root.resolve(folder_of(path), name) {
            Ok(file) => library.read(&file, assembly)?,
            Err(e) => {
                let kind = format!("material file left out: {e}");
                assembly.reporter.warn(path, *line as usize, &kind, String::new)?;
            }
        }
    }
    let used: Vec<bool> = {
        let mut used = vec![false; scan.uses.len()];
        scan.faces.iter().for_each(|f| used[f.material as usize] = true);
        used
    };
    let mut default = None;
    let mut made: HashMap<&str, u32> = HashMap::new();
    let mut places = Vec::with_capacity(scan.uses.len());
    for ((name, line), used) in scan.uses.iter().zip(used) {
        let known = library.find(name);
        let place = match known {
            // Read but drawn by no face: its pictures need not even be there.
            _ if !used => 0,
            Some(entry) => match made.get(name.as_str()) {
                Some(&place) => place,
                None => {
                    let material = mtl::material(entry, assembly)?;
                    let place = assembly.add_material(material)?;
                    made.insert(name, place);
                    place
                }
            },
            None => {
                if !name.is_empty() {
                    let kind = format!("no material is called `{}`; the default one is used", scan::short(name));
                    assembly.reporter.warn(path, *line as usize, &kind, String::new)?;
                }
                match default {
                    Some(place) => place,
                    None => *default.insert(assembly.add_material(Material::default())?),
                }
            }
        };
        places.push(place);
    }
    Ok(places)
}

/// Moves, smooths and turns over one mesh of a model.
fn place(request: &Request<'_>, mesh: &mut TriMesh) -> Result<()> {
    request.transform.mesh(mesh).map_err(request.wrong_transform)?;
    if let (Some(crease), true) = (request.smooth, mesh.normals.is_empty()) {
        smooth(mesh, crease);
    }
    if request.flip {
        flip(mesh);
    }
    Ok(())
}
