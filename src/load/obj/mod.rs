//! Reader of OBJ models with their MTL materials.
//!
//! Blocks of the file are parsed side by side (`block`, `scan`), faces are cut into triangles and sorted by material
//! (`parts`). `library` checks the statements of MTL files, whose numbers `tobj` reads, and `mtl` makes materials of them.

mod block;
mod corner;
mod library;
mod lines;
mod map;
mod mtl;
mod names;
mod notes;
mod number;
mod parts;
pub(super) mod polygon;
mod scan;
mod statement;
mod text;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use self::library::Library;
use self::mtl::Made;
use self::names::{cleaned, files, split};
use self::scan::Scan;
use self::text::{is_utf16, short, shown, unmarked};
use super::assembly::Assembly;
use super::holds;
use super::request::{Request, UNNAMED};
use super::source::folder_of;
use crate::geometry::TriMesh;
use crate::scene::{Colour, Material, Rgb};
use crate::system::files::read;
use crate::system::memory;
use crate::{Error, Result};

/// Number of warnings that the error for a model without triangles repeats.
const MOST_REPEATED: usize = 5;

/// Reads a model into the scene, as one shape per material. Returns the names of its materials.
pub(super) fn load(path: &Path, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<Vec<String>> {
    let limits = assembly.options.limits;
    let bytes = read(path, limits.file_bytes)?;
    if is_utf16(&bytes) {
        let what = format!("the text of {}", path.display());
        memory::need(&what, 2 * bytes.len() as u64, "save the file as UTF-8")?;
    }
    let text = unmarked(&bytes);
    let mut scan = scan::scan(path, &text, request.limit, &limits, &mut assembly.reporter)?;
    let holds = if scan.faces.is_empty() { holds::content(&bytes) } else { None };
    drop(text);
    drop(bytes);

    let made = match request.material {
        Some(material) => {
            scan.colours = Vec::new();
            vec![Used { place: material, uv: None }; scan.uses.len()]
        }
        None => materials(path, &scan, request, assembly)?,
    };
    let mut used = vec![false; scan.uses.len()];
    scan.faces.iter().for_each(|f| used[f.material as usize] = true);
    let named = std::iter::zip(&scan.uses, used).filter(|(_, used)| *used).map(|((name, _), _)| shown(&cleaned(name)));
    let names = named.map(|n| if n.is_empty() { String::from(UNNAMED) } else { n }).collect();
    let dropped_before = assembly.reporter.dropped_so_far();
    let groups: Vec<u32> = made.iter().map(|m| m.place).collect();
    let parts = parts::parts(path, &scan, &groups, &mut assembly.reporter)?;
    assembly.reporter.model(path, scan.faces.len(), dropped_before);
    if parts.is_empty() {
        return Err(Error::file(path, no_triangles(path, &scan, holds, assembly)));
    }
    assembly.take_triangles(parts.iter().map(|p| p.count() as u64).sum())?;
    let meshes = parts::meshes(path, &scan, parts, &mut assembly.reporter)?;
    drop(scan);
    for (group, mut mesh, lines) in meshes {
        if let Some(change) = made.iter().filter(|m| m.place == group).find_map(|m| m.uv) {
            move_uvs(&mut mesh.mesh, change);
        }
        let material = assembly.scene.materials[group as usize].name.clone();
        let name = request.material.is_none().then_some(material.as_str());
        request.add(path, name, mesh, group, lines, assembly)?;
    }
    Ok(names)
}

/// Material of the scene for a name of the model.
#[derive(Clone, Copy)]
struct Used {
    place: u32,
    uv: Option<[[f32; 2]; 2]>,
}

/// Applies a factor and a shift to texture coordinates.
fn move_uvs(mesh: &mut TriMesh, [scale, offset]: [[f32; 2]; 2]) {
    for uv in &mut mesh.uvs {
        *uv = *uv * glam::Vec2::from(scale) + glam::Vec2::from(offset);
    }
}

/// Returns the material of each name that faces use.
fn materials(path: &Path, scan: &Scan, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<Vec<Used>> {
    let used = {
        let mut used = vec![false; scan.uses.len()];
        scan.faces.iter().for_each(|f| used[f.material as usize] = true);
        used
    };
    let replaced = |name: &[u8]| request.replacement(&shown(&cleaned(name)));
    let wanted: Vec<&[u8]> = std::iter::zip(&scan.uses, &used)
        .filter(|((name, _), used)| **used && !name.is_empty() && replaced(name).is_none())
        .map(|((name, _), _)| name.as_slice())
        .collect();
    let library = library(path, scan, &wanted, assembly)?;
    let mut default = None;
    let mut made: HashMap<usize, Used> = HashMap::new();
    let mut places = Vec::with_capacity(scan.uses.len());
    for ((name, line), used) in scan.uses.iter().zip(used) {
        let place = match library.find(name) {
            // Read but not used by any face, so its pictures need not exist.
            _ if !used => Used { place: 0, uv: None },
            _ if replaced(name).is_some() => Used { place: replaced(name).unwrap_or(0), uv: None },
            Some((entry, values)) => match made.get(&entry) {
                Some(&used) => used,
                None => {
                    let Made { material, uv } = mtl::material(values, !scan.colours.is_empty(), assembly)?;
                    let used = Used { place: assembly.add_material(material)?, uv };
                    *made.entry(entry).or_insert(used)
                }
            },
            None => {
                if !name.is_empty() {
                    let kind = format!("no material is called `{}`; the default one is used", short(name));
                    assembly.reporter.warn(path, *line as usize, &kind, String::new)?;
                }
                let place = match default {
                    Some(place) => place,
                    None => *default.insert(assembly.add_material(usual(scan))?),
                };
                Used { place, uv: None }
            }
        };
        places.push(place);
    }
    Ok(places)
}

/// Returns the material of faces without one.
fn usual(scan: &Scan) -> Material {
    if scan.colours.is_empty() {
        return Material::default();
    }
    Material { diffuse: Colour::Corners { texture: None, scale: Rgb::ONE }, ..Material::default() }
}

/// Reads the material files that a model names. Where none of them can be read and faces name materials (`wanted`), the
/// file of the model's own name is taken.
fn library(path: &Path, scan: &Scan, wanted: &[&[u8]], assembly: &mut Assembly<'_>) -> Result<Library> {
    let mut library = Library::default();
    let mut read: Vec<PathBuf> = Vec::new();
    for (names, line) in &scan.libraries {
        let line = *line as usize;
        let find =
            |name: &[u8], assembly: &Assembly<'_>| assembly.root.find(folder_of(path), &files(name), &short(name));
        let whole = find(names, assembly);
        let words = split(names);
        // Several files in one statement.
        let several: Vec<_> = match &whole {
            Err(_) if words.len() > 1 => words.iter().map(|word| (word.as_slice(), find(word, assembly))).collect(),
            _ => Vec::new(),
        };
        let found = if several.iter().any(|(_, f)| f.is_ok()) { several } else { vec![(names.as_slice(), whole)] };
        for (name, found) in found {
            match found {
                Ok(found) if read.contains(&found.path) => {}
                Ok(found) => {
                    if found.beside {
                        let kind = format!("material file `{}` is taken from beside the model", short(name));
                        assembly.reporter.warn(path, line, &kind, String::new)?;
                    }
                    match library.read(&found.path, assembly) {
                        Err(e @ (Error::File { .. } | Error::Io { .. })) if !assembly.options.strict => {
                            let kind = format!("material file left out: {e}");
                            assembly.reporter.warn(path, line, &kind, String::new)?;
                        }
                        done => done?,
                    }
                    read.push(found.path);
                }
                Err(e) => {
                    let kind = format!("material file left out: {e}");
                    assembly.reporter.warn(path, line, &kind, String::new)?;
                }
            }
        }
    }
    let namesake = path.with_extension("mtl");
    if read.is_empty() && !wanted.is_empty() && namesake.is_file() {
        let mut own = Library::default();
        let root = assembly.root.resolve(folder_of(path), &namesake.file_name().unwrap_or_default().to_string_lossy());
        if root.is_ok() && own.read(&namesake, assembly).is_ok() && wanted.iter().any(|name| own.find(name).is_some()) {
            let kind = format!(
                "the materials of `{}` are taken, since the model names no file that can be read",
                namesake.display()
            );
            assembly.reporter.warn(path, 0, &kind, String::new)?;
            return Ok(own);
        }
    }
    Ok(library)
}

/// Returns the message for a model without triangles, which explains what the file holds and repeats what was left out.
fn no_triangles(path: &Path, scan: &Scan, holds: Option<&str>, assembly: &Assembly<'_>) -> String {
    let mut text = match (scan.faces.len(), assembly.reporter.most_dropped(), holds) {
        (0, _, Some(holds)) => format!("has no triangles: it holds {holds}"),
        (0, _, None) => {
            let points = scan.positions.len();
            format!("has no triangles: there is no face (`f`) in it, only {points} vertices; export polygons")
        }
        (_, None, _) => String::from("has no triangles: there is no face (`f`) in it"),
        (faces, Some(reason), _) => format!(
            "has no triangles: all of its faces ({faces}) were left out, most of them for {reason}; corners of a face \
             must be finite, within {:e}, and apart",
            crate::geometry::COORDINATE_LIMIT
        ),
    };
    let warnings = assembly.reporter.first_warnings(path, MOST_REPEATED);
    if !warnings.is_empty() && holds.is_none() {
        text.push_str("; left out before: ");
        text.push_str(&warnings.join("; "));
    }
    super::brief::brief(text)
}
