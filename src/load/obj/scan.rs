//! Parser of OBJ files: blocks are parsed side by side ([`Block`]) and joined in order, with absolute indices and line
//! numbers. The result does not depend on the number of threads or blocks.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::block::{Block, Fault, INHERITED, MOST_LIBRARIES, UNCOLOURED};
use super::corner::{CURE, Corner, Face, Field, NONE};
use super::lines::blocks;
use crate::geometry::COORDINATE_LIMIT;
use crate::image::linear_from_srgb;
use crate::load::Limits;
use crate::load::extent::{Extent, within};
use crate::load::report::Reporter;
use crate::system::memory;
use crate::{Error, Result};

/// Bytes of a block.
const BLOCK: usize = 1 << 20;

/// Content of an OBJ file.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// Positions, of any value.
    pub positions: Vec<DVec3>,
    /// True if positions have all digits of the file; else they are rounded to `f32`, which suffices for rendering.
    pub precise: bool,
    /// Largest magnitude of a coordinate that can be rendered.
    pub widest: f64,
    /// Linear colours of the positions; empty if the file has none that differs from white.
    pub colours: Vec<Vec3>,
    /// Texture coordinates; not finite if the file gives none.
    pub uvs: Vec<Vec2>,
    /// Normals; zero or not finite if the file gives no direction.
    pub normals: Vec<Vec3>,
    /// Corners of faces; an index may be [`NONE`] or out of range.
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    /// Names of materials, with the line of their first use; the first entry stands for no name.
    pub uses: Vec<(Vec<u8>, u32)>,
    /// Material files, with their lines.
    pub libraries: Vec<(Vec<u8>, u32)>,
}

/// Parses an OBJ file. Coordinates beyond [`COORDINATE_LIMIT`] count as wrong. If most exceed it, `widest` replaces that
/// limit.
pub(super) fn scan(file: &Path, text: &[u8], widest: f64, limits: &Limits, reporter: &mut Reporter) -> Result<Scan> {
    scan_by(BLOCK, file, text, widest, limits, reporter)
}

fn scan_by(
    size: usize,
    file: &Path,
    text: &[u8],
    widest: f64,
    limits: &Limits,
    reporter: &mut Reporter,
) -> Result<Scan> {
    let what = format!("the vertices and faces of {}", file.display());
    let parse = |text: &&[u8]| Block::parse(text, limits, &what);
    let blocks = blocks(text, size);
    // A small file is not worth the threads.
    let parsed: Vec<Block> =
        if blocks.len() < 2 { blocks.iter().map(parse).collect() } else { blocks.par_iter().map(parse).collect() };
    let mut scan = joined(file, parsed, limits, reporter, &what)?;
    let usual = f64::from(COORDINATE_LIMIT);
    let (mut near, mut all, mut beyond) = (Extent::EMPTY, Extent::EMPTY, 0);
    for p in scan.corners.iter().filter_map(|c| scan.positions.get(c.v as usize)) {
        if within(*p, usual) {
            near = near.with(*p);
        } else if within(*p, widest) {
            all = all.with(*p);
            beyond += 1;
        }
    }
    scan.widest = if 2 * beyond > scan.corners.len() { widest } else { usual };
    let extent = if scan.widest > usual { near.union(all) } else { near };
    scan.precise = !extent.suits_f32();
    if !scan.precise {
        scan.positions.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    }
    Ok(scan)
}

