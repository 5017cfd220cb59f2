//! From checked statements to meshes: faces cut into triangles and sorted by material, and `tobj` to index them.

use std::fmt::Write;
use std::io::Cursor;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::polygon::{MOST_CONCAVE_CORNERS, triangulate};
use super::scan::{Corner, NONE, Scan};
use crate::geometry::TriMesh;
use crate::load::draft::MeshDraft;
use crate::load::extent::within;
use crate::load::report::Reporter;
use crate::{Error, Result};

/// The triangles of one material.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// The material, as the caller numbers them.
    pub group: u32,
    pub triangles: Vec<[Corner; 3]>,
    /// Line of each.
    pub lines: Vec<u32>,
    with_uvs: usize,
    with_normals: usize,
}

/// Cuts the faces into triangles, one part a material; `group` says which material each place of `scan.uses` is.
pub(super) fn parts(file: &Path, scan: &Scan, group: &[u32], reporter: &mut Reporter) -> Result<Vec<Part>> {
    let mut parts: Vec<Part> = Vec::new();
    let mut places = std::collections::HashMap::new();
    let (mut corners, mut points, mut cut) = (Vec::new(), Vec::new(), Vec::new());
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
            reporter.dropped("a corner that is not finite");
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
        triangulate(&points, rounding(&points, scan.precise), &mut cut).map_err(|n| {
            Error::at(
                file,
                line,
                format!("a face with a dent has {n} corners, too many to cut it into triangles (at most {MOST_CONCAVE_CORNERS})"),
            )
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
                // A polygon that touches itself at a corner.
                reporter.dropped("corners that coincide");
                continue;
            }
            part.with_uvs += usize::from(triangle[0].vt != NONE);
            part.with_normals += usize::from(triangle[0].vn != NONE);
            part.triangles.push(triangle);
            part.lines.push(face.line);
        }
    }
    parts.retain(|p| !p.triangles.is_empty());
    Ok(parts)
}

/// How far off a corner may be for its rounding to `f32`: as it stands or, where that is `later`, as seen from near by.
fn rounding(points: &[DVec3], later: bool) -> f64 {
    let from = if later { points[0] } else { DVec3::ZERO };
    points.iter().fold(0f64, |m, &p| m.max((p - from).abs().max_element())) * f64::from(f32::EPSILON)
}

/// Takes normals and texture coordinates off a face that has them at some corners only, or normals without length.
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

/// The meshes of all parts, in their order.
///
/// `tobj` gets a text in which nothing is left to misread: finite numbers, absolute indices in range, triangles
/// only, one object a part, and attributes at every corner of a part or at none.
pub(super) fn meshes(file: &Path, scan: &Scan, parts: &[Part], reporter: &mut Reporter) -> Result<Vec<MeshDraft>> {
    let mut text = String::new();
    for p in &scan.positions {
        // Corners that are not finite belong to faces that were left out; their places still count.
        let p = if p.is_finite() { *p } else { DVec3::ZERO };
        if scan.precise {
            push(&mut text, format_args!("v {} {} {}\n", p.x, p.y, p.z));
        } else {
            // Of fewer digits.
            let p = p.as_vec3();
            push(&mut text, format_args!("v {} {} {}\n", p.x, p.y, p.z));
        }
    }
    for uv in &scan.uvs {
        push(&mut text, format_args!("vt {} {}\n", uv.x, uv.y));
    }
    for n in &scan.normals {
        let n = if usable_normal(*n) { n.as_dvec3().normalize().as_vec3() } else { Vec3::Y };
        push(&mut text, format_args!("vn {} {} {}\n", n.x, n.y, n.z));
    }
    let (mut uvs, mut normals) = (scan.uvs.len(), scan.normals.len());
    for part in parts {
        push(&mut text, format_args!("o {}\n", part.group));
        if part.with_uvs > 0 && part.with_uvs < part.triangles.len() {
            let kind = "faces without texture coordinates among such that have them take the picture's corner";
            reporter.warn(file, part.lines[0] as usize, kind, String::new)?;
            text.push_str("vt 0 0\n");
            uvs += 1;
        }
        for triangle in &part.triangles {
            let mut triangle = *triangle;
            if part.with_uvs > 0 && triangle[0].vt == NONE {
                triangle.iter_mut().for_each(|c| c.vt = uvs as u32 - 1);
            }
            if part.with_normals > 0 && triangle[0].vn == NONE {
                let n = flat_normal(triangle.map(|c| scan.positions[c.v as usize]));
                push(&mut text, format_args!("vn {} {} {}\n", n.x, n.y, n.z));
                triangle.iter_mut().for_each(|c| c.vn = normals as u32);
                normals += 1;
            }
            text.push('f');
            for c in triangle {
                let index = |i: u32| u64::from(i) + 1;
                match (c.vt, c.vn) {
                    (NONE, NONE) => push(&mut text, format_args!(" {}", index(c.v))),
                    (vt, NONE) => push(&mut text, format_args!(" {}/{}", index(c.v), index(vt))),
                    (NONE, vn) => push(&mut text, format_args!(" {}//{}", index(c.v), index(vn))),
                    (vt, vn) => push(&mut text, format_args!(" {}/{}/{}", index(c.v), index(vt), index(vn))),
                }
            }
            text.push('\n');
        }
    }
    let (models, _) =
        tobj::load_obj_buf(&mut Cursor::new(text), &tobj::LoadOptions::default(), |_| Ok(Default::default()))
            .map_err(|e| Error::file(file, format!("cannot be indexed: {e}")))?;
    if models.len() != parts.len()
        || models.iter().zip(parts).any(|(m, p)| m.mesh.indices.len() != 3 * p.triangles.len())
    {
        return Err(Error::file(file, "cannot be indexed: triangles were lost"));
    }
    Ok(models.into_iter().zip(parts).map(|(model, part)| mesh(model.mesh, part)).collect())
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

/// The unit normal of a triangle; up where it has no area (no ray meets it).
fn flat_normal([a, b, c]: [DVec3; 3]) -> Vec3 {
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
}

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(arguments);
}
