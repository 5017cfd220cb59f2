use glam::DVec2;

use super::revolve::{Profile, revolve};
use crate::geometry::TriMesh;
use crate::load::transform::sin_cos_degrees;

/// Returns a torus about the y axis, with smooth normals. The tube has radius `minor` (above 0) and its middle runs at
/// radius `major` (above `minor`). It has `n` steps along the ring and half as many around the tube (each at least 3).
#[must_use]
pub fn torus(major: f64, minor: f64, n: u32) -> TriMesh {
    let around = (n / 2).max(3);
    let directions: Vec<DVec2> = (0..around)
        .map(|i| {
            let (s, c) = sin_cos_degrees(360.0 * f64::from(i) / f64::from(around));
            DVec2::new(c, s)
        })
        .collect();
    let points = directions.iter().map(|&d| DVec2::new(major, 0.0) + d * minor).collect();
    let normals = (0..directions.len()).map(|i| [directions[i], directions[(i + 1) % directions.len()]]).collect();
    revolve(&Profile { points, looped: true, normals: Some(normals) }, n.max(3))
}
