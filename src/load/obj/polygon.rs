//! Triangulation of polygons; every corner is kept.

use glam::{DVec2, DVec3};

/// Largest concave polygon that is triangulated; the cost grows with at least the square of its corners.
pub(in crate::load) const MOST_CONCAVE_CORNERS: usize = 8_192;
/// Number of corner visits per polygon after which triangulation gives up: some seconds.
const MOST_LOOKS: u64 = 1 << 30;

/// Reason for not triangulating a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::load) enum Refusal {
    /// It is concave and has more than [`MOST_CONCAVE_CORNERS`].
    TooManyCorners,
    /// Triangulation exceeds [`MOST_LOOKS`].
    TooSlow,
}

/// Triangulates the polygon through `points` into `points.len() - 2` triangles of indices. For any simple, nearly
/// planar polygon the triangles do not overlap. The result is a fan if the first corner sees the whole polygon, else
/// ears are cut (Meisters 1975). Corners on a straight edge are kept, since neighbours may need them, and may leave
/// triangles without area. Coordinates are accurate to `rounding`, and smaller dents are ignored.
///
/// # Errors
/// Fails if the polygon is concave and has too many corners or winds too much.
pub(in crate::load) fn triangulate(points: &[DVec3], rounding: f64, out: &mut Vec<[usize; 3]>) -> Result<(), Refusal> {
    let count = points.len();
    if count == 3 {
        out.push([0, 1, 2]);
        return Ok(());
    }
    let flat = flatten(points);
    if is_fan(&flat, rounding) {
        out.extend((1..count - 1).map(|i| [0, i, i + 1]));
        return Ok(());
    }
    if count > MOST_CONCAVE_CORNERS {
        return Err(Refusal::TooManyCorners);
    }
    if cut_ears(&flat, out) { Ok(()) } else { Err(Refusal::TooSlow) }
}

/// Projects the polygon along its mean normal (Newell's method), counter-clockwise, relative to its first corner.
fn flatten(points: &[DVec3]) -> Vec<DVec2> {
    let around: Vec<DVec3> = points.iter().map(|&p| p - points[0]).collect();
    let normal: DVec3 = (0..around.len()).map(|i| around[i].cross(around[(i + 1) % around.len()])).sum();
    let size = normal.abs();
    // Dropping the largest axis keeps the other two in cyclic order, so the sign of the area is kept.
    let (pick, sign): (fn(&DVec3) -> DVec2, f64) = if size.x >= size.y && size.x >= size.z {
        (|p| DVec2::new(p.y, p.z), normal.x)
    } else if size.y >= size.z {
        (|p| DVec2::new(p.z, p.x), normal.y)
    } else {
        (|p| DVec2::new(p.x, p.y), normal.z)
    };
    let turn = if sign < 0.0 { DVec2::new(-1.0, 1.0) } else { DVec2::ONE };
    around.iter().map(|p| pick(p) * turn).collect()
}

/// Returns twice the signed area of a triangle; above 0 for counter-clockwise order.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Returns true if the fan from the first corner covers the polygon once. No triangle may be turned over by more than
/// `slack` times the sum of its sides there, and together they may go round at most once.
fn is_fan(points: &[DVec2], slack: f64) -> bool {
    let mut angle = 0.0;
    for w in points[1..].windows(2) {
        let (a, b) = (w[0] - points[0], w[1] - points[0]);
        let area = a.perp_dot(b);
        if area < -slack * (a.length() + b.length()) {
            return false;
        }
        angle += area.max(0.0).atan2(a.dot(b));
    }
    angle < std::f64::consts::TAU * (1.0 + 1e-9)
}