/// Joins blocks in order.
fn joined(file: &Path, blocks: Vec<Block>, limits: &Limits, reporter: &mut Reporter, what: &str) -> Result<Scan> {
    let mut scan = Scan { uses: vec![(Vec::new(), 0)], ..Scan::default() };
    let total = |of: fn(&Block) -> usize| blocks.iter().map(of).sum::<usize>();
    let limit = limits.vertices.min(u64::from(NONE - 1)) as usize;
    if total(|b| b.positions.len()).max(total(|b| b.uvs.len())).max(total(|b| b.normals.len())) > limit {
        return Err(Error::Limit(format!("{}: more than {limit} vertices", file.display())));
    }
    if total(|b| b.faces.len()) as u64 > limits.triangles {
        return Err(Error::Limit(format!("{}: more than {} faces", file.display(), limits.triangles)));
    }
    memory::reserve(&mut scan.positions, total(|b| b.positions.len()), what, CURE)?;
    memory::reserve(&mut scan.uvs, total(|b| b.uvs.len()), what, CURE)?;
    memory::reserve(&mut scan.normals, total(|b| b.normals.len()), what, CURE)?;
    memory::reserve(&mut scan.corners, total(|b| b.corners.len()), what, CURE)?;
    memory::reserve(&mut scan.faces, total(|b| b.faces.len()), what, CURE)?;
    let mut colours: Vec<Vec3> = Vec::new();
    let mut painted: Vec<[u8; 3]> = Vec::new();
    let mut places = HashMap::from([(Vec::new(), 0_u32)]);
    let (mut lines, mut state) = (0_u32, [0_u32; 2]);
    for mut block in blocks {
        let at = |line: u32| lines.saturating_add(line);
        for note in std::mem::take(&mut block.notes.list) {
            reporter.warn_times(file, at(note.line) as usize, &note.kind, note.count, || note.detail)?;
        }
        if let Some((line, fault)) = block.fault {
            return Err(error(file, at(line), fault, limits));
        }
        let names = std::mem::take(&mut block.uses);
        let mut materials = Vec::with_capacity(names.len());
        for (name, line) in names {
            let next = scan.uses.len() as u32;
            if next as usize > limits.objects {
                return Err(error(file, at(line), Fault::Names("materials", limits.objects), limits));
            }
            let place = *places.entry(name.clone()).or_insert(next);
            if place == next {
                scan.uses.push((name, at(line)));
            }
            materials.push(place);
        }
        for (name, line) in std::mem::take(&mut block.libraries) {
            if scan.libraries.iter().all(|(known, _)| *known != name) {
                if scan.libraries.len() >= MOST_LIBRARIES {
                    return Err(error(file, at(line), Fault::Names("material files", MOST_LIBRARIES), limits));
                }
                scan.libraries.push((name, at(line)));
            }
        }
        backwards(file, &mut block, &scan, lines, reporter)?;
        let first = scan.corners.len() as u32;
        let material = |local: u32| materials.get(local as usize).copied();
        scan.faces.extend(block.faces.iter().map(|face| Face {
            line: at(face.line),
            first: first + face.first,
            count: face.count,
            material: material(face.material).unwrap_or(state[0]),
            smooth: if face.smooth == INHERITED { state[1] } else { face.smooth },
        }));
        state[0] = material(block.last[0]).unwrap_or(state[0]);
        state[1] = if block.last[1] == INHERITED { state[1] } else { block.last[1] };
        if !block.colours.is_empty() || !colours.is_empty() {
            colours.resize(scan.positions.len(), UNCOLOURED);
            colours.append(&mut block.colours);
        }
        painted.append(&mut block.painted);
        scan.positions.append(&mut block.positions);
        scan.uvs.append(&mut block.uvs);
        scan.normals.append(&mut block.normals);
        scan.corners.append(&mut block.corners);
        lines = lines.saturating_add(block.lines);
    }
    scan.colours = linear(colours, &painted, scan.positions.len());
    Ok(scan)
}

/// Makes the indices of a block absolute.
fn backwards(file: &Path, block: &mut Block, scan: &Scan, lines: u32, reporter: &mut Reporter) -> Result<()> {
    let bases = [scan.positions.len(), scan.uvs.len(), scan.normals.len()];
    for (place, field) in std::mem::take(&mut block.backwards) {
        let corner = &mut block.corners[place as usize];
        let base = bases[field as usize] as i64;
        let index = base + i64::from(*corner.field(field) as i32);
        *corner.field(field) = u32::try_from(index).unwrap_or(NONE);
        if index < 0 {
            let face = block.faces.partition_point(|f| f.first <= place).saturating_sub(1);
            let line = lines.saturating_add(block.faces[face].line) as usize;
            reporter.warn(file, line, field.unusable(), || {
                format!(": a {} {} places before the first one", field.name(), -index)
            })?;
        }
    }
    Ok(())
}

fn error(file: &Path, line: u32, fault: Fault, limits: &Limits) -> Error {
    match fault {
        Fault::Memory(error) => error,
        Fault::Names(of, most) => Error::Limit(format!("{}: more than {most} {of}", file.display())),
        Fault::LongLine(bytes) => {
            let place = Error::at(file, line as usize, format!("the line has {bytes} bytes"));
            Error::Limit(format!("{place}; at most {} are read", limits.line_bytes))
        }
    }
}

