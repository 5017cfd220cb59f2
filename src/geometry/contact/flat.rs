//! Coincident flat faces: triangles of different meshes, duplicates within one mesh, triangles on planes, equal planes.
//!
//! Blocks of triangles whose boxes overlap those of other objects come first; most triangles of a scene lie elsewhere. The
//! triangles of these blocks are boxes of eight dimensions, place and plane together, so that only those whose planes
//! nearly agree are compared. The plane of a triangle that is small against its coordinates is known roughly, and its box
//! is large.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::face::{Face, Form};
use super::found::Found;
use super::join::{self, Extent, Item};
use super::tolerance::{grown, tolerance};
use super::{overlap, repeats};
use crate::geometry::aabb::Aabb;
use crate::geometry::mesh::TriMesh;
use crate::geometry::plane::Plane;
use crate::geometry::shape::{Geometry, Shape};
use crate::math::UNIT_ROUNDOFF;

/// Triangles of a block.
const BLOCK: usize = 64;

/// Other blocks that a triangle is held against one by one, at most; else against the box around them.
const NEAR_BLOCKS: usize = 32;

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
            repeats::find(object, mesh, found);
        }
    }
    between_meshes(geometry, neighbours, matters, found);
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

/// A triangle that may lie on another object's.
struct Candidate {
    object: u32,
    primitive: u32,
    extent: Extent,
}

/// A few triangles of a mesh in a row, with the box around them.
struct Block {
    object: u32,
    first: u32,
    lo: DVec3,
    hi: DVec3,
}

fn between_meshes(
    geometry: &[Geometry],
    neighbours: &[Vec<u32>],
    matters: &(dyn Fn(usize, usize) -> bool + Sync),
    found: &mut Found,
) {
    let mesh_of = |o: u32| match &geometry[o as usize].shape {
        Shape::Mesh(mesh) => Some(mesh),
        _ => None,
    };
    let mut blocks: Vec<Block> = Vec::new();
    for (object, neighbours) in neighbours.iter().enumerate() {
        let Some(mesh) = mesh_of(object as u32) else { continue };
        if neighbours.iter().any(|&other| mesh_of(other).is_some()) {
            let firsts = (0..mesh.triangles.len() as u32).into_par_iter().step_by(BLOCK);
            blocks.par_extend(firsts.filter_map(|first| Block::of(object as u32, mesh, first)));
        }
    }
    let boxes = blocks.iter().zip(0..).map(|(b, id)| Item { extent: boxed(b.lo, b.hi), group: b.object, id }).collect();
    let meet = |i: u32, j: u32| matters(blocks[i as usize].object as usize, blocks[j as usize].object as usize);
    let mut near: Vec<[u32; 2]> = join::pairs(boxes, &meet);
    near.extend_from_within(..);
    let half = near.len() / 2;
    near[half..].iter_mut().for_each(|pair| pair.reverse());
    near.par_sort_unstable();

    let Some((lo, hi)) = near.iter().map(|pair| &blocks[pair[0] as usize]).map(|b| (b.lo, b.hi)).reduce(around) else {
        return;
    };
    let centre = (lo + hi) * 0.5;
    let parts: Vec<&[[u32; 2]]> = near.chunk_by(|a, b| a[0] == b[0]).collect();
    let mut faces: Vec<Vec<u32>> = parts
        .par_iter()
        .map(|part| {
            let block = &blocks[part[0][0] as usize];
            let mesh = mesh_of(block.object).expect("blocks are of meshes");
            let mut others: Vec<(DVec3, DVec3)> =
                part.iter().map(|pair| &blocks[pair[1] as usize]).map(|b| (b.lo, b.hi)).collect();
            if others.len() > NEAR_BLOCKS {
                others = others.into_iter().reduce(around).into_iter().collect();
            }
            let end = mesh.triangles.len().min(block.first as usize + BLOCK) as u32;
            (block.first..end).filter(|&i| mesh.is_usable(i as usize) && reaches(mesh, i, &others)).collect()
        })
        .collect();
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut first = 0;
    for same in parts.chunk_by(|a, b| blocks[a[0][0] as usize].object == blocks[b[0][0] as usize].object) {
        let object = blocks[same[0][0][0] as usize].object;
        let mesh = mesh_of(object).expect("blocks are of meshes");
        let mine: Vec<u32> = faces[first..first + same.len()].iter_mut().flat_map(std::mem::take).collect();
        first += same.len();
        let mine = repeats::distinct(object as usize, mesh, mine, found);
        candidates.par_extend(mine.into_par_iter().filter_map(|i| Candidate::of(object, mesh, i, centre)));
    }
    let items = candidates.iter().zip(0..).map(|(c, id)| Item { extent: c.extent, group: c.object, id }).collect();
    let coincide = |i: u32, j: u32| {
        let [a, b] = [i, j].map(|k| &candidates[k as usize]);
        if !matters(a.object as usize, b.object as usize) {
            return false;
        }
        let [a, b] = [a, b].map(|c| Face::of(geometry, c.object, c.primitive));
        // Which of two is projected onto the other must not depend on the order of objects.
        overlap::coincide(&a, &b) || overlap::coincide(&b, &a)
    };
    let id = |k: u32| (candidates[k as usize].object, candidates[k as usize].primitive);
    found.faces.par_extend(join::pairs(items, &coincide).into_par_iter().map(|[i, j]| {
        let (a, b) = (id(i), id(j));
        [a.min(b), a.max(b)]
    }));
}