/// Triangulates by cutting ears. Returns false if it exceeds [`MOST_LOOKS`].
fn cut_ears(points: &[DVec2], out: &mut Vec<[usize; 3]>) -> bool {
    let mut looks = 0;
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut at = 0;
    let mut failures = 0;
    // If a whole round cuts nothing, the polygon crosses itself, and a triangle is cut anyway.
    while left.len() > 3 {
        let count = left.len();
        looks += count as u64;
        if looks > MOST_LOOKS {
            return false;
        }
        at %= count;
        let [i, j, k] = [left[(at + count - 1) % count], left[at], left[(at + 1) % count]];
        if failures >= count || is_ear(points, &left, [i, j, k]) {
            out.push([i, j, k]);
            left.remove(at);
            // Continuing with the corner after the next gives rounder triangles than a fan.
            failures = 0;
        } else {
            failures += 1;
        }
        at += 1;
    }
    out.push([left[0], left[1], left[2]]);
    true
}

/// Returns true if the triangle at corner `j` turns left and contains no other corner.
fn is_ear(points: &[DVec2], left: &[usize], [i, j, k]: [usize; 3]) -> bool {
    let (a, b, c) = (points[i], points[j], points[k]);
    if area(a, b, c) <= 0.0 {
        return false;
    }
    !left
        .iter()
        .map(|&m| points[m])
        .any(|p| p != a && p != b && p != c && area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(outline: &[[f64; 2]], lift: fn(f64, f64) -> DVec3) -> (Vec<[usize; 3]>, f64, f64) {
        let points: Vec<DVec3> = outline.iter().map(|p| lift(p[0], p[1])).collect();
        let mut triangles = Vec::new();
        triangulate(&points, 1e-6, &mut triangles).unwrap();
        assert_eq!(triangles.len(), points.len() - 2);
        let whole: DVec3 = (0..points.len()).map(|i| points[i].cross(points[(i + 1) % points.len()])).sum();
        let normal = whole.normalize();
        let parts: Vec<f64> = triangles
            .iter()
            .map(|t| (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).dot(normal))
            .collect();
        assert!(parts.iter().all(|&a| a > -1e-12), "{triangles:?} {parts:?}");
        (triangles.clone(), parts.iter().sum(), whole.length())
    }

    /// Case IO-08 of the catalogue.
    #[test]
    fn a_concave_quad_does_not_overlap_itself_whatever_plane_and_first_corner() {
        let dart = [[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]];
        let lifts: [fn(f64, f64) -> DVec3; 4] = [
            |x, y| DVec3::new(x, y, 0.0),
            |x, y| DVec3::new(y, x, 3.0),
            |x, y| DVec3::new(5.0, x, y),
            |x, y| DVec3::new(x, 0.3 * x, -y),
        ];
        for lift in lifts {
            for first in 0..4 {
                let mut turned = dart;
                turned.rotate_left(first);
                let (_, sum, whole) = cut(&turned, lift);
                assert!((sum - whole).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_comb_and_a_spiral_are_covered_exactly_once() {
        let mut comb = vec![[0.0, 0.0], [20.0, 0.0]];
        for i in (0..10).rev() {
            comb.extend([[2.0 * f64::from(i) + 1.5, 5.0], [2.0 * f64::from(i) + 0.5, 0.5]]);
        }
        let (_, sum, whole) = cut(&comb, |x, y| DVec3::new(x, y, 1.0));
        assert!((sum - whole).abs() < 1e-9);
    }

    #[test]
    fn corners_on_straight_edges_are_all_kept() {
        let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
        let (triangles, sum, whole) = cut(&square, |x, y| DVec3::new(x, y, 0.0));
        assert_eq!(sum, whole);
        for corner in 0..square.len() {
            assert!(triangles.iter().flatten().any(|&i| i == corner));
        }
    }

    #[test]
    fn a_polygon_of_no_area_or_that_crosses_itself_still_ends() {
        let mut out = Vec::new();
        triangulate(&[DVec3::ZERO; 6], 0.0, &mut out).unwrap();
        let bow = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::X, DVec3::Y];
        triangulate(&bow, 1e-7, &mut out).unwrap();
        let star: Vec<DVec3> =
            (0..5).map(|i| DVec3::new((f64::from(i) * 2.5133).cos(), (f64::from(i) * 2.5133).sin(), 0.0)).collect();
        triangulate(&star, 1e-7, &mut out).unwrap();
        assert_eq!(out.len(), 4 + 2 + 3);
    }
}
