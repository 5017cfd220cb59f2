//! Conversion of checked statements to meshes: faces are triangulated and sorted by material, and `tobj` indexes them.

use std::io::{Cursor, Write};
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::polygon::{MOST_CONCAVE_CORNERS, Refusal, triangulate};
use super::scan::{CURE, Corner, NONE, Scan};
use crate::geometry::TriMesh;
use crate::load::draft::MeshDraft;
use crate::load::extent::within;
use crate::load::report::Reporter;
use crate::system::memory;
use crate::{Error, Result};

/// Triangles of one material.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// Material, by the caller's number.
    pub group: u32,
    pub triangles: Vec<[Corner; 3]>,
    /// Line of each triangle.
    pub lines: Vec<u32>,
    with_uvs: usize,
    with_normals: usize,
}

/// Cuts the faces into triangles, one part per material; `group` maps each entry of `scan.uses` to a material.
pub(super) fn parts(file: &Path, scan: &Scan, group: &[u32], reporter: &mut Reporter) -> Result<Vec<Part>> {
    let mut parts: Vec<Part> = Vec::new();
    let mut places = std::collections::HashMap::new();
    let (mut corners, mut points, mut cut) = (Vec::new(), Vec::new(), Vec::new());
    let what = format!("the triangles of {}", file.display());
    for face in &scan.faces {
        let line = face.line as usize;
        corners.clear();
        corners.extend_from_slice(&scan.corners[face.first..face.first + face.count]);
        if corners.len() < 3 {
            reporter.dropped("fewer than three corners");
            reporter.warn(file, line, "faces of fewer than three corners are left out", String::new)?;
            continue;
        }
        let position = |c: &Corner| scan.positions[c.v as usize];
        if let Some(bad) = corners.iter().map(position).find(|&p| !within(p, scan.widest)) {
            reporter.dropped(if bad.is_finite() {
                "a corner beyond the largest coordinate"
            } else {
                "a corner that is not finite"
            });
            let kind = format!("faces with a corner that is not finite or beyond {:.1e} are left out", scan.widest);
            reporter.warn(file, line, &kind, || format!(": corner {bad}"))?;
            continue;
        }
        corners.dedup_by(|a, b| position(a) == position(b));
        while corners.len() > 1 && position(&corners[0]) == position(&corners[corners.len() - 1]) {
            corners.pop();
        }
        if corners.len() < 3 {
            reporter.dropped("corners that coincide");
            reporter.warn(file, line, "faces whose corners coincide are left out", String::new)?;
            continue;
        }
        points.clear();
        points.extend(corners.iter().map(position));
        cut.clear();
        triangulate(&points, rounding(&points, scan.precise), &mut cut).map_err(|refusal| {
            let why = match refusal {
                Refusal::TooManyCorners => format!("at most {MOST_CONCAVE_CORNERS} are cut into triangles"),
                Refusal::TooSlow => {
                    String::from("its outline winds so much that cutting it into triangles takes too long")
                }
            };
            let count = points.len();
            Error::at(file, line, format!("a face with a dent has {count} corners; {why}; triangulate it beforehand"))
        })?;
        check_attributes(file, line, scan, &mut corners, reporter)?;
        let group = group[face.material as usize];
        let place = *places.entry(group).or_insert_with(|| {
            parts.push(Part { group, ..Part::default() });
            parts.len() - 1
        });
        let part = &mut parts[place];
        for t in &cut {
            let triangle = t.map(|i| corners[i]);
            let [a, b, c] = triangle.map(|k| position(&k));
            if a == b || b == c || c == a {
                // The polygon touches itself at a corner.
                reporter.dropped("corners that coincide");
                continue;
            }
            part.with_uvs += usize::from(triangle[0].vt != NONE);
            part.with_normals += usize::from(triangle[0].vn != NONE);
            memory::push(&mut part.triangles, triangle, &what, CURE)?;
            memory::push(&mut part.lines, face.line, &what, CURE)?;
        }
    }
    parts.retain(|p| !p.triangles.is_empty());
    Ok(parts)
}

