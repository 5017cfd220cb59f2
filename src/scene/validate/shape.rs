//! Checks of shapes.

use super::Check;
use crate::geometry::{Shape, TriMesh};

/// Checks that the shape can be met, and that its lists fit each other.
///
/// Triangles that no ray can meet are left out by accelerators, which count them; they are no error.
pub(super) fn check(check: &mut Check<'_>, shape: &Shape) {
    match shape {
        Shape::Mesh(mesh) => lists(check, mesh),
        Shape::Sphere(sphere) => {
            let shown = format_args!("of radius {} around {}", sphere.radius, sphere.centre);
            check.that(sphere.is_usable(), "the sphere", shown, "of a radius above 0, within 1.844e18 of the origin");
        }
        Shape::Plane(plane) => {
            let shown = format_args!("through {} with normal {}", plane.point, plane.normal);
            let must = "through a point within 1.844e18 of the origin, with a normal of unit length";
            check.that(plane.is_usable(), "the plane", shown, must);
        }
    }
}

fn lists(check: &mut Check<'_>, mesh: &TriMesh) {
    let triangles = mesh.triangles.len();
    indices(check, "a corner of a triangle", &mesh.triangles, mesh.positions.len());
    if !mesh.normals.is_empty() || !mesh.normal_indices.is_empty() {
        check.length("normal_indices", mesh.normal_indices.len(), triangles);
        indices(check, "an index of a normal", &mesh.normal_indices, mesh.normals.len());
        if let Some(bad) = mesh.normals.iter().find(|n| !n.is_finite()) {
            check.that(false, "a normal", bad, "finite");
        }
    }
    if !mesh.uvs.is_empty() || !mesh.uv_indices.is_empty() {
        check.length("uv_indices", mesh.uv_indices.len(), triangles);
        indices(check, "an index of a texture coordinate", &mesh.uv_indices, mesh.uvs.len());
    }
    if !mesh.colours.is_empty() {
        check.length("colours", mesh.colours.len(), mesh.positions.len());
        if let Some(bad) = mesh.colours.iter().find(|c| !c.is_finite()) {
            check.that(false, "a colour of a corner", bad, "finite");
        }
    }
}

/// Reports the first index that is out of range.
fn indices(check: &mut Check<'_>, field: &'static str, lists: &[[u32; 3]], len: usize) {
    if let Some(&index) = lists.as_flattened().iter().find(|&&index| index as usize >= len) {
        check.index(field, index, len);
    }
}
