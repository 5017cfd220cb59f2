//! Reader of PLY models (Turk 1994, "The PLY Polygon File Format"): ASCII and binary of both byte orders.
//!
//! The scanner is our own. The crate that reads this format, `ply-rs-bw` 4.0.1, fails the whole file for one word that
//! is no number. It keeps one of two properties of the same name, and so misreads everything behind them. It repeats an
//! entry without properties as often as the header says.

mod header;
mod numbers;

use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use self::header::{Element, Header, Number};
use self::numbers::{Entry, Numbers};
use super::assembly::Assembly;
use super::indexed::{CURE, Indexed};
use super::obj::polygon::{Refusal, triangulate};
use super::request::{Request, UNNAMED};
use crate::image::linear_from_srgb;
use crate::scene::{Colour, Material, Rgb};
use crate::system::files::read;
use crate::system::memory;
use crate::{Error, Result};

/// Names of properties of a vertex, in the order of [`Fields`].
const POSITION: [&[&str]; 3] = [&["x"], &["y"], &["z"]];
const NORMAL: [&[&str]; 3] = [&["nx", "normal_x"], &["ny", "normal_y"], &["nz", "normal_z"]];
const COLOUR: [&[&str]; 3] =
    [&["red", "r", "diffuse_red"], &["green", "g", "diffuse_green"], &["blue", "b", "diffuse_blue"]];
const PLACE: [&[&str]; 2] = [&["u", "s", "texture_u", "texture_s"], &["v", "t", "texture_v", "texture_t"]];
/// Names of the list of a face's vertices.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads a model into the scene, as one shape.
pub(super) fn load(path: &Path, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<()> {
    let bytes = read(path, assembly.options.limits.file_bytes)?;
    let header = header::header(&bytes).map_err(|(line, e)| Error::at(path, line, e))?;
    let mut reading = Reading { path, mesh: Indexed::default(), faces: 0, ends_early: false };
    let mut numbers = Numbers::new(&bytes, &header);
    let dropped_before = assembly.reporter.dropped_so_far();
    for element in &header.elements {
        // An entry without properties has no bytes either.
        if element.properties.is_empty() || reading.ends_early {
            continue;
        }
        match element.name.as_str() {
            "vertex" => reading.vertices(element, &mut numbers, assembly)?,
            "face" | "tristrips" => reading.faces(element, &mut numbers, assembly)?,
            _ => reading.others(element, &mut numbers, assembly)?,
        }
    }
    if let Some(line) = numbers.no_number {
        let kind = "words that are no numbers count as missing";
        assembly.reporter.warn(path, line as usize, kind, String::new)?;
    }
    drop(bytes);
    let Reading { mesh, faces, .. } = reading;
    let vertices = mesh.positions.len();
    assembly.take_triangles(mesh.triangles.len() as u64)?;
    let (mut mesh, lines) = mesh.checked(path, request.limit, &mut assembly.reporter)?;
    assembly.reporter.model(path, faces, dropped_before);
    if mesh.mesh.triangles.is_empty() {
        return Err(Error::file(path, nothing(&header, vertices, faces)));
    }
    let material = match request.material.or_else(|| request.replacement(UNNAMED)) {
        Some(material) => {
            mesh.mesh.colours.clear();
            material
        }
        None if mesh.mesh.colours.is_empty() => assembly.add_material(Material::default())?,
        None => {
            let diffuse = Colour::Corners { texture: None, scale: Rgb::ONE };
            assembly.add_material(Material { name: String::from("colours"), diffuse, ..Material::default() })?
        }
    };
    request.add(path, None, mesh, material, lines, assembly)
}

/// Returns the message for a file in which nothing can be drawn.
fn nothing(header: &Header, vertices: usize, faces: usize) -> String {
    if faces > 0 {
        return format!("has no triangles: none of its faces ({faces}) can be drawn; see the corners they name");
    }
    let names = header.elements.iter().map(|e| e.name.chars().take(40).collect::<String>());
    let names: Vec<String> = names.filter(|n| n != "vertex").take(5).collect();
    if names.is_empty() || names == ["face"] {
        format!("has no triangles: it holds {vertices} points and no face; make a mesh of the points first")
    } else {
        format!("has no triangles: it holds {vertices} points and {}; save it with `face` elements", names.join(", "))
    }
}

/// Places of a vertex's properties among all of them.
struct Fields {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    colour: Option<([usize; 3], Number)>,
    place: Option<[usize; 2]>,
}

impl Fields {
    /// Finds the properties, or returns `None` without a position.
    fn of(element: &Element) -> Option<Self> {
        let find = |names: &[&str]| {
            element.properties.iter().position(|p| p.count.is_none() && names.contains(&p.name.as_str()))
        };
        let three = |names: [&[&str]; 3]| Some([find(names[0])?, find(names[1])?, find(names[2])?]);
        Some(Self {
            position: three(POSITION)?,
            normal: three(NORMAL),
            colour: three(COLOUR).map(|at| (at, element.properties[at[0]].number)),
            place: find(PLACE[0]).zip(find(PLACE[1])).map(|(u, v)| [u, v]),
        })
    }
}

struct Reading<'a> {
    path: &'a Path,
    mesh: Indexed,
    /// Number of faces read.
    faces: usize,
    ends_early: bool,
}

