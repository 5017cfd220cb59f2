//! Area lamps as seen from a point: direction, distance and intensity of points on the lamp.

use std::f64::consts::FRAC_PI_4;

use crate::math::{Real, Vector3};

/// Point of a lamp as seen from a shaded point.
#[derive(Clone, Copy, Debug)]
pub struct Seen<R> {
    /// Unit direction to the lamp point. NaN where both points coincide.
    pub dir: Vector3<R>,
    /// Distance to the lamp point.
    pub distance: R,
    /// Share of the lamp's intensity that a facing surface would receive if all lamp points were like this one.
    /// Includes inverse-square falloff where that is physical. Not above 0 where the lamp does not shine.
    pub share: R,
}

/// Lamp with an extent whose points can be sampled.
pub trait Extent<R: Real> {
    /// Returns the lamp point for `at`, in the unit square, as seen from `from`. `PHYSICAL` selects inverse-square
    /// falloff; otherwise the light does not weaken with distance.
    fn point<const PHYSICAL: bool>(&self, from: Vector3<R>, at: [R; 2]) -> Seen<R>;

    /// Returns the edges of a pyramid with apex `from` that encloses the lamp: vectors from `from` to four corners in a
    /// plane across the lamp, in order around it.
    fn corners(&self, from: Vector3<R>) -> [Vector3<R>; 4];
}

/// Signs of the four corners of a square, in order around it.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Spherical lamp. Samples cover the visible cap by equal solid angles, so each has the same weight.
#[derive(Clone, Copy, Debug)]
pub struct Ball<R> {
    /// Centre.
    pub centre: Vector3<R>,
    /// Radius.
    pub radius: R,
}

/// Visible cap of a ball.
struct Cap<R> {
    /// Unit direction to the centre, and two unit vectors across it.
    axes: [Vector3<R>; 3],
    distance: R,
    /// Square of the sine of the cap's half angle, `(radius / distance)^2`.
    sin_squared: R,
    /// 1 minus the cosine of the cap's half angle.
    height: R,
}

impl<R: Real> Ball<R> {
    fn cap(&self, from: Vector3<R>) -> Cap<R> {
        let way = self.centre - from;
        let distance = way.length();
        let along = way * (R::one() / distance);
        // An axis along which no scene is likely to be built. Sample positions turn abruptly where the direction passes
        // through it.
        let splat = |x: f64, y: f64, z: f64| Vector3::new(R::splat(x), R::splat(y), R::splat(z));
        let (askew, other) = (splat(0.231, 0.519, 0.823), splat(1.0, 0.0, 0.0));
        let across = askew.cross(along);
        let across = Vector3::select(across.length_squared().gt(R::splat(1e-4)), across, other.cross(along));
        let across = across.normalized();
        let ratio = self.radius / distance;
        let sin_squared = ratio * ratio;
        let height = sin_squared / (R::one() + (R::one() - sin_squared).safe_sqrt());
        Cap { axes: [along, across, along.cross(across)], distance, sin_squared, height }
    }
}

impl<R: Real> Extent<R> for Ball<R> {
    #[inline(always)]
    fn point<const PHYSICAL: bool>(&self, from: Vector3<R>, at: [R; 2]) -> Seen<R> {
        let Cap { axes: [along, across, up], distance, sin_squared, height } = self.cap(from);
        let one = R::one();
        let [x, y] = disc(at);
        // Equal areas of the disc are equal solid angles: 1 - cos grows as the square of the disc's radius.
        let drop = (x * x + y * y) * height;
        let reach = (height * (one + one - drop)).safe_sqrt();
        let dir = along * (one - drop) + across * (x * reach) + up * (y * reach);
        let behind = (sin_squared - drop * (one + one - drop)).safe_sqrt();
        // Radiance I / (pi radius^2) over solid angle pi (radius / distance)^2 gives I / distance^2, up to the
        // curvature of the cap.
        let cos_rim = one - height;
        let falloff = if PHYSICAL { R::splat(2.0) / (distance * distance * (one + cos_rim)) } else { one };
        let outside = sin_squared.lt(one);
        Seen { dir, distance: distance * (one - drop - behind), share: R::select(outside, falloff, R::zero()) }
    }

