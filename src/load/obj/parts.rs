//! Conversion of statements to meshes: faces are triangulated and sorted by material, and each mesh gets its own corners.

use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::corner::{CURE, Corner, Field, NONE};
use super::polygon::{MOST_CONCAVE_CORNERS, Refusal, triangulate};
use super::scan::{Scan, beyond, usable};
use crate::Result;
use crate::geometry::TriMesh;
use crate::load::draft::MeshDraft;
use crate::load::extent::within;
use crate::load::report::Reporter;
use crate::system::memory;

/// Triangles of one material, with indices into the lists of the file.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// Material, by the caller's number.
    pub group: u32,
    triangles: Vec<[u32; 3]>,
    /// Texture coordinates; [`NONE`] where a triangle has none, and empty if no triangle has any.
    uvs: Vec<[u32; 3]>,
    /// Normals, likewise.
    normals: Vec<[u32; 3]>,
    /// Line of each triangle.
    pub lines: Vec<u32>,
    /// Smoothing group of each triangle; empty if all are 0.
    smooth: Vec<u32>,
}

impl Part {
    pub(super) fn count(&self) -> usize {
        self.triangles.len()
    }

    /// Appends a triangle.
    fn push(&mut self, corners: [Corner; 3], line: u32, smooth: u32, what: &str) -> Result<()> {
        let before = self.triangles.len();
        memory::push(&mut self.triangles, corners.map(|c| c.v), what, CURE)?;
        memory::push(&mut self.lines, line, what, CURE)?;
        let optional = |list: &mut Vec<[u32; 3]>, indices: [u32; 3]| -> Result<()> {
            if list.is_empty() && indices[0] == NONE {
                return Ok(());
            }
            if list.is_empty() && before > 0 {
                memory::reserve(list, before + 1, what, CURE)?;
                list.resize(before, [NONE; 3]);
            }
            memory::push(list, indices, what, CURE)
        };
        optional(&mut self.uvs, corners.map(|c| c.vt))?;
        optional(&mut self.normals, corners.map(|c| c.vn))?;
        if smooth != 0 || !self.smooth.is_empty() {
            self.smooth.resize(before, 0);
            memory::push(&mut self.smooth, smooth, what, CURE)?;
        }
        Ok(())
    }
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
        corners.extend_from_slice(&scan.corners[face.first as usize..(face.first + face.count) as usize]);
        if corners.len() < 3 {
            reporter.dropped("fewer than three corners");
            reporter.warn(file, line, "faces of fewer than three corners are left out", String::new)?;
            continue;
        }
        if let Some(bad) = corners.iter().find(|c| usable(c.v, scan.positions.len()).is_none()) {
            reporter.dropped("a corner at a vertex that the file does not have");
            // A corner without a number was reported by its line.
            if bad.v != NONE {
                let detail = || beyond(Field::Vertex, bad.v, scan.positions.len());
                reporter.warn(file, line, Field::Vertex.unusable(), detail)?;
            }
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
        if let Err(refusal) = triangulate(&points, rounding(&points, scan.precise), &mut cut) {
            let why = match refusal {
                Refusal::TooManyCorners => format!("at most {MOST_CONCAVE_CORNERS} are cut into triangles"),
                Refusal::TooSlow => {
                    String::from("its outline winds so much that cutting it into triangles takes too long")
                }
            };
            reporter.dropped("a dent and too many corners");
            let kind = "faces with a dent and too many corners are left out; triangulate them beforehand";
            reporter.warn(file, line, kind, || format!(": {} corners; {why}", points.len()))?;
            continue;
        }
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
            part.push(triangle, face.line, face.smooth, &what)?;
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

/// Removes normals and texture coordinates that cannot be used, and those of a face that lacks them at some corners.
fn check_attributes(
    file: &Path,
    line: usize,
    scan: &Scan,
    corners: &mut [Corner],
    reporter: &mut Reporter,
) -> Result<()> {
    for field in [Field::Uv, Field::Normal] {
        let (count, mixed) = match field {
            Field::Normal => (scan.normals.len(), "a face without a usable normal at every corner is flat"),
            _ => (scan.uvs.len(), "a face without texture coordinates at every corner has none"),
        };
        let mut missing = 0;
        for corner in corners.iter_mut() {
            let index = *corner.field(field);
            let fits = usable(index, count).is_some_and(|i| match field {
                Field::Normal => usable_normal(scan.normals[i]),
                _ => scan.uvs[i].is_finite(),
            });
            if fits {
                continue;
            }
            missing += 1;
            if index == NONE || (index as usize) < count {
                continue;
            }
            // A file without normals may still refer to them.
            let what = field.name();
            if count == 0 {
                let kind = format!("faces point at {what}s, and the file has none: those are left out");
                reporter.warn(file, line, &kind, String::new)?;
            } else {
                reporter.warn(file, line, field.unusable(), || beyond(field, index, count))?;
            }
        }
        let given = corners.iter_mut().any(|c| *c.field(field) != NONE);
        if missing > 0 && given {
            if count > 0 {
                reporter.warn(file, line, mixed, String::new)?;
            }
            corners.iter_mut().for_each(|c| *c.field(field) = NONE);
        }
    }
    Ok(())
}

fn usable_normal(n: Vec3) -> bool {
    let length = n.as_dvec3().length();
    length > 0.0 && length.is_finite()
}

/// New indices for the entries of one list of the file.
struct Renumbering {
    /// New index of each entry; [`NONE`] for those not used.
    new: Vec<u32>,
    /// Entries in use, by their new indices.
    used: Vec<u32>,
}

impl Renumbering {
    fn of(count: usize, what: &str) -> Result<Self> {
        let mut new = Vec::new();
        memory::reserve(&mut new, count, what, CURE)?;
        new.resize(count, NONE);
        Ok(Self { new, used: Vec::new() })
    }

    /// Replaces indices of the file by new ones, in the order of their first use.
    fn apply(&mut self, lists: &mut [[u32; 3]], what: &str) -> Result<()> {
        for &i in &self.used {
            self.new[i as usize] = NONE;
        }
        self.used.clear();
        for index in lists.as_flattened_mut() {
            let place = &mut self.new[*index as usize];
            if *place == NONE {
                *place = self.used.len() as u32;
                memory::push(&mut self.used, *index, what, CURE)?;
            }
            *index = *place;
        }
        Ok(())
    }

    fn pick<T: Copy + Default>(&self, of: impl Fn(usize) -> T, what: &str) -> Result<Vec<T>> {
        let mut picked = Vec::new();
        memory::reserve(&mut picked, self.used.len(), what, CURE)?;
        picked.extend(self.used.iter().map(|&i| of(i as usize)));
        Ok(picked)
    }
}

/// Returns the meshes of all parts, in their order.
pub(super) fn meshes(
    file: &Path,
    scan: &Scan,
    parts: Vec<Part>,
    reporter: &mut Reporter,
) -> Result<Vec<(u32, MeshDraft, Vec<u32>)>> {
    let what = format!("the meshes of {}", file.display());
    let mut corners = Renumbering::of(scan.positions.len(), &what)?;
    let mut uvs = Renumbering::of(scan.uvs.len() + 1, &what)?;
    let mut normals = Renumbering::of(scan.normals.len(), &what)?;
    let mut meshes = Vec::with_capacity(parts.len());
    for mut part in parts {
        let mut mesh = TriMesh::default();
        if !part.uvs.is_empty() {
            if let Some(bare) = part.uvs.iter().position(|t| t[0] == NONE) {
                let kind = "faces without texture coordinates among such that have them take the picture's corner";
                reporter.warn(file, part.lines[bare] as usize, kind, String::new)?;
                let corner = scan.uvs.len() as u32;
                part.uvs.iter_mut().filter(|t| t[0] == NONE).for_each(|t| *t = [corner; 3]);
            }
            uvs.apply(&mut part.uvs, &what)?;
            mesh.uvs = uvs.pick(|i| scan.uvs.get(i).copied().unwrap_or(Vec2::ZERO), &what)?;
            mesh.uv_indices = part.uvs;
        }
        if !part.normals.is_empty() {
            (mesh.normals, mesh.normal_indices) = with_flat(scan, part.normals, &part.triangles, &mut normals, &what)?;
        }
        corners.apply(&mut part.triangles, &what)?;
        let places = corners.pick(|i| scan.positions[i], &what)?;
        if !scan.colours.is_empty() {
            mesh.colours = corners.pick(|i| scan.colours[i], &what)?;
        }
        mesh.triangles = part.triangles;
        let smoothing = if mesh.normals.is_empty() { part.smooth } else { Vec::new() };
        meshes.push((part.group, MeshDraft { corners: places, mesh, smoothing }, part.lines));
    }
    Ok(meshes)
}

/// Returns the normals of a part and their indices; triangles without normals get those of their planes.
fn with_flat(
    scan: &Scan,
    mut indices: Vec<[u32; 3]>,
    triangles: &[[u32; 3]],
    normals: &mut Renumbering,
    what: &str,
) -> Result<(Vec<Vec3>, Vec<[u32; 3]>)> {
    let bare: Vec<usize> = (0..indices.len()).filter(|&i| indices[i][0] == NONE).collect();
    let mut given: Vec<[u32; 3]> = Vec::new();
    let list = if bare.is_empty() {
        normals.apply(&mut indices, what)?;
        normals.pick(|i| unit(scan.normals[i]), what)?
    } else {
        memory::reserve(&mut given, indices.len(), what, CURE)?;
        given.extend(indices.iter().filter(|t| t[0] != NONE));
        normals.apply(&mut given, what)?;
        let mut list = normals.pick(|i| unit(scan.normals[i]), what)?;
        memory::reserve(&mut list, bare.len(), what, CURE)?;
        let mut given = given.into_iter();
        for (t, triangle) in indices.iter_mut().zip(triangles) {
            *t = if t[0] == NONE {
                list.push(flat_normal(triangle.map(|v| scan.positions[v as usize])));
                [list.len() as u32 - 1; 3]
            } else {
                given.next().unwrap_or_default()
            };
        }
        list
    };
    Ok((list, indices))
}

fn unit(n: Vec3) -> Vec3 {
    n.as_dvec3().normalize().as_vec3()
}

/// Returns the unit normal of a triangle; +y for one without area, which no ray hits.
fn flat_normal([a, b, c]: [DVec3; 3]) -> Vec3 {
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
}
