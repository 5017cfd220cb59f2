//! Detection of closed meshes that are inside out: their faces point inwards.

use glam::{DVec3, Vec3};

use crate::geometry::{Aabb, TriMesh};

/// Share of its terms' magnitudes below which a signed volume counts as zero, since its sign may be rounding.
const SIGNIFICANT: f64 = 1e-12;

/// Number of parts above which a mesh is judged by its whole volume instead of comparing its parts.
const MOST_PARTS: usize = 1000;

/// Numbers of the outermost parts of a closed mesh, and of those that are inside out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct InsideOut {
    /// Number of parts whose faces point inwards.
    pub parts: usize,
    /// Number of all outermost parts.
    pub of: usize,
}

/// Connected triangles.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// First corner of its first triangle, the reference point of volumes.
    origin: DVec3,
    /// Six times the signed volume, above zero if faces point outwards.
    volume: f64,
    /// Sum of the magnitudes of the volume's terms.
    terms: f64,
    bounds: Aabb,
}

/// Finds the inside-out parts of a closed mesh with consistent winding, by their signed volumes. Returns `None` if all
/// outermost parts point outwards. A part within another one may point either way: it may be the wall of a hollow.
/// Corners `i` at one position share one `weld[i]`.
pub(super) fn inside_out(mesh: &TriMesh, weld: &[u32]) -> Option<InsideOut> {
    let parts = parts(mesh, weld);
    // Most meshes return here.
    if parts.iter().all(|p| p.volume >= 0.0) {
        return None;
    }
    if parts.len() > MOST_PARTS {
        let (volume, terms) = parts.iter().fold((0.0, 0.0), |(v, t), p| (v + p.volume, t + p.terms));
        return (-volume > SIGNIFICANT * terms).then_some(InsideOut { parts: 1, of: 1 });
    }
    let significant: Vec<&Part> = parts.iter().filter(|p| p.volume.abs() > SIGNIFICANT * p.terms).collect();
    let holds =
        |outer: &Part, part: &Part| outer.volume.abs() > part.volume.abs() && outer.bounds.contains(&part.bounds);
    let outermost = significant.iter().filter(|part| !significant.iter().any(|other| holds(other, part)));
    let (mut inwards, mut all) = (0, 0);
    for part in outermost {
        all += 1;
        inwards += usize::from(part.volume < 0.0);
    }
    (inwards > 0).then_some(InsideOut { parts: inwards, of: all })
}

/// Returns the connected parts of a mesh. Triangles that share a corner belong to one part.
fn parts(mesh: &TriMesh, weld: &[u32]) -> Vec<Part> {
    let mut parent: Vec<u32> = (0..weld.len() as u32).collect();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| root(&mut parent, weld[i as usize]));
        parent[b as usize] = a;
        // `b` may have been the root of `c`.
        let c = root(&mut parent, c);
        parent[c as usize] = a;
    }
    let mut parts: Vec<Part> = Vec::new();
    let mut number = vec![u32::MAX; weld.len()];
    for t in &mesh.triangles {
        let corners: [Vec3; 3] = t.map(|i| mesh.positions[i as usize]);
        let number = &mut number[root(&mut parent, weld[t[0] as usize]) as usize];
        if *number == u32::MAX {
            *number = parts.len() as u32;
            parts.push(Part { origin: corners[0].as_dvec3(), volume: 0.0, terms: 0.0, bounds: Aabb::EMPTY });
        }
        let part = &mut parts[*number as usize];
        let [a, b, c] = corners.map(|p| p.as_dvec3() - part.origin);
        let term = a.dot(b.cross(c));
        part.volume += term;
        part.terms += term.abs();
        part.bounds = corners.iter().fold(part.bounds, |bounds, &p| bounds.with(p));
    }
    parts
}

/// Returns the representative of the corners connected with `i`.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::topology::weld;

    /// Cube of edge `2 h` around `centre`, with its faces outwards or inwards.
    fn cube(centre: Vec3, h: f32, outwards: bool) -> TriMesh {
        let corner = |i: u32| centre + h * Vec3::new(sign(i & 1), sign(i >> 1 & 1), sign(i >> 2));
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let mut triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        if !outwards {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        TriMesh { positions: (0..8).map(corner).collect(), triangles, ..TriMesh::default() }
    }

    fn sign(bit: u32) -> f32 {
        if bit == 0 { -1.0 } else { 1.0 }
    }

    /// Joins several meshes.
    fn joined(meshes: &[TriMesh]) -> TriMesh {
        let mut all = TriMesh::default();
        for mesh in meshes {
            let first = all.positions.len() as u32;
            all.positions.extend(&mesh.positions);
            all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + first)));
        }
        all
    }

    fn judged(meshes: &[TriMesh]) -> Option<(usize, usize)> {
        let mesh = joined(meshes);
        inside_out(&mesh, &weld(&mesh.positions)).map(|found| (found.parts, found.of))
    }

    #[test]
    fn a_cube_is_inside_out_where_its_faces_point_inwards_at_any_size_and_place() {
        for h in [1e-12, 1.0, 1e12] {
            for at in [Vec3::ZERO, Vec3::new(3.0, -5.0, 7.0) * h] {
                assert_eq!(judged(&[cube(at, h, true)]), None, "{h} at {at}");
                assert_eq!(judged(&[cube(at, h, false)]), Some((1, 1)), "{h} at {at}");
            }
        }
    }

    #[test]
    fn the_wall_of_a_hollow_is_right_and_a_ball_beside_it_is_judged_by_itself() {
        let (outer, hollow) = (cube(Vec3::ZERO, 2.0, true), cube(Vec3::ZERO, 1.0, false));
        assert_eq!(judged(&[outer.clone(), hollow.clone()]), None);
        let (turned, core) = (cube(Vec3::ZERO, 2.0, false), cube(Vec3::ZERO, 1.0, true));
        assert_eq!(judged(&[turned, core]), Some((1, 1)));
        let beside = cube(Vec3::X * 9.0, 1.0, false);
        assert_eq!(judged(&[outer, hollow, beside]), Some((1, 2)));
    }

    #[test]
    fn a_mesh_without_volume_is_not_judged() {
        // Both sides of a square.
        let square = TriMesh {
            positions: [[0.1, 0.2, 0.3], [1.1, 0.2, 0.3], [1.1, 1.3, 0.4], [0.1, 1.3, 0.4]].map(Vec3::from).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]],
            ..TriMesh::default()
        };
        assert_eq!(judged(&[square]), None);
        assert_eq!(judged(&[]), None);
    }

    #[test]
    fn corners_that_are_stored_twice_are_one() {
        // Every triangle with corners of its own.
        let shared = cube(Vec3::ONE, 1.0, false);
        let positions = shared.triangles.iter().flatten().map(|&i| shared.positions[i as usize]).collect();
        let triangles = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        assert_eq!(judged(&[TriMesh { positions, triangles, ..TriMesh::default() }]), Some((1, 1)));
    }

    #[test]
    fn a_mesh_of_many_parts_is_judged_as_a_whole() {
        let row = |outwards| (0..1200).map(|i| cube(Vec3::X * 3.0 * i as f32, 1.0, outwards)).collect::<Vec<_>>();
        assert_eq!(judged(&row(true)), None);
        assert_eq!(judged(&row(false)), Some((1, 1)));
    }
}
