//! Alhazen's problem: the point of a spherical mirror in which an eye sees another point.
//!
//! The point lies in the plane of the centre, the eye and the other point. Both are at
//! distances `a` and `b` from the centre, in radii, with an angle `phi` between them. The angle `x` of the mirror point from
//! the eye satisfies `a b sin(2 x - phi) = a sin x - b sin(phi - x)`. Seen from outside there is one such point between the two. Seen from
//! inside there are two or four.

use glam::DVec3;

/// Steps of Newton's method, each halving the interval where it would leave it.
const STEPS: usize = 64;

/// A sphere that reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorBall {
    /// Centre, in scene units.
    pub centre: DVec3,
    /// Radius, in scene units, above zero.
    pub radius: f64,
}

/// A point of a mirror that shows something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorPoint {
    /// The point, in scene units.
    pub point: DVec3,
    /// Unit normal, outwards.
    pub normal: DVec3,
    /// True if light that goes by this point meets the mirror from outside. Otherwise the point is the continuation of such
    /// points beyond the horizon of the ball.
    pub seen: bool,
}

impl MirrorPoint {
    /// Returns the mirror image of a place in the plane that touches the mirror here.
    #[must_use]
    pub fn image(&self, other: DVec3) -> DVec3 {
        other - self.normal * (2.0 * self.normal.dot(other - self.point))
    }
}

/// The problem in its plane.
#[derive(Clone, Copy, Debug)]
struct Planar {
    /// Distances of both points from the centre, in radii.
    a: f64,
    b: f64,
    /// Angle between them, in 0..=pi.
    phi: f64,
}

impl Planar {
    /// Difference of the tangential components of the two ways, times their normal ones: 0 at a mirror point.
    fn off(self, x: f64) -> f64 {
        let Self { a, b, phi } = self;
        a * b * (2.0 * x - phi).sin() - a * x.sin() + b * (phi - x).sin()
    }

    fn slope(self, x: f64) -> f64 {
        let Self { a, b, phi } = self;
        2.0 * a * b * (2.0 * x - phi).cos() - a * x.cos() - b * (phi - x).cos()
    }

    /// The root in an interval at whose ends the sign changes, by Newton's method.
    fn root(self, mut lo: f64, mut hi: f64, start: f64) -> f64 {
        let rising = self.off(hi) >= self.off(lo);
        let mut x = start.clamp(lo, hi);
        for _ in 0..STEPS {
            let off = self.off(x);
            if off == 0.0 {
                break;
            }
            if (off < 0.0) == rising {
                lo = x;
            } else {
                hi = x;
            }
            let newton = x - off / self.slope(x);
            let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
            if (next - x).abs() <= f64::EPSILON * x.abs() {
                break;
            }
            x = next;
        }
        x
    }
}

impl MirrorBall {
    /// The problem for two points in its plane: the angles, and the unit vectors towards the eye and across it.
    fn planar(&self, eye: DVec3, other: DVec3) -> (Planar, DVec3, DVec3) {
        let (e, v) = ((eye - self.centre) / self.radius, (other - self.centre) / self.radius);
        let (a, b) = (e.length(), v.length());
        let along = e / a;
        let across = v - along * along.dot(v);
        let phi = across.length().atan2(along.dot(v));
        // In line with the eye, but for rounding, any plane will do.
        let in_line = across.length() <= 1e-13 * b;
        let across = if in_line { along.any_orthonormal_vector() } else { across.normalize() };
        (Planar { a, b, phi }, along, across)
    }

    /// The point in which an eye outside the ball sees another point outside it. None where either is inside.
    #[must_use]
    pub fn mirror_point(&self, eye: DVec3, other: DVec3) -> Option<MirrorPoint> {
        let (problem, along, across) = self.planar(eye, other);
        let Planar { a, b, phi } = problem;
        if !(a > 1.0 && b > 1.0) {
            return None;
        }
        // Next to the nearer of the two; in the middle where both are far.
        let x = problem.root(0.0, phi, phi * (a - 1.0) / ((a - 1.0) + (b - 1.0)));
        let normal = along * x.cos() + across * x.sin();
        Some(MirrorPoint { point: self.centre + normal * self.radius, normal, seen: a * x.cos() > 1.0 })
    }

    /// Returns the number of points on the inside of the ball that show an eye inside it another point inside it.
    #[must_use]
    pub fn mirror_points_inside(&self, eye: DVec3, other: DVec3) -> usize {
        let (problem, ..) = self.planar(eye, other);
        let at = |i: usize| problem.off(std::f64::consts::TAU * (i as f64 + 0.5) / 1024.0);
        (0..1024).filter(|&i| (at(i) < 0.0) != (at(i + 1) < 0.0)).count()
    }

