//! Traces rays against a mesh: a torus seen from above as rows of characters, one ray each.
//!
//!     cargo run --example trace_mesh

use std::f32::consts::TAU;

use vitrum::accel::{Accel, Backend, BuildQuality, Intersector as _};
use vitrum::geometry::{Geometry, Ray, TriMesh};
use vitrum::glam::{Vec2, Vec3};

fn main() -> vitrum::Result<()> {
    for row in picture(64, 32)? {
        println!("{row}");
    }
    Ok(())
}

/// The torus by depth: `#` is near, `.` is far, and a space is no hit.
pub fn picture(width: usize, height: usize) -> vitrum::Result<Vec<String>> {
    let accel = Accel::build(Backend::Native, &[Geometry::new(torus(1.0, 0.4, 64))], BuildQuality::Default)?;
    let at = |i: usize, n: usize| (i as f32 + 0.5) / n as f32 * 3.0 - 1.5;
    let rays: Vec<Ray> = (0..width * height)
        .map(|i| Vec2::new(at(i % width, width), at(i / width, height)))
        .map(|p| Ray::new(Vec3::new(p.x, 2.0, p.y), Vec3::NEG_Y))
        .collect();
    let hits = accel.hits(&rays);
    let shade =
        |t: f32| if t.is_infinite() { ' ' } else { ['#', '+', ':', '.'][((t - 1.6) * 10.0).clamp(0.0, 3.0) as usize] };
    Ok(hits.chunks(width).map(|row| row.iter().map(|hit| shade(hit.t)).collect()).collect())
}

/// A torus around the y axis with `n` by `n` corners.
fn torus(major: f32, minor: f32, n: u32) -> TriMesh {
    let angle = |i: u32| i as f32 / n as f32 * TAU;
    let corner = |i: u32| {
        let (around, across) = (Vec2::from_angle(angle(i / n)), Vec2::from_angle(angle(i % n)) * minor);
        Vec3::new(around.x * (major + across.x), across.y, around.y * (major + across.x))
    };
    let index = |i: u32, j: u32| (i % n) * n + j % n;
    let square = |k: u32| {
        let (i, j) = (k / n, k % n);
        let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
        [[a, b, c], [a, c, d]]
    };
    TriMesh::new((0..n * n).map(corner).collect(), (0..n * n).flat_map(square).collect())
}