impl Reading<'_> {
    /// Reports that the file ends within an element, of which `read` entries were read.
    fn ends(&mut self, element: &Element, read: u64, assembly: &mut Assembly<'_>) -> Result<()> {
        self.ends_early = true;
        let kind = format!("the file ends early, or cannot be read on: {read} of {} `{}`", element.count, element.name);
        assembly.reporter.warn(self.path, 0, &kind, String::new)
    }

    fn vertices(&mut self, element: &Element, numbers: &mut Numbers<'_>, assembly: &mut Assembly<'_>) -> Result<()> {
        let fields = Fields::of(element).ok_or_else(|| {
            Error::file(self.path, "its `vertex` has no properties `x`, `y` and `z`; save the model with positions")
        })?;
        if element.count > assembly.options.limits.vertices {
            let limit = assembly.options.limits.vertices;
            return Err(Error::Limit(format!(
                "{}: {} vertices; at most {limit} are read",
                self.path.display(),
                element.count
            )));
        }
        let what = format!("the vertices of {}", self.path.display());
        let mut entry = Entry::default();
        for i in 0..element.count {
            if numbers.entry(&element.properties, |_| false, &mut entry).is_none() {
                return self.ends(element, i, assembly);
            }
            let get = |at: [usize; 3]| DVec3::from(at.map(|i| entry.singles[i]));
            memory::push(&mut self.mesh.positions, get(fields.position), &what, CURE)?;
            if let Some(at) = fields.normal {
                memory::push(&mut self.mesh.normals, get(at).as_vec3(), &what, CURE)?;
            }
            if let Some((at, number)) = fields.colour {
                memory::push(&mut self.mesh.colours, colour(get(at), number), &what, CURE)?;
            }
            if let Some([u, v]) = fields.place {
                let uv = Vec2::new(entry.singles[u] as f32, entry.singles[v] as f32);
                memory::push(&mut self.mesh.uvs, uv, &what, CURE)?;
            }
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element, numbers: &mut Numbers<'_>, assembly: &mut Assembly<'_>) -> Result<()> {
        let list = element.properties.iter().position(|p| p.count.is_some() && CORNERS.contains(&p.name.as_str()));
        let Some(list) = list else {
            let kind = format!("a `{}` without a list `vertex_indices` is left out", element.name);
            assembly.reporter.warn(self.path, 0, &kind, String::new)?;
            return self.others(element, numbers, assembly);
        };
        if element.properties.iter().any(|p| p.name == "texcoord") {
            let kind = "texture coordinates of faces (`texcoord`) are left out; save them with the vertices";
            assembly.reporter.warn(self.path, 0, kind, String::new)?;
        }
        let mut entry = Entry::default();
        for i in 0..element.count {
            if numbers.entry(&element.properties, |p| p == list, &mut entry).is_none() {
                return self.ends(element, i, assembly);
            }
            let line = numbers.entry_line;
            if element.name == "tristrips" {
                self.strips(&entry.lists, line)?;
            } else {
                self.face(&entry.lists, line, assembly)?;
            }
        }
        Ok(())
    }

    /// Adds a polygon, cut into triangles.
    fn face(&mut self, corners: &[f64], line: u32, assembly: &mut Assembly<'_>) -> Result<()> {
        self.faces += 1;
        if corners.len() < 3 {
            assembly.reporter.dropped("fewer than three corners");
            let kind = "faces of fewer than three corners are left out";
            return assembly.reporter.warn(self.path, line as usize, kind, String::new);
        }
        if let [a, b, c] = *corners {
            return self.triangle([a, b, c].map(index), line);
        }
        let mut indices: Vec<u32> = corners.iter().map(|&i| index(i)).collect();
        let position = |i: &u32| self.mesh.positions.get(*i as usize).copied().unwrap_or(DVec3::NAN);
        indices.dedup_by(|a, b| position(a) == position(b));
        while indices.len() > 1 && position(&indices[0]) == position(&indices[indices.len() - 1]) {
            indices.pop();
        }
        let points: Vec<DVec3> = indices.iter().map(position).collect();
        let mut cut = Vec::new();
        if points.len() < 3 || !points.iter().all(|p| p.is_finite()) {
            // A fan has every corner, so that the check of triangles finds the fault.
            cut.extend((1..corners.len() - 1).map(|i| [0, i, i + 1]));
            indices = corners.iter().map(|&i| index(i)).collect();
        } else {
            let largest = points.iter().fold(0f64, |m, p| m.max(p.abs().max_element()));
            if let Err(refusal) = triangulate(&points, largest * f64::from(f32::EPSILON), &mut cut) {
                assembly.reporter.dropped("an outline that winds too much");
                let kind =
                    "faces with a dent and too many corners, or that wind too much, are left out; triangulate them";
                let detail = || format!(": {} corners{}", points.len(), slow(refusal));
                return assembly.reporter.warn(self.path, line as usize, kind, detail);
            }
        }
        for t in cut {
            self.triangle(t.map(|i| indices[i]), line)?;
        }
        Ok(())
    }

    /// Adds the triangles of strips, which -1 separates.
    fn strips(&mut self, corners: &[f64], line: u32) -> Result<()> {
        for strip in corners.split(|&i| i < 0.0) {
            for (i, triple) in strip.windows(3).enumerate() {
                let [a, b, c] = [triple[0], triple[1], triple[2]].map(index);
                // Repeated vertices turn a strip, and are no triangles.
                if a != b && b != c && c != a {
                    self.faces += 1;
                    self.triangle(if i % 2 == 0 { [a, b, c] } else { [b, a, c] }, line)?;
                }
            }
        }
        Ok(())
    }

    fn triangle(&mut self, corners: [u32; 3], line: u32) -> Result<()> {
        let what = "the triangles of a PLY file";
        memory::push(&mut self.mesh.triangles, corners, what, CURE)?;
        if line > 0 {
            memory::push(&mut self.mesh.lines, line, what, CURE)?;
        }
        Ok(())
    }

    /// Reads an element that has no place in a picture.
    fn others(&mut self, element: &Element, numbers: &mut Numbers<'_>, assembly: &mut Assembly<'_>) -> Result<()> {
        let mut entry = Entry::default();
        for i in 0..element.count {
            if numbers.entry(&element.properties, |_| false, &mut entry).is_none() {
                return self.ends(element, i, assembly);
            }
        }
        if element.count > 0 {
            let name: String = element.name.chars().take(40).collect();
            let kind = format!("`{name}` elements are left out; faces and strips of triangles are read");
            assembly.reporter.warn(self.path, 0, &kind, || format!(" ({} of them)", element.count))?;
        }
        Ok(())
    }
}

fn slow(refusal: Refusal) -> &'static str {
    if refusal == Refusal::TooSlow { ", too slow to cut" } else { "" }
}

/// Returns the index that a number gives; one that is none gives a vertex that does not exist.
fn index(number: f64) -> u32 {
    if number >= 0.0 && number < f64::from(u32::MAX) && number.fract() == 0.0 { number as u32 } else { u32::MAX }
}

/// Returns a linear colour: whole numbers are sRGB codes, others are linear.
fn colour(given: DVec3, number: Number) -> Vec3 {
    if matches!(number, Number::F32 | Number::F64) {
        return given.as_vec3();
    }
    (given / number.one()).map(linear_from_srgb).as_vec3()
}
