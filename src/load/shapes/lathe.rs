use glam::DVec2;

use super::revolve::{Profile, revolve};
use crate::geometry::TriMesh;

/// Sweeps `profile`, a polyline of points `[r, y]`, about the y axis in `n` steps (at least 3).
///
/// The outside is on the right in the direction of the profile: up the outer wall of a goblet, over the rim, and down
/// the inside. An end at `r = 0` closes the surface there. A profile that ends at its first point makes a closed ring.
/// Any other end stays open. Corners of the profile that bend by at most `crease` degrees are shaded smoothly; with 0
/// every triangle is flat.
///
/// # Errors
/// Returns a message if the profile has fewer than two points, or the same point twice in a row. Also fails for a
/// radius below 0, an inner point on the axis, or a number that is not finite.
pub fn lathe(profile: &[[f64; 2]], n: u32, crease: f64) -> Result<TriMesh, String> {
    let mut points: Vec<DVec2> = profile.iter().map(|&[r, y]| DVec2::new(r, y)).collect();
    if points.len() < 2 {
        return Err(format!("a profile needs at least two points, this one has {}", points.len()));
    }
    if let Some(p) = points.iter().find(|p| !p.is_finite() || p.x < 0.0) {
        return Err(format!("profile point [{}, {}]: numbers must be finite and the radius not below 0", p.x, p.y));
    }
    if let Some(w) = points.windows(2).find(|w| w[0] == w[1]) {
        return Err(format!("profile point [{}, {}] is the same as the one before it", w[1].x, w[1].y));
    }
    if let Some(p) = points[1..points.len() - 1].iter().find(|p| p.x == 0.0) {
        return Err(format!("profile point [0, {}] lies on the axis; only the ends may", p.y));
    }
    let looped = points.len() > 3 && points[0] == points[points.len() - 1];
    if looped {
        points.pop();
    }
    if points.iter().filter(|p| p.x == 0.0).count() == points.len() || (looped && points[0].x == 0.0) {
        return Err(String::from(
            "the profile lies on the axis or returns to a point of it; it sweeps no clean surface",
        ));
    }
    let normals = (crease > 0.0).then(|| piece_normals(&points, looped, crease));
    Ok(revolve(&Profile { points, looped, normals }, n.max(3)))
}

/// Returns the normals at both ends of each piece: its own, or the mean with its neighbour's if they bend little.
fn piece_normals(points: &[DVec2], looped: bool, crease: f64) -> Vec<[DVec2; 2]> {
    let count = points.len();
    let pieces = if looped { count } else { count - 1 };
    let own: Vec<DVec2> = (0..pieces)
        .map(|i| {
            let along = (points[(i + 1) % count] - points[i]).normalize();
            DVec2::new(along.y, -along.x)
        })
        .collect();
    // A small tolerance: a bend of exactly the crease angle counts as smooth.
    let least = (crease + 1e-9).min(180.0).to_radians().cos();
    let joined = |a: DVec2, b: DVec2| {
        let between = a + b;
        // Pieces that run straight back have no normal between them.
        (a.dot(b) >= least && between.length() > 1e-6).then(|| between.normalize())
    };
    (0..pieces)
        .map(|i| {
            let before = if i > 0 { Some(own[i - 1]) } else { looped.then(|| own[pieces - 1]) };
            let after = if i + 1 < pieces { Some(own[i + 1]) } else { looped.then(|| own[0]) };
            let on_axis = |end: DVec2| end.x == 0.0;
            // A nearly flat cap is smooth across the axis, too.
            let pole = |n: DVec2| joined(n, DVec2::new(-n.x, n.y)).unwrap_or(n);
            let start = if on_axis(points[i]) {
                pole(own[i])
            } else {
                before.and_then(|b| joined(b, own[i])).unwrap_or(own[i])
            };
            let end_point = points[(i + 1) % count];
            let end =
                if on_axis(end_point) { pole(own[i]) } else { after.and_then(|a| joined(own[i], a)).unwrap_or(own[i]) };
            [start, end]
        })
        .collect()
}