/// The box around two boxes.
fn around(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> (DVec3, DVec3) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// A box in space alone.
fn boxed(lo: DVec3, hi: DVec3) -> Extent {
    Extent::new(std::array::from_fn(|axis| if axis < 3 { (lo[axis], hi[axis]) } else { (0.0, 0.0) }))
}

/// The box of a triangle grown by the tolerance of its coordinates.
fn box_of(corners: [Vec3; 3]) -> (DVec3, DVec3) {
    let [a, b, c] = corners;
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    let margin = tolerance(f64::from(lo.abs().max(hi.abs()).max_element()));
    (lo.as_dvec3() - margin, hi.as_dvec3() + margin)
}

/// Returns true if the box of a triangle overlaps one of some boxes.
fn reaches(mesh: &TriMesh, triangle: u32, boxes: &[(DVec3, DVec3)]) -> bool {
    let (lo, hi) = box_of(mesh.corners(triangle as usize));
    boxes.iter().any(|other| lo.cmple(other.1).all() && other.0.cmple(hi).all())
}

impl Block {
    /// None where no triangle can be hit.
    fn of(object: u32, mesh: &TriMesh, first: u32) -> Option<Self> {
        let end = mesh.triangles.len().min(first as usize + BLOCK);
        let usable = (first as usize..end).filter(|&i| mesh.is_usable(i));
        let bounds = usable.fold(Aabb::EMPTY, |all, i| all.union(Aabb::of(&mesh.corners(i))));
        let (lo, hi) = grown(&bounds);
        (!bounds.is_empty()).then_some(Self { object, first, lo, hi })
    }
}

impl Candidate {
    /// None for a triangle without area. `centre` is the same for all.
    fn of(object: u32, mesh: &TriMesh, primitive: u32, centre: DVec3) -> Option<Self> {
        let corners = mesh.corners(primitive as usize);
        let (lo, hi) = box_of(corners);
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let spanned = (b - a).cross(c - a);
        let area = spanned.length();
        if !(area > 0.0 && area.is_finite()) {
            return None;
        }
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let largest = lo.abs().max(hi.abs()).max_element();
        let normal = spanned / area;
        let from_centre = (a + b + c) / 3.0 - centre;
        let turned = 4.0 * f64::from(UNIT_ROUNDOFF) * largest * longest / area;
        // The foot of the perpendicular from the centre, and the squares of the normal: neither depends on its sign.
        let foot = normal * normal.dot(from_centre);
        let moved = turned * (from_centre.length() + foot.length()) + 2.0 * tolerance(largest);
        let squares = normal * normal;
        let bent = 2.0 * turned + turned * turned + 1e-9;
        let extent = Extent::new(std::array::from_fn(|axis| match axis {
            0..3 => (lo[axis], hi[axis]),
            3..6 => (foot[axis - 3] - moved, foot[axis - 3] + moved),
            _ => (squares[axis - 6] - bent, squares[axis - 6] + bent),
        }));
        Some(Self { object, primitive, extent })
    }
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
        for i in repeats::distinct(other, mesh, on, found) {
            found.coincide((object as u32, 0), (other as u32, i));
        }
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
