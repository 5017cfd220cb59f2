//! Smooth normals for meshes without normals.

use glam::{DVec3, Vec3};

use crate::Result;
use crate::geometry::TriMesh;
use crate::geometry::topology::{self, Edges, Groups, weld};
use crate::system::memory;

/// Rule by which an edge between two triangles is smooth.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rule<'a> {
    /// It bends by less than this angle in degrees.
    Crease(f64),
    /// Both are in the same group, which is not 0, of these for each triangle (the smoothing groups of OBJ).
    Groups(&'a [u32]),
}

/// Adds normals to `mesh` that are smooth across the edges of a rule, and break at the others.
///
/// A vertex normal is the mean of the normals of the faces joined to it through smooth edges, weighted by their angles
/// there (Thürmer & Wüthrich 1998). So it does not depend on how a face was triangulated. Corners at exactly the same
/// position count as one. An edge breaks if it has three or more faces, or two that run along it in the same direction.
///
/// # Errors
/// Returns [`Error::Limit`](crate::Error::Limit) if the work does not fit in memory.
pub(super) fn smooth(mesh: &mut TriMesh, rule: Rule<'_>) -> Result<()> {
    // Per triangle its normal; per corner its group, sum and position, and possibly its normal in a list that grows by
    // doubling.
    let each = size_of::<DVec3>() + 3 * (4 + size_of::<DVec3>() + 4 + 2 * (size_of::<Vec3>() + 4));
    let bytes = topology::bytes(mesh) + (mesh.triangles.len() * each) as u64;
    memory::need(&format!("smooth normals for {} triangles", mesh.triangles.len()), bytes, "take fewer triangles")?;
    let weld = weld(&mesh.positions);
    let flat: Vec<DVec3> = (0..mesh.triangles.len())
        .map(|i| {
            let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
            (b - a).cross(c - a).normalize_or_zero()
        })
        .collect();
    let least = if let Rule::Crease(angle) = rule { angle.to_radians().cos() } else { 1.0 };
    let joins = |a: u32, b: u32| match rule {
        Rule::Crease(_) => flat[a as usize].dot(flat[b as usize]) >= least,
        Rule::Groups(groups) => groups[a as usize] != 0 && groups[a as usize] == groups[b as usize],
    };

    // Joins corners of neighbours across smooth edges.
    let mut groups = Groups::new(mesh.triangles.len() * 3);
    for group in Edges::new(&mesh.triangles, &weld).groups() {
        let [(_, a), (_, b)] = group else { continue };
        if a.upwards == b.upwards || !joins(a.triangle, b.triangle) {
            continue;
        }
        let corner = |triangle: u32, k: u8| triangle * 3 + u32::from(k % 3);
        // Neighbours run along the edge in opposite directions.
        groups.join(corner(a.triangle, a.corner), corner(b.triangle, b.corner + 1));
        groups.join(corner(a.triangle, a.corner + 1), corner(b.triangle, b.corner));
    }

    let mut sums = vec![DVec3::ZERO; mesh.triangles.len() * 3];
    for (i, normal) in flat.iter().enumerate() {
        let p = mesh.corners(i).map(|p| p.as_dvec3());
        for k in 0..3 {
            let (to, from) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            // By the tangent, so that the angle of a sliver keeps its digits.
            let angle = to.cross(from).length().atan2(to.dot(from));
            sums[groups.find((i * 3 + k) as u32) as usize] += *normal * angle;
        }
    }
    let mut places = vec![u32::MAX; sums.len()];
    mesh.normals.clear();
    mesh.normal_indices.clear();
    for (i, own) in flat.iter().enumerate() {
        mesh.normal_indices.push(std::array::from_fn(|k| {
            let root = groups.find((i * 3 + k) as u32) as usize;
            if places[root] == u32::MAX {
                places[root] = mesh.normals.len() as u32;
                let normal = sums[root].try_normalize().or(own.try_normalize());
                mesh.normals.push(normal.map_or(Vec3::Y, |n| n.as_vec3()));
            }
            places[root]
        }));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::shapes::{cuboid, make_flat, sphere};

    #[test]
    fn a_box_stays_sharp_below_ninety_degrees_and_is_round_above() {
        let mut sharp = cuboid(3);
        smooth(&mut sharp, Rule::Crease(89.0)).unwrap();
        assert_eq!(sharp.normals.len(), 6 * 16);
        let mut round = cuboid(1);
        smooth(&mut round, Rule::Crease(91.0)).unwrap();
        // Weighted by angle, every face counts the same at a corner, however its two triangles lie.
        for (p, n) in (0..12).flat_map(|i| std::iter::zip(round.corners(i), round.corner_normals(i).unwrap())) {
            assert!((p.normalize() - n).length() < 1e-6, "{p} {n}");
        }
    }

    #[test]
    fn smoothing_groups_are_round_within_and_sharp_between_whatever_the_angle() {
        let mut mesh = cuboid(1);
        let top = |mesh: &TriMesh, i: usize| mesh.corners(i).iter().all(|p| p.y > 0.0);
        let groups: Vec<u32> = (0..12).map(|i| if top(&mesh, i) { 7 } else { 3 }).collect();
        smooth(&mut mesh, Rule::Groups(&groups)).unwrap();
        for (i, group) in groups.into_iter().enumerate() {
            let normals = mesh.corner_normals(i).unwrap();
            if group == 7 {
                assert_eq!(normals, [Vec3::Y; 3]);
            } else {
                assert!(normals.iter().all(|n| n.abs().max_element() < 0.99), "{normals:?}");
            }
        }
        let mut flat = cuboid(1);
        smooth(&mut flat, Rule::Groups(&[0; 12])).unwrap();
        assert!(flat.normals.iter().all(|n| n.abs().max_element() > 0.999));
    }

    #[test]
    fn a_sphere_gets_the_normals_it_had() {
        let mut mesh = sphere(40);
        let exact = mesh.clone();
        make_flat(&mut mesh);
        smooth(&mut mesh, Rule::Crease(30.0)).unwrap();
        for i in 0..mesh.triangles.len() {
            for (a, b) in mesh.corner_normals(i).unwrap().into_iter().zip(exact.corner_normals(i).unwrap()) {
                assert!(a.dot(b) > 0.9999);
            }
        }
    }

    #[test]
    fn coinciding_corners_of_separate_triangles_are_smoothed_as_one() {
        let mut mesh = sphere(8);
        let soup: Vec<Vec3> = (0..mesh.triangles.len()).flat_map(|i| mesh.corners(i)).collect();
        mesh.triangles = (0..soup.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        mesh.positions = soup;
        smooth(&mut mesh, Rule::Crease(60.0)).unwrap();
        assert_eq!(mesh.normals.len(), 7 * 16 + 2);
    }
}
