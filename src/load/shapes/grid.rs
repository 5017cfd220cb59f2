use glam::{Vec2, Vec3};

use crate::geometry::TriMesh;

/// Returns the unit square around the origin in the xz plane, facing +y, as `n` by `n` (at least 1) squares of two
/// triangles.
#[must_use]
pub fn grid(n: u32) -> TriMesh {
    let n = n.max(1);
    let at = |i: u32| (f64::from(i) / f64::from(n) - 0.5) as f32;
    let mut mesh = TriMesh::default();
    for j in 0..=n {
        for i in 0..=n {
            mesh.positions.push(Vec3::new(at(i), 0.0, at(j)));
            mesh.uvs.push(Vec2::new(i as f32 / n as f32, 1.0 - j as f32 / n as f32));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
            mesh.triangles.push([a, d, c]);
            mesh.triangles.push([a, c, b]);
        }
    }
    mesh.uv_indices = mesh.triangles.clone();
    mesh
}
