//! Coincident flat faces: triangles of different meshes, duplicates within one mesh, triangles on planes, equal planes.
//!
//! Triangles are hashed by their planes (unit normal and offset, quantised), so that only those whose planes nearly agree
//! are compared, by a sweep over their boxes. A plane that cannot be told finely, since its triangle is small against
//! its coordinates, is hashed coarsely, and all others with it.

use glam::DVec3;
use rayon::prelude::*;

use super::face::{Face, Form};
use super::{Found, overlap, tolerance};
use crate::geometry::{Aabb, Geometry, Plane, Shape, TriMesh};
use crate::math::UNIT_ROUNDOFF;

/// Steps of the unit normal and of the offset, each over the whole range, fine and coarse.
const LEVELS: [(f64, f64); 2] = [(64.0, 4096.0), (4.0, 16.0)];

/// Finds coincident flat faces among bounded neighbours and planes.
pub(super) fn find(
    geometry: &[Geometry],
    bounds: &[Option<Aabb>],
    neighbours: &[Vec<u32>],
    matters: &(dyn Fn(usize, usize) -> bool + Sync),
    found: &mut Found,
) {
    for (object, shape) in geometry.iter().enumerate() {
        if let (Shape::Mesh(mesh), true) = (&shape.shape, matters(object, object)) {
            duplicates(object, mesh, found);
        }
    }
    between_meshes(geometry, bounds, neighbours, matters, found);
    let planes: Vec<(usize, &Plane)> = geometry
        .iter()
        .enumerate()
        .filter_map(|(o, g)| if let Shape::Plane(plane) = &g.shape { Some((o, plane)) } else { None })
        .filter(|(_, plane)| plane.is_usable())
        .collect();
    for (i, &(object, plane)) in planes.iter().enumerate() {
        on_plane(geometry, bounds, object, matters, found);
        for &(other, twin) in &planes[..i] {
            if matters(object, other) && equal_planes(plane, twin) {
                found.coincide((object as u32, 0), (other as u32, 0));
            }
        }
    }
}

/// Triangles of one mesh with the same three corners, in any order. A mesh of which each triangle has one that runs the
/// other way round is two-sided, as some programs export thin sheets.
fn duplicates(object: usize, mesh: &TriMesh, found: &mut Found) {
    let key = |i: usize| {
        let mut corners = mesh.corners(i).map(|p| (p + glam::Vec3::ZERO).to_array().map(f32::to_bits));
        corners.sort_unstable();
        corners
    };
    // A sum of hashes does not depend on the order of the corners.
    let hash = |i: usize| {
        mesh.corners(i).iter().fold(0_u64, |sum, &p| {
            let [x, y, z] = (p + glam::Vec3::ZERO).to_array().map(|c| u64::from(c.to_bits()));
            let mixed = (x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.rotate_left(21)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            sum.wrapping_add((mixed ^ z.rotate_left(42)).wrapping_mul(0x94d0_49bb_1331_11eb))
        })
    };
    let mut hashes: Vec<(u64, u32)> = (0..mesh.triangles.len()).into_par_iter().map(|i| (hash(i), i as u32)).collect();
    hashes.par_sort_unstable();
    let mut turned = vec![false; mesh.triangles.len()];
    for same in hashes.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        // Neighbours in the list suffice for a chain, but each face is asked for all of its partners.
        for (k, &(_, i)) in same.iter().enumerate().take(MOST_TWINS) {
            for &(_, j) in &same[k + 1..same.len().min(MOST_TWINS)] {
                if mesh.is_usable(i as usize) && key(i as usize) == key(j as usize) {
                    found.coincide((object as u32, i), (object as u32, j));
                    if !runs_alike(mesh.corners(i as usize), mesh.corners(j as usize)) {
                        (turned[i as usize], turned[j as usize]) = (true, true);
                    }
                }
            }
        }
    }
    let usable = (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)).count();
    if usable > 0 && turned.iter().filter(|&&turned| turned).count() == usable {
        found.two_sided.push(object as u32);
    }
}

/// Returns true if two triangles with the same corners run through them in the same direction.
fn runs_alike([a, b, c]: [glam::Vec3; 3], other: [glam::Vec3; 3]) -> bool {
    [[a, b, c], [b, c, a], [c, a, b]].contains(&other)
}

/// Triangles at one place that are told of each other. More of them are one surface all the same: a ray that starts
/// beyond some of them starts beyond all.
const MOST_TWINS: usize = 16;

/// A triangle that may lie on another object's.
struct Candidate {
    object: u32,
    primitive: u32,
    lo: DVec3,
    hi: DVec3,
    /// Unit normal, with the sign that makes its largest component positive.
    normal: DVec3,
    /// Offset of its plane from the centre of all candidates.
    offset: f64,
    /// Bounds on the errors of both.
    errors: [f64; 2],
}

