use glam::{Vec2, Vec3};

use crate::geometry::TriMesh;
use crate::load::transform::sin_cos_degrees;

/// Returns the unit disc around the origin, facing +y, as a fan of `n` triangles (at least 3).
#[must_use]
pub fn disc(n: u32) -> TriMesh {
    let n = n.max(3);
    let mut mesh = TriMesh { positions: vec![Vec3::ZERO], uvs: vec![Vec2::splat(0.5)], ..TriMesh::default() };
    for i in 0..n {
        let (s, c) = sin_cos_degrees(360.0 * f64::from(i) / f64::from(n));
        let (s, c) = (s as f32, c as f32);
        mesh.positions.push(Vec3::new(c, 0.0, s));
        mesh.uvs.push(Vec2::new(0.5 + 0.5 * c, 0.5 - 0.5 * s));
        mesh.triangles.push([0, 1 + (i + 1) % n, 1 + i]);
    }
    mesh.uv_indices = mesh.triangles.clone();
    mesh
}