/// Returns the largest rounding error of a corner in `f32`: as it stands or, if `later`, relative to the first corner.
fn rounding(points: &[DVec3], later: bool) -> f64 {
    let from = if later { points[0] } else { DVec3::ZERO };
    points.iter().fold(0f64, |m, &p| m.max((p - from).abs().max_element())) * f64::from(f32::EPSILON)
}

/// Removes normals and texture coordinates from a face that lacks them at some corners, and normals of zero length.
fn check_attributes(
    file: &Path,
    line: usize,
    scan: &Scan,
    corners: &mut [Corner],
    reporter: &mut Reporter,
) -> Result<()> {
    let mut strip = |missing: usize, field: fn(&mut Corner) -> &mut u32, kind: &str, corners: &mut [Corner]| {
        if missing > 0 && missing < corners.len() {
            reporter.warn(file, line, kind, String::new)?;
        }
        if missing > 0 {
            corners.iter_mut().for_each(|c| *field(c) = NONE);
        }
        Ok::<(), Error>(())
    };
    let unusable = |c: &Corner| c.vn == NONE || !usable_normal(scan.normals[c.vn as usize]);
    let missing = corners.iter().filter(|c| unusable(c)).count();
    strip(missing, |c| &mut c.vn, "a face without a usable normal at every corner is flat", corners)?;
    let missing = corners.iter().filter(|c| c.vt == NONE).count();
    strip(missing, |c| &mut c.vt, "a face without texture coordinates at every corner has none", corners)
}

fn usable_normal(n: Vec3) -> bool {
    let length = n.as_dvec3().length();
    length > 0.0 && length.is_finite()
}

/// Returns the meshes of all parts, in their order.
///
/// `tobj` receives a text that cannot be misread: finite numbers, absolute indices in range, triangles only, one object
/// per part, and attributes at every corner of a part or at none.
pub(super) fn meshes(file: &Path, scan: &Scan, parts: &[Part], reporter: &mut Reporter) -> Result<Vec<MeshDraft>> {
    let mut text = Text { bytes: Vec::new(), what: format!("the meshes of {}", file.display()) };
    for p in &scan.positions {
        // Corners that are not finite belong to faces that were left out, but their indices still count.
        let p = if p.is_finite() { *p } else { DVec3::ZERO };
        if scan.precise {
            text.push(format_args!("v {} {} {}\n", p.x, p.y, p.z))?;
        } else {
            // Written with fewer digits.
            let p = p.as_vec3();
            text.push(format_args!("v {} {} {}\n", p.x, p.y, p.z))?;
        }
    }
    for uv in &scan.uvs {
        text.push(format_args!("vt {} {}\n", uv.x, uv.y))?;
    }
    for n in &scan.normals {
        let n = if usable_normal(*n) { n.as_dvec3().normalize().as_vec3() } else { Vec3::Y };
        text.push(format_args!("vn {} {} {}\n", n.x, n.y, n.z))?;
    }
    let (mut uvs, mut normals) = (scan.uvs.len(), scan.normals.len());
    for part in parts {
        text.push(format_args!("o {}\n", part.group))?;
        if part.with_uvs > 0 && part.with_uvs < part.triangles.len() {
            let kind = "faces without texture coordinates among such that have them take the picture's corner";
            reporter.warn(file, part.lines[0] as usize, kind, String::new)?;
            text.push(format_args!("vt 0 0\n"))?;
            uvs += 1;
        }
        for triangle in &part.triangles {
            let mut triangle = *triangle;
            if part.with_uvs > 0 && triangle[0].vt == NONE {
                triangle.iter_mut().for_each(|c| c.vt = uvs as u32 - 1);
            }
            if part.with_normals > 0 && triangle[0].vn == NONE {
                let n = flat_normal(triangle.map(|c| scan.positions[c.v as usize]));
                text.push(format_args!("vn {} {} {}\n", n.x, n.y, n.z))?;
                triangle.iter_mut().for_each(|c| c.vn = normals as u32);
                normals += 1;
            }
            text.push(format_args!("f"))?;
            for c in triangle {
                let index = |i: u32| u64::from(i) + 1;
                match (c.vt, c.vn) {
                    (NONE, NONE) => text.push(format_args!(" {}", index(c.v)))?,
                    (vt, NONE) => text.push(format_args!(" {}/{}", index(c.v), index(vt)))?,
                    (NONE, vn) => text.push(format_args!(" {}//{}", index(c.v), index(vn)))?,
                    (vt, vn) => text.push(format_args!(" {}/{}/{}", index(c.v), index(vt), index(vn)))?,
                }
            }
            text.push(format_args!("\n"))?;
        }
    }
    memory::need(&text.what, indexing_bytes(parts, [scan.positions.len(), uvs, normals]), CURE)?;
    let (models, _) =
        tobj::load_obj_buf(&mut Cursor::new(text.bytes), &tobj::LoadOptions::default(), |_| Ok(Default::default()))
            .map_err(|e| Error::file(file, format!("cannot be indexed: {e}")))?;
    if models.len() != parts.len()
        || models.iter().zip(parts).any(|(m, p)| m.mesh.indices.len() != 3 * p.triangles.len())
    {
        return Err(Error::file(file, "cannot be indexed: triangles were lost"));
    }
    Ok(models.into_iter().zip(parts).map(|(model, part)| mesh(model.mesh, part)).collect())
}

