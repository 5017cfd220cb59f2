//! Normals that pictures give, in the same arithmetic for both renderers.

use glam::{DVec2, DVec3};

use crate::geometry::{Shape, TriMesh};
use crate::scene::{Relief, Scene};

/// Returns the unit normal of a point of a mesh whose material has a relief; `None` without one, or where the mesh has no
/// texture coordinates that span its surface. `normal` is the unit normal without relief, on the outside, and `u` and `v`
/// are the weights of the triangle's second and third corner.
#[must_use]
pub fn embossed(scene: &Scene, object: u32, triangle: u32, [u, v]: [f64; 2], normal: DVec3) -> Option<DVec3> {
    let relief = scene.materials[scene.objects[object as usize].material as usize].relief?;
    let Shape::Mesh(mesh) = &scene.geometry[object as usize].shape else { return None };
    on_triangle(scene, relief, mesh, triangle as usize, [u, v], normal)
}

fn on_triangle(
    scene: &Scene,
    relief: Relief,
    mesh: &TriMesh,
    triangle: usize,
    [u, v]: [f64; 2],
    normal: DVec3,
) -> Option<DVec3> {
    let [a, b, c] = mesh.corners(triangle).map(|p| p.as_dvec3());
    let places: [DVec2; 3] = mesh.corner_uvs(triangle)?.map(|p| p.as_dvec2());
    // The directions in which u and v of the picture grow.
    let [first, second] = [places[1] - places[0], places[2] - places[0]];
    let turn = first.perp_dot(second).signum();
    let along_u = ((b - a) * second.y - (c - a) * first.y) * turn;
    let along_v = ((c - a) * first.x - (b - a) * second.x) * turn;
    let tangent = (along_u - normal * normal.dot(along_u)).try_normalize()?;
    let across = normal.cross(tangent);
    let bitangent = if across.dot(along_v) < 0.0 { -across } else { across };
    let place = places[0] * (1.0 - u - v) + places[1] * u + places[2] * v;
    let code = scene.textures[relief.texture as usize].on_surface(place.x, place.y);
    let strength = f64::from(relief.strength);
    let [x, y, z] = (code * 2.0 - 1.0).to_array();
    (tangent * (x * strength) + bitangent * (y * strength) + normal * z).try_normalize()
}
