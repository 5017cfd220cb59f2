use glam::DVec2;

use super::revolve::{Profile, revolve};
use crate::geometry::TriMesh;
use crate::load::transform::sin_cos_degrees;

/// Returns the unit sphere around the origin, as `bands` (at least 2; fewer count as 2) bands of latitude and twice as
/// many of longitude. It has `4 bands (bands - 1)` triangles with smooth normals.
#[must_use]
pub fn sphere(bands: u32) -> TriMesh {
    let bands = bands.max(2);
    let points: Vec<DVec2> = (0..=bands)
        .map(|i| {
            let (y, r) = sin_cos_degrees(180.0 * f64::from(i) / f64::from(bands) - 90.0);
            DVec2::new(r, y)
        })
        .collect();
    let normals = points.windows(2).map(|w| [w[0], w[1]]).collect();
    revolve(&Profile { points, looped: false, normals: Some(normals) }, 2 * bands)
}