fn between_meshes(
    geometry: &[Geometry],
    bounds: &[Option<Aabb>],
    neighbours: &[Vec<u32>],
    matters: &(dyn Fn(usize, usize) -> bool + Sync),
    found: &mut Found,
) {
    let is_mesh = |o: u32| matches!(geometry[o as usize].shape, Shape::Mesh(_));
    // The box of an object within which it may meet its neighbours.
    let shared = |object: usize| -> Option<(DVec3, DVec3)> {
        let (lo, hi) = super::grown(bounds[object].as_ref()?);
        let meshes = neighbours[object].iter().filter(|&&other| is_mesh(other));
        let mut all: Option<(DVec3, DVec3)> = None;
        for &other in meshes {
            let (other_lo, other_hi) = super::grown(bounds[other as usize].as_ref()?);
            let (lo, hi) = (lo.max(other_lo), hi.min(other_hi));
            all = Some(all.map_or((lo, hi), |(l, h)| (l.min(lo), h.max(hi))));
        }
        all
    };
    let regions: Vec<(usize, (DVec3, DVec3))> =
        (0..geometry.len()).filter(|&o| is_mesh(o as u32)).filter_map(|o| Some((o, shared(o)?))).collect();
    let Some((lo, hi)) = regions.iter().map(|r| r.1).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else { return };
    let (centre, extent) = ((lo + hi) * 0.5, (hi - lo).max_element().max(f64::MIN_POSITIVE));
    let mut candidates: Vec<Candidate> = Vec::new();
    for &(object, region) in &regions {
        let Shape::Mesh(mesh) = &geometry[object].shape else { continue };
        candidates.par_extend(
            (0..mesh.triangles.len())
                .into_par_iter()
                .filter_map(|i| Candidate::of(object as u32, mesh, i as u32, region, centre)),
        );
    }
    let told_finely = |c: &Candidate| {
        let (steps, offsets) = LEVELS[0];
        c.errors[0] * steps < 0.25 && c.errors[1] * offsets < 0.25 * extent
    };
    let fine: Vec<u32> = (0..candidates.len() as u32).filter(|&i| told_finely(&candidates[i as usize])).collect();
    let all_fine = fine.len() == candidates.len();
    sweep_by_plane(geometry, &candidates, &fine, LEVELS[0], extent, matters, found);
    if !all_fine {
        // Whatever is coarse may lie on something fine.
        let all: Vec<u32> = (0..candidates.len() as u32).collect();
        sweep_by_plane(geometry, &candidates, &all, LEVELS[1], extent, matters, found);
    }
}

impl Candidate {
    /// A triangle that reaches into the region where its object meets others.
    fn of(object: u32, mesh: &TriMesh, primitive: u32, region: (DVec3, DVec3), centre: DVec3) -> Option<Self> {
        let corners = mesh.corners(primitive as usize).map(|p| p.as_dvec3());
        let [a, b, c] = corners;
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let largest = lo.abs().max(hi.abs()).max_element();
        let margin = tolerance(largest);
        if !(lo.cmple(region.1 + margin).all() && hi.cmpge(region.0 - margin).all()) {
            return None;
        }
        let spanned = (b - a).cross(c - a);
        let area = spanned.length();
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        if !(area > 0.0 && area.is_finite() && mesh.is_usable(primitive as usize)) {
            return None;
        }
        let normal = spanned / area;
        let up = normal[normal.abs().max_position()] < 0.0;
        let normal = if up { -normal } else { normal };
        let from_centre = (a + b + c) / 3.0 - centre;
        let turned = 4.0 * f64::from(UNIT_ROUNDOFF) * largest * longest / area;
        let moved = turned * from_centre.length() + margin;
        let offset = normal.dot(from_centre);
        Some(Self { object, primitive, lo: lo - margin, hi: hi + margin, normal, offset, errors: [turned, moved] })
    }

    /// Shows the cells of (normal, offset) that the plane may lie in.
    fn cells(&self, (steps, offsets): (f64, f64), extent: f64, mut see: impl FnMut(u64)) {
        let range = |x: f64, error: f64| ((x - error).floor() as i64, (x + error).floor() as i64);
        let n = self.normal * steps;
        let turned = (self.errors[0] * steps + 1e-9).min(1.0);
        let [x, y, z] = [n.x, n.y, n.z].map(|c| range(c, turned));
        let d = range(self.offset / extent * offsets, (self.errors[1] / extent * offsets + 1e-9).min(1.0));
        for i in x.0..=x.1 {
            for j in y.0..=y.1 {
                for k in z.0..=z.1 {
                    for l in d.0..=d.1 {
                        let words = [i, j, k, l].map(|w| w as u64);
                        see(words
                            .iter()
                            .fold(0, |h: u64, &w| (h ^ w).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23)));
                    }
                }
            }
        }
    }
}

