//! Sizes of shapes at which Embree finds all hits, and where on a triangle they are.
//!
//! Embree's triangle tests compute the distance along a ray as a quotient. Its numerator multiplies a distance by the
//! product of two edges, `v0 . (e1 x e2)`. In `f32` such a product of three lengths overflows, and underflows, long
//! before its factors do. A distance that is infinite or 0 counts as no hit, so meshes vanish without an error.
//! Tessellated balls seen from thirty radii away vanish from a radius of 1e13 up (Embree 4.4.0, both modes), and all
//! balls from 1e-15 down. It takes determinants below 1e-18 for 0 and the hit for a corner of its triangle. A mesh of size
//! 1e-6 has such triangles from a thousand to its width on; there the error is below a pixel. The native path scales its products and keeps to
//! [`COORDINATE_LIMIT`](crate::geometry::COORDINATE_LIMIT).

use rayon::prelude::*;

use crate::error::Unavailable;
use crate::geometry::{Geometry, Shape, TriMesh};

/// Largest coordinate that Embree is given, in scene units. Two edges of 2e12 and a distance of eighty times this
/// coordinate multiply to the largest `f32`.
pub const MOST: f32 = 1e12;

/// Smallest size of a scene of meshes: the least value of their largest coordinate, in scene units. Edges of a thousandth of
/// it multiply to Embree's least determinant, 1e-18.
pub const LEAST: f32 = 1e-6;

/// Checks that Embree finds all shapes.
///
/// # Errors
/// [`Unavailable::OutOfReach`] with the first shape that Embree would lose.
pub fn check(geometry: &[Geometry]) -> Result<(), Unavailable> {
    let mut meshes = None;
    for (shape, g) in geometry.iter().enumerate() {
        let size = match &g.shape {
            Shape::Mesh(mesh) => farthest(mesh),
            Shape::Sphere(s) if s.is_usable() => s.centre.abs().max_element() + s.radius,
            Shape::Sphere(_) | Shape::Plane(_) => 0.0,
        };
        if size > MOST {
            return Err(Unavailable::OutOfReach { shape, why: "reaches beyond 1e12, where Embree loses hits" });
        }
        if matches!(g.shape, Shape::Mesh(_)) && size > 0.0 {
            let (first, largest) = meshes.unwrap_or((shape, 0.0_f32));
            meshes = Some((first, largest.max(size)));
        }
    }
    match meshes {
        Some((shape, largest)) if largest < LEAST => {
            let why = "lies within 1e-6 of the origin, where Embree loses hits and digits";
            Err(Unavailable::OutOfReach { shape, why })
        }
        _ => Ok(()),
    }
}

/// Largest coordinate of the triangles that can be hit; 0 if there are none.
fn farthest(mesh: &TriMesh) -> f32 {
    let size = |p: &glam::Vec3| p.abs().max_element();
    let all = mesh.positions.iter().map(size).fold(0.0, f32::max);
    // Meshes of ordinary size pass, without a test of which triangles can be hit.
    if (LEAST..=MOST).contains(&all) && mesh.positions.iter().all(|p| p.is_finite()) {
        return all;
    }
    let usable = (0..mesh.triangles.len()).into_par_iter().filter(|&i| mesh.is_usable(i));
    usable.map(|i| mesh.corners(i).iter().map(size).fold(0.0, f32::max)).reduce(|| 0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::{GeometryMask, Plane, Sphere};

    #[test]
    fn the_first_shape_that_would_be_lost_is_named_and_what_cannot_be_hit_is_not() {
        let of = |shape| Geometry { shape, mask: GeometryMask::ALL };
        let ball = |centre, radius| of(Shape::Sphere(Sphere { centre: Vec3::splat(centre), radius }));
        let mesh = |size: f32, triangles| {
            let positions = vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size, Vec3::splat(1e30)];
            of(Shape::Mesh(TriMesh { positions, triangles, ..TriMesh::default() }))
        };
        let plane = of(Shape::Plane(Plane { point: Vec3::splat(1e15), normal: Vec3::Y }));
        let tiny = mesh(1e-13, vec![[0, 1, 2]]);
        let near = [mesh(1e12, vec![[0, 1, 2], [0, 1, 3]]), ball(4e11, 5e11), ball(1e30, 1.0), plane, tiny.clone()];
        let lost = |shapes: &[Geometry]| match check(shapes) {
            Ok(()) => None,
            Err(Unavailable::OutOfReach { shape, .. }) => Some(shape),
            Err(other) => panic!("{other}"),
        };
        assert_eq!(lost(&near), None);
        for far in [mesh(1.1e12, vec![[0, 1, 2]]), ball(6e11, 5e11), ball(0.0, 1e14)] {
            let shapes: Vec<_> = near.iter().cloned().chain([far]).collect();
            assert_eq!(lost(&shapes), Some(near.len()));
        }
        // Small shapes are lost only if there are no larger ones, since rays are as long as the scene.
        assert_eq!(lost(&[ball(0.0, 1.0), tiny]), Some(1));
        assert_eq!(lost(&[ball(0.0, 1e-15)]), None);
        assert_eq!(lost(&[mesh(0.0, vec![[0, 1, 2]])]), None);
    }
}