/// Returns the linear colours of `count` vertices; empty if all are white. Colours of the file are sRGB: shares or, if
/// one exceeds 1, codes up to 255.
fn linear(mut colours: Vec<Vec3>, painted: &[[u8; 3]], count: usize) -> Vec<Vec3> {
    if painted.is_empty() && colours.is_empty() {
        return colours;
    }
    let of_vertices = colours.iter().filter(|c| c.is_finite());
    let most = of_vertices.fold(0.0_f32, |most, c| most.max(c.max_element()));
    let scale = if most > 1.0 { 1.0 / 255.0 } else { 1.0 };
    colours.resize(count, UNCOLOURED);
    colours.iter_mut().for_each(|c| *c = if c.is_finite() { *c * scale } else { Vec3::ONE });
    for (colour, code) in colours.iter_mut().zip(painted) {
        *colour = Vec3::from(code.map(f32::from)) / 255.0;
    }
    if colours.iter().all(|&c| c == Vec3::ONE) {
        return Vec::new();
    }
    let linear = |c: f32| linear_from_srgb(f64::from(c.clamp(0.0, 1.0))) as f32;
    colours.iter_mut().for_each(|c| *c = Vec3::from(c.to_array().map(linear)));
    colours
}

/// Returns the place of an attribute that a corner has and the file, too.
pub(super) fn usable(index: u32, count: usize) -> Option<usize> {
    Some(index as usize).filter(|&i| i < count)
}

/// Returns the text of a warning about an index beyond the file's list.
pub(super) fn beyond(field: Field, index: u32, count: usize) -> String {
    format!(": {} {}; the file has {count}", field.name(), u64::from(index) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_in_small_blocks_is_the_same_as_in_one() {
        let text = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nusemtl a\nv 0 1 0\nvt 0 0\nvn 0 0 1\ns 3\nf 1/1/1 2 -1\nl 1 2\n\
                    usemtl b\nf -3 \\\n-2 -1//-1\nv 1 1 0 0 1 0\nusemtl a\nf 2 4 3\ns off\nf -1 -2 -3\nf -9 1 2\nl 1 2\n";
        let of = |size| {
            let mut reporter = Reporter::new(false);
            let scan = scan_by(size, Path::new("a.obj"), text.as_bytes(), 1e18, &Limits::default(), &mut reporter);
            (format!("{:?}", scan.unwrap()), reporter.finish().warnings)
        };
        let whole = of(1 << 20);
        assert_eq!(whole.1.len(), 2, "{:?}", whole.1);
        for size in 1..text.len() {
            let (scan, warnings) = of(size);
            assert_eq!(scan, whole.0, "{size}");
            let mut sorted = warnings.clone();
            sorted.sort_by_key(|w| w.line);
            assert_eq!(
                sorted,
                {
                    let mut w = whole.1.clone();
                    w.sort_by_key(|w| w.line);
                    w
                },
                "{size}"
            );
        }
    }

    #[test]
    fn colours_of_vertices_are_srgb_in_shares_or_in_codes() {
        let of = |text: &str| {
            let mut reporter = Reporter::new(false);
            scan(Path::new("a.obj"), text.as_bytes(), 1e18, &Limits::default(), &mut reporter).unwrap().colours
        };
        let half = linear_from_srgb(0.5) as f32;
        assert_eq!(of("v 0 0 0 0.5 1 0\nv 0 0 0\n"), [Vec3::new(half, 1.0, 0.0), Vec3::ONE]);
        assert_eq!(of("v 0 0 0 1.0 0.5 1 0\n"), [Vec3::new(half, 1.0, 0.0)]);
        assert_eq!(of("v 0 0 0 0 255 0\nv 0 0 0 255 0 0\n"), [Vec3::Y, Vec3::X]);
        assert_eq!(of("v 0 0 0\nv 0 0 0\n#MRGB ff0000ff00ff0000\n"), [Vec3::Z, Vec3::X]);
        assert!(of("v 0 0 0 1 1 1\nv 0 0 0\n").is_empty());
    }
}
