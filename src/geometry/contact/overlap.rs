//! The part of two triangles that lies at the same place.

use arrayvec::ArrayVec;
use glam::{DVec2, DVec3};

use super::face::{Face, Form};
use super::tolerance::tolerance;

/// Corners of the common part of two triangles, at most.
type Polygon = ArrayVec<DVec2, 9>;

/// Returns true if two triangles have a common part with an inside, all of which coincides within [`tolerance`].
/// Triangles that share an edge or a corner alone have none.
pub(super) fn coincide(a: &Face, b: &Face) -> bool {
    let (Form::Triangle { corners: p, normal: n }, Form::Triangle { corners: q, normal: m }) = (a.form, b.form) else {
        return false;
    };
    // Faces that coincide over an area that rounding leaves are parallel, but for the rounding of small ones.
    let facing = n.dot(m);
    if facing.abs() < 0.9 {
        return false;
    }
    let largest = a.largest_coordinate(p[0]).max(b.largest_coordinate(q[0]));
    let near = tolerance(largest);
    let heights = q.map(|corner| n.dot(corner - p[0]));
    if heights.iter().all(|&h| h > near) || heights.iter().all(|&h| h < -near) {
        return false;
    }
    let across = n.any_orthonormal_vector();
    let axes = [across, n.cross(across)];
    let flat = |point: DVec3| DVec2::new((point - p[0]).dot(axes[0]), (point - p[0]).dot(axes[1]));
    let common = common_part(p.map(flat), q.map(flat));
    if !has_inside(&common, 4.0 * near) {
        return false;
    }
    // The first triangle lies at height 0; the second one is a plane over it.
    let lifted = |at: DVec2| {
        let over = p[0] + axes[0] * at.x + axes[1] * at.y;
        -m.dot(over - q[0]) / facing
    };
    common.iter().all(|&at| lifted(at).abs() <= near)
}

/// Clips the second triangle by the edges of the first (Sutherland and Hodgman 1974).
fn common_part(p: [DVec2; 3], q: [DVec2; 3]) -> Polygon {
    let turn = (p[1] - p[0]).perp_dot(p[2] - p[0]).signum();
    let mut polygon: Polygon = q.into_iter().collect();
    for i in 0..3 {
        let (from, to) = (p[i], p[(i + 1) % 3]);
        let inside = |at: DVec2| turn * (to - from).perp_dot(at - from);
        let mut clipped = Polygon::new();
        for (k, &here) in polygon.iter().enumerate() {
            let next = polygon[(k + 1) % polygon.len()];
            let (h, g) = (inside(here), inside(next));
            if h >= 0.0 {
                let _ = clipped.try_push(here);
            }
            if (h > 0.0 && g < 0.0) || (h < 0.0 && g > 0.0) {
                let _ = clipped.try_push(here + (next - here) * (h / (h - g)));
            }
        }
        polygon = clipped;
    }
    polygon
}

/// Returns true if a polygon is wider than `width`: area over half of the perimeter.
fn has_inside(polygon: &Polygon, width: f64) -> bool {
    let edges = || polygon.iter().zip(polygon.iter().cycle().skip(1)).take(polygon.len());
    let Some(&origin) = polygon.first() else { return false };
    let area = edges().map(|(&a, &b)| (a - origin).perp_dot(b - origin)).sum::<f64>().abs() / 2.0;
    let perimeter = edges().map(|(a, b)| a.distance(*b)).sum::<f64>();
    area > 0.5 * width * perimeter
}
