use std::collections::HashMap;

use glam::{Vec2, Vec3};

use crate::geometry::TriMesh;

/// Returns the unit cube around the origin, each face as `n` by `n` (at least 1) squares of two triangles. Faces are
/// flat and edges sharp, so it has no normals. Each face shows a whole picture.
#[must_use]
pub fn cuboid(n: u32) -> TriMesh {
    let n = n.max(1);
    let mut mesh = TriMesh::default();
    // Corners by their position in a lattice of n + 1 steps each way, so that faces share the corners of their edges.
    let mut corners: HashMap<[u32; 3], u32> = HashMap::new();
    for axis in 0..3 {
        for far in [false, true] {
            let first_uv = mesh.uvs.len() as u32;
            for t in 0..=n {
                mesh.uvs.extend((0..=n).map(|s| Vec2::new(s as f32 / n as f32, t as f32 / n as f32)));
            }
            for t in 0..n {
                for s in 0..n {
                    let mut square = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[ds, dt]| {
                        let mut place = [0; 3];
                        place[axis] = if far { n } else { 0 };
                        place[(axis + 1) % 3] = s + ds;
                        place[(axis + 2) % 3] = t + dt;
                        let next = corners.len() as u32;
                        let corner = *corners.entry(place).or_insert_with(|| {
                            let at = |i: u32| (f64::from(i) / f64::from(n) - 0.5) as f32;
                            mesh.positions.push(Vec3::from(place.map(at)));
                            next
                        });
                        (corner, first_uv + (t + dt) * (n + 1) + s + ds)
                    });
                    // Counter-clockwise about +axis, which is right for the far face.
                    if !far {
                        square.reverse();
                    }
                    for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                        mesh.triangles.push([square[a].0, square[b].0, square[c].0]);
                        mesh.uv_indices.push([square[a].1, square[b].1, square[c].1]);
                    }
                }
            }
        }
    }
    mesh
}