/// Returns the peak bytes for indexing: `tobj`'s lists, and the meshes made of them. `counts` are those of positions,
/// texture coordinates and normals.
///
/// `tobj` holds three lists of numbers of the whole text and three of a part. For each of these it holds a hash map
/// from 8 to 4 bytes. It holds the faces of a part in 104 bytes each, and three lists of indices. Its lists grow by
/// doubling, and a hash map is at most seven eighths full. Its result is copied once.
fn indexing_bytes(parts: &[Part], counts: [usize; 3]) -> u64 {
    let list = |count: usize, each: usize| count.next_power_of_two().saturating_mul(each);
    let kind = |(count, used): (usize, bool)| {
        if !used {
            return list(3 * count, 8);
        }
        let map = list(count / 7 * 8 + 8, 17);
        let indices: usize = parts.iter().map(|p| list(3 * p.triangles.len(), 4) + 12 * p.triangles.len()).sum();
        2 * list(3 * count, 8) + 24 * count + map + indices
    };
    let used = [true, parts.iter().any(|p| p.with_uvs > 0), parts.iter().any(|p| p.with_normals > 0)];
    let largest = parts.iter().map(|p| p.triangles.len()).max().unwrap_or(0);
    (counts.into_iter().zip(used).map(kind).sum::<usize>() + list(largest, 104)) as u64
}

/// Text for `tobj`.
struct Text {
    bytes: Vec<u8>,
    /// Name in messages.
    what: String,
}

impl Text {
    /// Upper bound on the bytes of one piece of a line: three numbers of up to 60 characters.
    const PIECE: usize = 256;

    fn push(&mut self, arguments: std::fmt::Arguments<'_>) -> Result<()> {
        if self.bytes.capacity() - self.bytes.len() < Self::PIECE {
            let more = (self.bytes.len() / 2).max(1 << 12);
            memory::reserve(&mut self.bytes, more, &self.what, CURE)?;
        }
        // Writing to a vector cannot fail.
        let _ = self.bytes.write_fmt(arguments);
        Ok(())
    }
}

fn mesh(mesh: tobj::Mesh, part: &Part) -> MeshDraft {
    let triples = |flat: &[u32]| flat.as_chunks::<3>().0.to_vec();
    let vectors = |flat: &[f64]| flat.as_chunks::<3>().0.iter().map(|&p| DVec3::from(p)).collect::<Vec<_>>();
    let mut out = TriMesh { triangles: triples(&mesh.indices), ..TriMesh::default() };
    if part.with_normals > 0 {
        out.normals = vectors(&mesh.normals).into_iter().map(|n| n.as_vec3()).collect();
        out.normal_indices = triples(&mesh.normal_indices);
    }
    if part.with_uvs > 0 {
        out.uvs = mesh.texcoords.as_chunks::<2>().0.iter().map(|p| Vec2::from(p.map(|x| x as f32))).collect();
        out.uv_indices = triples(&mesh.texcoord_indices);
    }
    MeshDraft { corners: vectors(&mesh.positions), mesh: out }
}

/// Returns the unit normal of a triangle; +y for one without area, which no ray hits.
fn flat_normal([a, b, c]: [DVec3; 3]) -> Vec3 {
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
}