    /// Returns the place at which an eye outside the ball sees the reflection of a point: the mirror image in the plane that
    /// touches the ball in the mirror point (Ofek & Rappoport 1998). It lies on the line of view, as far behind the mirror as the point is before it.
    #[must_use]
    pub fn virtual_point(&self, eye: DVec3, other: DVec3) -> Option<(DVec3, MirrorPoint)> {
        let mirror = self.mirror_point(eye, other)?;
        Some((mirror.image(other), mirror))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BALL: MirrorBall = MirrorBall { centre: DVec3::new(1.0, -2.0, 0.5), radius: 0.75 };

    /// Points around the ball, from just off it to far away.
    fn around() -> Vec<DVec3> {
        let at = |i: i32| {
            let y = 1.0 - (f64::from(i) + 0.5) / 20.0;
            let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
            let level = (1.0 - y * y).sqrt();
            let far = 0.75 + 1e-3 * 10.0_f64.powi(i % 7);
            BALL.centre + DVec3::new(cos * level, y, sin * level) * far
        };
        (0..40).map(at).collect()
    }

    #[test]
    fn light_that_goes_by_the_mirror_point_obeys_the_law_of_reflection() {
        let mut seen = 0;
        for eye in around() {
            for other in around() {
                let Some(MirrorPoint { point, normal, seen: is_seen }) = BALL.mirror_point(eye, other) else {
                    panic!("both points are outside")
                };
                assert!(((point - BALL.centre).length() - 0.75).abs() < 1e-12);
                let [to_eye, to_other] = [eye, other].map(|p| (p - point).normalize());
                if is_seen {
                    seen += 1;
                    let mirrored = normal * (2.0 * normal.dot(to_eye)) - to_eye;
                    let scale = 1e-9 / (eye - point).length().min((other - point).length()).min(1.0);
                    assert!((mirrored - to_other).length() < scale, "{eye} {other}: {mirrored} {to_other}");
                    assert!(normal.dot(to_eye) > 0.0 && normal.dot(to_other) > -1e-9);
                }
            }
        }
        assert!(seen > 300, "{seen}");
    }

    #[test]
    fn the_way_by_the_mirror_point_is_the_shortest_over_the_ball() {
        // Heron's and Fermat's principle: no point of a ring around it, or of the whole ball that both see, is on a shorter way.
        let (eye, other) = (BALL.centre + DVec3::new(0.0, 0.4, 3.0), BALL.centre + DVec3::new(2.0, 1.0, 0.3));
        let MirrorPoint { point, seen, .. } = BALL.mirror_point(eye, other).unwrap();
        assert!(seen);
        let way = |p: DVec3| (p - eye).length() + (p - other).length();
        for away in around() {
            let p = BALL.centre + (away - BALL.centre).normalize() * 0.75;
            let visible = [eye, other].iter().all(|q| (p - BALL.centre).dot(*q - p) > 0.0);
            assert!(!visible || way(p) >= way(point) - 1e-12);
        }
    }

    #[test]
    fn the_virtual_point_is_on_the_line_of_view_as_far_behind_as_the_point_is_before() {
        for eye in around() {
            for other in around() {
                let (image, mirror) = BALL.virtual_point(eye, other).unwrap();
                let (way, behind) = ((mirror.point - eye).normalize(), image - mirror.point);
                let far = (other - mirror.point).length();
                assert!((behind.length() - far).abs() < 1e-9 * far.max(1.0));
                if mirror.seen {
                    let scale = 1e-9 * far / (eye - mirror.point).length().min(far).min(1.0);
                    assert!((behind - way * far).length() < scale.max(1e-9), "{eye} {other}");
                }
            }
        }
    }

    #[test]
    fn a_ball_as_large_as_a_plane_mirrors_as_one() {
        let huge = MirrorBall { centre: DVec3::new(0.0, -1e6, 0.0), radius: 1e6 };
        let (image, _) = huge.virtual_point(DVec3::new(0.3, 2.0, 1.0), DVec3::new(-1.0, 0.7, 0.2)).unwrap();
        assert!((image - DVec3::new(-1.0, -0.7, 0.2)).length() < 1e-5, "{image}");
    }

    #[test]
    fn inside_a_ball_there_are_two_points_or_four() {
        let unit = MirrorBall { centre: DVec3::ZERO, radius: 1.0 };
        // On one radius: the ends of the diameter through both. As far out on two radii at right angles: two points on the
        // line between them, by symmetry, and two beside it. As far from the middle on one diameter: its ends, and those of
        // the diameter across it.
        assert_eq!(unit.mirror_points_inside(DVec3::X * 0.2, DVec3::X * 0.3), 2);
        assert_eq!(unit.mirror_points_inside(DVec3::X * 0.2, DVec3::X * -0.2), 4);
        assert_eq!(unit.mirror_points_inside(DVec3::X * 0.9, DVec3::new(0.0, 0.9, 0.0)), 4);
        assert!(unit.mirror_point(DVec3::X * 0.2, DVec3::Y * 2.0).is_none(), "the eye is inside");
    }
}