/// Compares the triangles whose planes share a cell.
fn sweep_by_plane(
    geometry: &[Geometry],
    candidates: &[Candidate],
    some: &[u32],
    level: (f64, f64),
    extent: f64,
    matters: &(dyn Fn(usize, usize) -> bool + Sync),
    found: &mut Found,
) {
    let mut cells: Vec<(u64, u32)> = Vec::with_capacity(some.len());
    for &i in some {
        candidates[i as usize].cells(level, extent, |cell| cells.push((cell, i)));
    }
    cells.par_sort_unstable();
    let meet = |cell: &[(u64, u32)]| -> Vec<[(u32, u32); 2]> {
        let object = |i: u32| candidates[i as usize].object;
        if cell.iter().all(|&(_, i)| object(i) == object(cell[0].1)) {
            return Vec::new();
        }
        sweep(geometry, candidates, cell, matters)
    };
    let met: Vec<[(u32, u32); 2]> = cells
        .chunk_by(|a, b| a.0 == b.0)
        .collect::<Vec<_>>()
        .into_par_iter()
        .filter(|cell| cell.len() > 1)
        .flat_map_iter(meet)
        .collect();
    met.into_iter().for_each(|[a, b]| found.coincide(a, b));
}

/// Sweeps over the boxes of some candidates along their longest axis, and tries those that overlap.
fn sweep(
    geometry: &[Geometry],
    candidates: &[Candidate],
    cell: &[(u64, u32)],
    matters: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Vec<[(u32, u32); 2]> {
    let at = |i: u32| &candidates[i as usize];
    let (lo, hi) =
        cell.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &(_, i)| (l.min(at(i).lo), h.max(at(i).hi)));
    let axis = (hi - lo).max_position();
    let mut sorted: Vec<u32> = cell.iter().map(|&(_, i)| i).collect();
    sorted.sort_unstable_by(|&a, &b| at(a).lo[axis].total_cmp(&at(b).lo[axis]).then(a.cmp(&b)));
    let mut met = Vec::new();
    // By object, so that the many faces of one are not compared with each other.
    let mut active: Vec<(u32, Vec<u32>)> = Vec::new();
    for &i in &sorted {
        let here = at(i);
        active.retain_mut(|(_, faces)| {
            faces.retain(|&j| at(j).hi[axis] >= here.lo[axis]);
            !faces.is_empty()
        });
        for (object, faces) in &active {
            if *object == here.object || !matters(*object as usize, here.object as usize) {
                continue;
            }
            for &j in faces {
                let there = at(j);
                if here.lo.cmple(there.hi).all() && there.lo.cmple(here.hi).all() {
                    let [a, b] = [here, there].map(|c| Face::of(geometry, c.object, c.primitive));
                    // Which of two is projected onto the other must not depend on the order of objects.
                    if overlap::coincide(&a, &b) || overlap::coincide(&b, &a) {
                        met.push([a.id(), b.id()]);
                    }
                }
            }
        }
        match active.iter_mut().find(|(object, _)| *object == here.object) {
            Some((_, faces)) => faces.push(i),
            None => active.push((here.object, vec![i])),
        }
    }
    met
}

/// Triangles of meshes that lie on a plane.
fn on_plane(
    geometry: &[Geometry],
    bounds: &[Option<Aabb>],
    object: usize,
    matters: &(dyn Fn(usize, usize) -> bool + Sync),
    found: &mut Found,
) {
    let plane = Face::of(geometry, object as u32, 0);
    let Form::Plane { normal, .. } = plane.form else { return };
    let near = |p: DVec3| plane.height(p).abs() <= tolerance(plane.largest_coordinate(p));
    for (other, bounds) in bounds.iter().enumerate() {
        let (Some(bounds), Shape::Mesh(mesh)) = (bounds, &geometry[other].shape) else { continue };
        if bounds.is_empty() || !matters(object, other) {
            continue;
        }
        let (lo, hi) = (bounds.lo.as_dvec3(), bounds.hi.as_dvec3());
        let (middle, half) = ((lo + hi) * 0.5, (hi - lo) * 0.5);
        let farthest = plane.largest_coordinate(lo).max(plane.largest_coordinate(hi));
        if plane.height(middle).abs() > normal.abs().dot(half) + tolerance(farthest) {
            continue;
        }
        let on: Vec<u32> = (0..mesh.triangles.len() as u32)
            .into_par_iter()
            .filter(|&i| {
                let corners = mesh.corners(i as usize).map(|p| p.as_dvec3());
                let [a, b, c] = corners;
                let wide = || {
                    let spanned = (b - a).cross(c - a).length();
                    let perimeter = (b - a).length() + (c - b).length() + (a - c).length();
                    spanned > 4.0 * tolerance(plane.largest_coordinate(a)) * perimeter
                };
                corners.iter().all(|&p| near(p)) && mesh.is_usable(i as usize) && wide()
            })
            .collect();
        on.into_iter().for_each(|i| found.coincide((object as u32, 0), (other as u32, i)));
    }
}

/// Returns true if two planes are the same within the tolerance, wherever their points are.
fn equal_planes(a: &Plane, b: &Plane) -> bool {
    let (n, m) = (a.normal.as_dvec3().normalize(), b.normal.as_dvec3().normalize());
    let way = b.point.as_dvec3() - a.point.as_dvec3();
    let largest = a.point.abs().max(b.point.abs()).max_element();
    let near = tolerance(f64::from(largest).max(way.abs().max_element()));
    n.cross(m).length() <= 8.0 * f64::from(UNIT_ROUNDOFF) && n.dot(way).abs() <= near && m.dot(way).abs() <= near
}