    #[inline(always)]
    fn corners(&self, from: Vector3<R>) -> [Vector3<R>; 4] {
        let Cap { axes: [along, across, up], distance, sin_squared, .. } = self.cap(from);
        // Square around the circle in which the tangents from `from` cut the plane of the centre.
        let reach = distance * (sin_squared / (R::one() - sin_squared)).safe_sqrt();
        let (middle, across, up) = (along * distance, across * reach, up * reach);
        CORNERS.map(|[x, y]| middle + across * R::splat(x) + up * R::splat(y))
    }
}

/// Parallelogram lamp. Samples cover it by equal areas.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<R> {
    /// One corner.
    pub corner: Vector3<R>,
    /// Edge vectors from that corner.
    pub edges: [Vector3<R>; 2],
    /// Unit normal of the emitting side. `None` if the lamp shines evenly in all directions.
    pub normal: Option<Vector3<R>>,
}

impl<R: Real> Sheet<R> {
    fn look(&self, from: Vector3<R>, [u, v]: [R; 2]) -> Seen<R> {
        let way = self.edges[1].fma(v, self.edges[0].fma(u, self.corner)) - from;
        let distance = way.length();
        Seen { dir: way * (R::one() / distance), distance, share: R::one() }
    }
}

impl<R: Real> Extent<R> for Sheet<R> {
    #[inline(always)]
    fn point<const PHYSICAL: bool>(&self, from: Vector3<R>, at: [R; 2]) -> Seen<R> {
        let seen = self.look(from, at);
        let cos = self.normal.map_or(R::one(), |normal| -seen.dir.dot(normal));
        let share = if PHYSICAL { cos / (seen.distance * seen.distance) } else { cos };
        Seen { share, ..seen }
    }

    #[inline(always)]
    fn corners(&self, from: Vector3<R>) -> [Vector3<R>; 4] {
        let [u, v] = self.edges;
        [self.corner, self.corner + u, self.corner + u + v, self.corner + v].map(|corner| corner - from)
    }
}

/// Maps the unit square to the unit disc: concentric squares become circles, and areas are preserved (Shirley & Chiu
/// 1997).
#[inline(always)]
pub(super) fn disc<R: Real>([u, v]: [R; 2]) -> [R; 2] {
    let (x, y) = (u + u - R::one(), v + v - R::one());
    let wide = x.abs().gt(y.abs());
    let (radius, other) = (R::select(wide, x, y), R::select(wide, y, x));
    let middle = radius.eq(R::zero());
    let turn = R::select(middle, R::zero(), other / R::select(middle, R::one(), radius));
    let (sin, cos) = (turn * R::splat(FRAC_PI_4)).sin_cos();
    [radius * R::select(wide, cos, sin), radius * R::select(wide, sin, cos)]
}

#[cfg(test)]
mod tests {
    use super::*;

    type V = Vector3<f64>;

    fn squares(n: u32) -> impl Iterator<Item = [f64; 2]> {
        let middle = move |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        (0..n * n).map(move |i| [middle(i % n), middle(i / n)])
    }

    #[test]
    fn the_disc_is_filled_evenly() {
        let n = 256;
        let within = squares(n).map(disc).filter(|[x, y]| x * x + y * y < 0.25).count() as f64;
        assert!((within / f64::from(n * n) - 0.25).abs() < 2e-3);
        let right = squares(n).map(disc).filter(|[x, y]| *x > 0.5 && x * x + y * y <= 1.0).count() as f64;
        // The segment beyond half the radius: (pi / 3 - sqrt(3) / 4) / pi of the disc.
        let segment = 1.0 / 3.0 - 3.0_f64.sqrt() / (4.0 * std::f64::consts::PI);
        assert!((right / f64::from(n * n) - segment).abs() < 2e-3, "{right}");
    }

