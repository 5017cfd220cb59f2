//! Reader of OBJ models with their MTL materials.
//!
//! A pre-pass (`scan`, `library`) checks every statement, keeps the lines of faces, and writes a text that `tobj`
//! cannot misread. `tobj` then only reads the numbers and indexes the triangles of each material.

mod library;
mod lines;
mod mtl;
mod parts;
pub(super) mod polygon;
mod scan;

use std::collections::HashMap;
use std::path::Path;

use self::library::Library;
use super::assembly::Assembly;
use super::request::Request;
use super::source::folder_of;
use crate::scene::Material;
use crate::system::files::read;
use crate::system::memory;
use crate::{Error, Result};

/// Reads a model into the scene, as one shape per material.
pub(super) fn load(path: &Path, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<()> {
    let limits = assembly.options.limits;
    let bytes = read(path, limits.file_bytes)?;
    let text = text(path, &bytes, assembly)?;
    let scan = scan::scan(path, &text, request.limit, &limits, &mut assembly.reporter)?;
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
        return Err(Error::file(path, no_triangles(&scan, assembly)));
    }
    assembly.take_triangles(parts.iter().map(|p| p.triangles.len() as u64).sum())?;
    let meshes = parts::meshes(path, &scan, &parts, &mut assembly.reporter)?;
    drop(scan);
    for (part, mesh) in parts.into_iter().zip(meshes) {
        let material = assembly.scene.materials[part.group as usize].name.clone();
        let name = request.material.is_none().then_some(material.as_str());
        request.add(path, name, mesh, part.group, part.lines, assembly)?;
    }
    Ok(())
}

/// Decodes the file as text. Bytes that are not UTF-8 can only occur in names and comments.
fn text<'b>(path: &Path, bytes: &'b [u8], assembly: &mut Assembly<'_>) -> Result<std::borrow::Cow<'b, str>> {
    if let Err(e) = std::str::from_utf8(bytes) {
        let at = e.valid_up_to();
        let line = 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
        let kind = "bytes that are not UTF-8 are read as the replacement character";
        assembly.reporter.warn(path, line, kind, || format!(": byte 0x{:02x} at offset {at}", bytes[at]))?;
        // Each such byte becomes three, in a text that grows by doubling.
        let what = format!("the text of {}", path.display());
        memory::need(&what, 6 * bytes.len() as u64, "save the file as UTF-8")?;
    }
    Ok(String::from_utf8_lossy(bytes))
}

/// Returns the material of each name that faces use.
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
            // Read but not used by any face, so its pictures need not exist.
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

/// Returns the message for a model without triangles, which explains the loss of its faces.
fn no_triangles(scan: &scan::Scan, assembly: &Assembly<'_>) -> String {
    match (scan.faces.len(), assembly.reporter.most_dropped()) {
        (0, _) | (_, None) => String::from("has no triangles: there is no face (`f`) in it"),
        (faces, Some(reason)) => format!(
            "has no triangles: all of its faces ({faces}) were left out, most of them for {reason}; corners of a face \
             must be finite, within {:e}, and apart",
            crate::geometry::COORDINATE_LIMIT
        ),
    }
}
