use glam::{DVec2, DVec3, Vec2};

use crate::geometry::TriMesh;
use crate::load::transform::sin_cos_degrees;

/// Wave of a height field: `amplitude sin(2 pi (d . p) / wavelength + phase)`, where `d` is its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Height above and below the level, in scene units.
    pub amplitude: f64,
    /// Distance from crest to crest, above 0.
    pub wavelength: f64,
    /// Direction in degrees, from +x towards +z.
    pub direction: f64,
    /// Phase at the origin, in degrees.
    pub phase: f64,
}

/// Returns a surface over the rectangle `size` (x, z; above 0) around the origin, at height `level` plus all `waves`.
/// It has `n` by `n` (at least 1) squares of two triangles, faces up, and has exact normals. With a `depth` it becomes
/// a solid with walls and a bottom at `level - depth`.
///
/// # Errors
/// Returns a message if troughs may reach the bottom.
pub fn heightfield(size: [f64; 2], waves: &[Wave], level: f64, depth: Option<f64>, n: u32) -> Result<TriMesh, String> {
    let n = n.max(1);
    let swing: f64 = waves.iter().map(|w| w.amplitude.abs()).sum();
    if let Some(depth) = depth
        && (depth <= swing || !swing.is_finite())
    {
        return Err(format!("a depth of {depth} leaves no room for waves of {swing} in all"));
    }
    let mut mesh = TriMesh::default();
    for j in 0..=n {
        for i in 0..=n {
            let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let p = DVec2::new((u - 0.5) * size[0], (v - 0.5) * size[1]);
            let (height, slope) = at(waves, p);
            mesh.positions.push(DVec3::new(p.x, level + height, p.y).as_vec3());
            mesh.normals.push(DVec3::new(-slope.x, 1.0, -slope.y).normalize().as_vec3());
            mesh.uvs.push(Vec2::new(u as f32, 1.0 - v as f32));
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
    mesh.normal_indices = mesh.triangles.clone();
    if let Some(depth) = depth {
        close(&mut mesh, n, level - depth);
    }
    mesh.uv_indices = mesh.triangles.clone();
    Ok(mesh)
}

/// Returns the height above the level, and its slope along x and z.
fn at(waves: &[Wave], p: DVec2) -> (f64, DVec2) {
    let mut height = 0.0;
    let mut slope = DVec2::ZERO;
    for wave in waves {
        let (s, c) = sin_cos_degrees(wave.direction);
        let direction = DVec2::new(c, s);
        let number = std::f64::consts::TAU / wave.wavelength;
        let (sin, cos) = (number * direction.dot(p) + wave.phase.to_radians()).sin_cos();
        height += wave.amplitude * sin;
        slope += direction * (wave.amplitude * number * cos);
    }
    (height, slope)
}

/// Adds four walls, and a bottom with one corner below each corner of the rim.
fn close(mesh: &mut TriMesh, n: u32, bottom: f64) {
    let corner = |i: u32, j: u32| j * (n + 1) + i;
    // Around the rim from +x towards +z, each side with the normal of its wall.
    let sides = [
        ((0..n).map(|i| corner(i, 0)).collect::<Vec<_>>(), DVec3::NEG_Z),
        ((0..n).map(|j| corner(n, j)).collect(), DVec3::X),
        ((0..n).map(|i| corner(n - i, n)).collect(), DVec3::Z),
        ((0..n).map(|j| corner(0, n - j)).collect(), DVec3::NEG_X),
    ];
    let rim: Vec<u32> = sides.iter().flat_map(|(corners, _)| corners.iter().copied()).collect();
    let first = mesh.positions.len() as u32;
    for &top in &rim {
        let mut p = mesh.positions[top as usize];
        p.y = bottom as f32;
        mesh.positions.push(p);
        mesh.uvs.push(mesh.uvs[top as usize]);
    }
    let count = rim.len() as u32;
    let mut push = |triangle: [u32; 3], normal: u32| {
        mesh.triangles.push(triangle);
        mesh.normal_indices.push([normal; 3]);
    };
    let walls = mesh.normals.len() as u32;
    for k in 0..count {
        let next = (k + 1) % count;
        let (a, b) = (rim[k as usize], rim[next as usize]);
        let (c, d) = (first + next, first + k);
        push([a, b, c], walls + k / n);
        push([a, c, d], walls + k / n);
    }
    mesh.normals.extend(sides.map(|(_, normal)| normal.as_vec3()));
    // The bottom is a fan around its middle.
    let down = mesh.normals.len() as u32;
    let middle = mesh.positions.len() as u32;
    for k in 0..count {
        push([middle, first + k, first + (k + 1) % count], down);
    }
    mesh.normals.push(DVec3::NEG_Y.as_vec3());
    mesh.positions.push(DVec3::new(0.0, bottom, 0.0).as_vec3());
    mesh.uvs.push(Vec2::splat(0.5));
}