    #[test]
    fn points_of_a_ball_lie_on_it_and_face_the_place() {
        let ball = Ball { centre: V::new(1.0, 2.0, -3.0), radius: 0.7 };
        for from in [V::new(0.0, 0.0, 0.0), V::new(1.2, 2.0, -2.2), V::new(-40.0, 3.0, 8.0)] {
            for at in squares(16) {
                let seen = ball.point::<true>(from, at);
                assert!((seen.dir.length() - 1.0).abs() < 1e-14);
                let out = seen.dir.fma(seen.distance, from) - ball.centre;
                assert!((out.length() - 0.7).abs() < 1e-12 * 40.0, "{}", out.length());
                assert!(out.dot(seen.dir) <= 1e-9, "the near side");
            }
        }
    }

    /// The irradiance from a uniform ball on a surface facing its centre equals that of a point lamp there.
    #[test]
    fn a_ball_sends_what_a_point_of_its_intensity_would() {
        let ball = Ball { centre: V::new(0.0, 0.0, 0.0), radius: 1.0 };
        for distance in [1.001, 1.5, 3.0, 100.0] {
            let from = V::new(0.0, 0.0, distance);
            let n = 64;
            let sum: f64 = squares(n).map(|at| ball.point::<true>(from, at)).map(|s| s.share * -s.dir.z).sum();
            let mean = sum / f64::from(n * n);
            assert!((mean * distance * distance - 1.0).abs() < 1e-3, "{distance}: {mean}");
        }
        assert_eq!(ball.point::<true>(V::new(0.1, 0.2, 0.3), [0.5; 2]).share, 0.0, "none inside");
    }

    /// The configuration factor of a rectangle to a surface below its corner (Howell, C-10).
    #[test]
    fn a_sheet_sends_what_its_configuration_factor_says() {
        let (a, b, h) = (2.0_f64, 3.0, 1.5);
        let sheet = Sheet {
            corner: V::new(0.0, h, 0.0),
            edges: [V::new(a, 0.0, 0.0), V::new(0.0, 0.0, b)],
            normal: Some(V::new(0.0, -1.0, 0.0)),
        };
        let n = 200;
        let sum: f64 = squares(n).map(|at| sheet.point::<true>(V::all(0.0), at)).map(|s| s.share * s.dir.y).sum();
        let (x, y) = (a / h, b / h);
        let side = |p: f64, q: f64| p / (1.0 + p * p).sqrt() * (q / (1.0 + p * p).sqrt()).atan();
        let factor = (side(x, y) + side(y, x)) / std::f64::consts::TAU;
        // Irradiance is pi L F, L = I / area.
        let want = std::f64::consts::PI * factor / (a * b);
        assert!((sum / f64::from(n * n) - want).abs() < 1e-5 * want, "{sum} {want}");
        let behind = sheet.point::<true>(V::new(0.0, 2.0, 0.0), [0.5; 2]);
        assert!(behind.share < 0.0, "its back is dark");
    }

    #[test]
    fn the_corners_hold_the_lamp_between_them() {
        let ball = Ball { centre: V::new(0.3, 4.0, -1.0), radius: 0.9 };
        let from = V::new(0.1, 0.0, 0.2);
        let corners = ball.corners(from);
        let middle = (ball.centre - from).normalized();
        for k in 0..4 {
            // The plane through the apex and two neighbouring corners touches the ball and has it on its inner side.
            let plane = corners[k].cross(corners[(k + 1) % 4]).normalized();
            let far = plane.dot(ball.centre - from);
            assert!((far.abs() - 0.9).abs() < 1e-12, "{far}");
            assert!(far * plane.dot(middle) > 0.0);
        }
    }
}
