//! Reader of STL models, binary and ASCII. Corners at exactly the same place become one.
//!
//! The scanner is our own. The crate that reads this format, `stl_io` 0.11.0, takes every file that begins with `solid`
//! for ASCII, though many binary files do, and fails the whole file for one word that is no number.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;

use super::assembly::Assembly;
use super::indexed::{CURE, Indexed};
use super::request::{Request, UNNAMED};
use crate::scene::Material;
use crate::system::files::read;
use crate::system::memory;
use crate::{Error, Result};

/// Bytes before the triangles of a binary file: a comment and their number.
const HEADER: usize = 84;
/// Bytes of a triangle: normal, three corners, and a word of attributes.
const TRIANGLE: usize = 50;
/// Most bytes per triangle while corners are joined: three positions, and entries of a hash map.
const BYTES_A_TRIANGLE: u64 = 3 * (24 + 2 * 32) + 16;

/// Reads a model into the scene, as one shape.
pub(super) fn load(path: &Path, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<()> {
    let bytes = read(path, assembly.options.limits.file_bytes)?;
    let dropped_before = assembly.reporter.dropped_so_far();
    let what = format!("the triangles of {}", path.display());
    memory::need(&what, (bytes.len() / TRIANGLE) as u64 * BYTES_A_TRIANGLE, CURE)?;
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    let soup = if is_ascii(text) { ascii(path, text, assembly)? } else { binary(path, &bytes, assembly)? };
    drop(bytes);
    let faces = soup.mesh.triangles.len();
    assembly.take_triangles(faces as u64)?;
    let (mesh, lines) = soup.mesh.checked(path, request.limit, &mut assembly.reporter)?;
    assembly.reporter.model(path, faces, dropped_before);
    if mesh.mesh.triangles.is_empty() {
        let message = if faces == 0 {
            String::from("has no triangles: there is no facet in it; save the model as STL again")
        } else {
            format!("has no triangles: none of its facets ({faces}) can be drawn")
        };
        return Err(Error::file(path, message));
    }
    let material = match request.material.or_else(|| request.replacement(UNNAMED)) {
        Some(material) => material,
        None => assembly.add_material(Material::default())?,
    };
    request.add(path, None, mesh, material, lines, assembly)
}

/// Returns true if the file is ASCII. Binary files may begin with `solid`, too; their length is that of their triangles.
fn is_ascii(bytes: &[u8]) -> bool {
    let begins = bytes.trim_ascii_start().get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    let exact = announced(bytes).is_some_and(|n| bytes.len() as u64 == HEADER as u64 + TRIANGLE as u64 * u64::from(n));
    begins && !exact && !bytes.iter().take(1024).any(|&b| b == 0)
}

/// Returns the number of triangles that a binary file announces.
fn announced(bytes: &[u8]) -> Option<u32> {
    bytes.get(HEADER - 4..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes)
}

/// Triangles with corners joined by place.
#[derive(Default)]
struct Soup {
    mesh: Indexed,
    places: HashMap<[u64; 3], u32>,
}

impl Soup {
    fn add(&mut self, corners: [DVec3; 3], line: Option<u32>) -> Result<()> {
        let what = "the triangles of an STL file";
        let mut triangle = [0; 3];
        for (index, p) in triangle.iter_mut().zip(corners) {
            // Adding zero turns -0 into 0.
            let key = (p + DVec3::ZERO).to_array().map(f64::to_bits);
            let next = self.mesh.positions.len() as u32;
            *index = *self.places.entry(key).or_insert(next);
            if *index == next {
                memory::push(&mut self.mesh.positions, p, what, CURE)?;
            }
        }
        memory::push(&mut self.mesh.triangles, triangle, what, CURE)?;
        if let Some(line) = line {
            memory::push(&mut self.mesh.lines, line, what, CURE)?;
        }
        Ok(())
    }
}

fn binary(path: &Path, bytes: &[u8], assembly: &mut Assembly<'_>) -> Result<Soup> {
    let Some(count) = announced(bytes) else {
        let message =
            format!("is no STL file: it has {} bytes, fewer than a header; save the model again", bytes.len());
        return Err(Error::file(path, message));
    };
    let held = (bytes.len() - HEADER) / TRIANGLE;
    if u64::from(count) != held as u64 {
        let kind =
            format!("the header announces {count} triangles, and the file holds {held}; those it holds are read");
        assembly.reporter.warn(path, 0, &kind, String::new)?;
    }
    let mut soup = Soup::default();
    let mut words = 0;
    for triangle in bytes[HEADER..].as_chunks::<TRIANGLE>().0 {
        let numbers: [f64; 12] = std::array::from_fn(|i| {
            let at = 4 * i;
            let bytes = [triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3]];
            f64::from(f32::from_le_bytes(bytes))
        });
        let corner = |i: usize| DVec3::new(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
        words += u64::from(triangle[TRIANGLE - 2..] != [0, 0]);
        soup.add([corner(1), corner(2), corner(3)], None)?;
    }
    if words > 0 {
        let kind = "attributes of facets, which some programs use for colours, are left out";
        assembly.reporter.warn(path, 0, kind, || format!(" ({words} facets)"))?;
    }
    Ok(soup)
}

fn ascii(path: &Path, bytes: &[u8], assembly: &mut Assembly<'_>) -> Result<Soup> {
    let mut soup = Soup::default();
    let mut corners: Vec<DVec3> = Vec::new();
    let mut open = true;
    // Lines end in LF or CR LF; files of old programs may have CR alone.
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    for (number, line) in (1_u32..).zip(bytes.split(|&b| b == end)) {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        let Some(first) = words.next() else { continue };
        open = !first.eq_ignore_ascii_case(b"endsolid");
        if first.eq_ignore_ascii_case(b"vertex") {
            let mut next = || {
                let word = words.next().and_then(|w| std::str::from_utf8(w).ok());
                word.and_then(|w| w.parse().ok()).unwrap_or(f64::NAN)
            };
            corners.push(DVec3::new(next(), next(), next()));
        } else if first.eq_ignore_ascii_case(b"endloop") || first.eq_ignore_ascii_case(b"endfacet") {
            // A loop is convex, and has three corners but for a few writers.
            for i in 1..corners.len().saturating_sub(1) {
                soup.add([corners[0], corners[i], corners[i + 1]], Some(number))?;
            }
            if matches!(corners.len(), 1 | 2) {
                assembly.reporter.dropped("fewer than three corners");
                let kind = "faces of fewer than three corners are left out";
                assembly.reporter.warn(path, number as usize, kind, String::new)?;
            }
            corners.clear();
        }
    }
    if !corners.is_empty() {
        assembly.reporter.warn(path, 0, "the file ends within a facet, which is left out", String::new)?;
    } else if open && !soup.mesh.triangles.is_empty() {
        let kind = "the file ends without `endsolid`; it may be cut short";
        assembly.reporter.warn(path, 0, kind, String::new)?;
    }
    Ok(soup)
}
