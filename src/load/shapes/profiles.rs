//! Profiles of round bodies about y, to be turned by [`super::lathe`]: points of radius and height, from the bottom.

/// Returns the profile of a cylinder around the origin, closed at both ends.
#[must_use]
pub fn cylinder(radius: f64, height: f64) -> Vec<[f64; 2]> {
    let half = height * 0.5;
    vec![[0.0, -half], [radius, -half], [radius, half], [0.0, half]]
}

/// Returns the profile of a cone around the origin, with its base below and its tip above.
#[must_use]
pub fn cone(radius: f64, height: f64) -> Vec<[f64; 2]> {
    let half = height * 0.5;
    vec![[0.0, -half], [radius, -half], [0.0, half]]
}

/// Returns the profile of a cylinder around the origin with half balls on both ends; `height` is that of the cylinder
/// alone. `n` is the number of steps around it; a half ball has a quarter as many, and at least two.
#[must_use]
pub fn capsule(radius: f64, height: f64, n: u32) -> Vec<[f64; 2]> {
    let half = height * 0.5;
    let steps = (n / 4).max(2);
    let at = |i: u32| {
        let angle = f64::from(i) / f64::from(steps) * std::f64::consts::FRAC_PI_2;
        [radius * angle.sin(), radius * angle.cos()]
    };
    let inner = (1..=steps).map(at);
    let below = inner.clone().map(|[r, y]| [r, -half - y]);
    let above = inner.rev().map(|[r, y]| [r, half + y]);
    let ends = [[0.0, -half - radius], [0.0, half + radius]];
    std::iter::once(ends[0]).chain(below).chain(above).chain([ends[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::super::lathe;
    use super::*;

    /// Six times the volume, by the divergence theorem.
    fn volume(profile: &[[f64; 2]], n: u32) -> f64 {
        let mesh = lathe(profile, n, 50.0).unwrap();
        let part = |i: usize| {
            let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        (0..mesh.triangles.len()).map(part).sum()
    }

    #[test]
    fn bodies_have_the_volumes_of_the_textbook_and_face_outwards() {
        use std::f64::consts::PI;
        let near = |profile: &[[f64; 2]], want: f64| {
            let got = volume(profile, 256);
            assert!((got / want - 1.0).abs() < 2e-3, "{got} {want}");
        };
        near(&cylinder(0.5, 3.0), PI * 0.25 * 3.0);
        near(&cone(0.5, 3.0), PI * 0.25);
        near(&capsule(0.5, 3.0, 256), PI * 0.25 * 3.0 + PI / 6.0);
    }
}
