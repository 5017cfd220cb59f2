//! Origins of rays that leave a surface: the point on the shape, its outward normal, and a bound on the rounding errors of
//! the point and of the intersection test. There is no global epsilon; each hit has its own bound.

use super::hit::Hit;
use super::ray::Ray;
use super::shape::Shape;
use super::sphere;
use crate::math::{LaneMask, Real, Vector3, gamma};

/// Upper bound of the difference between 1 and the squared length of a plane's normal ([`super::Plane::is_usable`]).
const LACK: f64 = 1.0 / 512.0;

/// A point on a surface, with the offset that keeps a new ray from hitting the surface again.
#[derive(Clone, Copy, Debug)]
pub struct Spot<R> {
    /// The point, on the surface to within `reach`, in scene units.
    pub point: Vector3<R>,
    /// Unit geometric normal, outward.
    pub outward: Vector3<R>,
    /// Offset along the normal, on either side, from which a new ray cannot hit the surface it leaves; in scene units. A
    /// surface at a few times this distance is still hit.
    pub reach: R,
}

impl<R: Real> Spot<R> {
    /// The point on the triangle `[a, b, c]` with barycentric weights `u` of `b` and `v` of `c`.
    ///
    /// `reach` covers two errors. Rounding moves the point off the plane: seven operations (pbrt section 6.8.4), and two for
    /// the offset itself. Rounding in the intersection test moves the triangle: four units of its longest edge, times the
    /// ratio of longest edge to height, because the weights of the test are quotients by the area.
    ///
    /// A triangle with three corners in line can be hit, since rounding gives it a width. It has no side: `outward` is then
    /// any direction perpendicular to the line.
    #[inline(always)]
    #[must_use]
    pub fn on_triangle([a, b, c]: [Vector3<R>; 3], u: R, v: R) -> Self {
        let w = R::one() - u - v;
        let point = c.fma(v, b.fma(u, a * w));
        let magnitude = c.abs().fma(v, b.abs().fma(u, a.abs() * w));
        let (e1, e2) = (b - a, c - a);
        let size = e1.abs().max_component().max(e2.abs().max_component());
        // Scaled to size 1, so that the product of tiny edges does not underflow.
        let scale = R::one() / size;
        let spanned = (e1 * scale).cross(e2 * scale);
        let (spanned, thickness) = across_where_flat(e1 * scale, spanned, spanned.length());
        let outward = spanned * (R::one() / thickness);
        let reach = outward.abs().dot(magnitude) * units(9) + size * units(4) / thickness;
        Self { point, outward, reach }
    }

    /// The point where a ray of unit direction hits a sphere at parameter `t`: centre plus radius times unit normal.
    ///
    /// The bound is in unit roundoffs `u`, with normal `n`, centre `c` and radius `r`. Errors of the point:
    /// - The length of the normal has 4.5 roundings, which times `r` is a distance from the surface.
    /// - The sum with `c`, and the offset origin itself, have one rounding of `|n| |c| + r` each: `6.5 r + 2 |n| |c|` so far.
    /// - These roundings also move the origin sideways, by up to `2 |n_i| r` or `2 |c_i|` along each axis. This is a
    ///   second-order distance from the surface of at most another `2 |n| |c|`.
    ///
    /// Errors of the next intersection test:
    /// - The origin relative to the centre has a rounding of `1 r`.
    /// - The sign of the smaller root is that of a difference of squares, with 4 roundings of `r^2` and thus `2 r`.
    /// - The discriminant has 12 roundings of `r^2`, and must not be negative for a ray that goes inside: `6 r`.
    ///
    /// Only the larger of the last two counts. The sum is `13.5 r + 4 |n| |c|`, and a little for products of roundings.
    #[inline(always)]
    #[must_use]
    pub fn on_sphere(centre: Vector3<R>, radius: R, origin: Vector3<R>, dir: Vector3<R>, t: R) -> Self {
        let outward = sphere::normal(origin, dir, centre, radius, t);
        let point = outward.fma(radius, centre);
        Self { point, outward, reach: Self::off_sphere(outward, centre, radius) }
    }

    /// [`Spot::reach`] of a point on a sphere with the unit normal `outward`, as [`Spot::on_sphere`] derives it.
    #[inline(always)]
    #[must_use]
    pub fn off_sphere(outward: Vector3<R>, centre: Vector3<R>, radius: R) -> R {
        outward.abs().dot(centre.abs()) * units(5) + radius * units(14)
    }

    /// The point where a ray hits the plane through `anchor`: `near`, projected onto the plane along the unit normal `axis`.
    ///
    /// It is projected twice. The first projection leaves roundings of the distance from `near`, which is independent of the
    /// distance between plane and origin. The bound is in unit roundoffs, with `h` the distance of the second projection, and
    /// `n`, `p` and `a` normal, point and anchor:
    /// - Rounding of `p - a` and of its products with `n`: 2 of `|n| |p - a|`.
    /// - The sum of two of the products is as large as the third, so at most half of all: 1/2.
    /// - The same again in the intersection test of the new ray.
    /// - Rounding of the point and of the offset origin: 2 of `|n| |p|`. This makes 7 of `|n| (|p| + |a|)` in all.
    /// - The remaining error of `h`: 5 roundings, and up to a 1000th because the squared length of `n` is not exactly 1.
    #[inline(always)]
    #[must_use]
    pub fn on_plane(anchor: Vector3<R>, axis: Vector3<R>, near: Vector3<R>) -> Self {
        let height = |p: Vector3<R>| (p - anchor).dot(axis);
        let once = axis.fma(-height(near), near);
        let left = height(once);
        let point = axis.fma(-left, once);
        let spread = axis.abs().dot(point.abs() + anchor.abs());
        let reach = left.abs().fma(R::splat(LACK), spread * units(9));
        Self { point, outward: axis, reach }
    }

    /// Origin of a ray that leaves on the side to which `towards`, a unit normal of the surface, points.
    #[inline(always)]
    #[must_use]
    pub fn leave(&self, towards: Vector3<R>) -> Vector3<R> {
        towards.fma(self.reach, self.point)
    }
}

impl Spot<f32> {
    /// The point on `shape` at `hit` of `ray`, whose direction is of unit length.
    #[must_use]
    pub fn at(shape: &Shape, ray: &Ray, hit: &Hit) -> Self {
        let (origin, dir) = (Vector3::from(ray.origin), Vector3::from(ray.dir));
        match shape {
            Shape::Mesh(mesh) => {
                Self::on_triangle(mesh.corners(hit.primitive as usize).map(Vector3::from), hit.u, hit.v)
            }
            Shape::Sphere(s) => Self::on_sphere(s.centre.into(), s.radius, origin, dir, hit.t),
            Shape::Plane(p) => Self::on_plane(p.point.into(), p.normal.into(), dir.fma(hit.t, origin)),
        }
    }
}

/// Returns the normal of a triangle and its length. If the length is zero, returns a unit vector perpendicular to the first
/// edge, and 1.
#[inline(always)]
fn across_where_flat<R: Real>(edge: Vector3<R>, normal: Vector3<R>, length: R) -> (Vector3<R>, R) {
    let (zero, one) = (R::zero(), R::one());
    let sound = length.gt(zero);
    if sound.all() {
        return (normal, length);
    }
    let steep = edge.x.abs().gt(edge.z.abs());
    let across = Vector3::new(
        R::select(steep, -edge.y, zero),
        R::select(steep, edge.x, -edge.z),
        R::select(steep, zero, edge.y),
    );
    (Vector3::select(sound, normal, across.normalized()), R::select(sound, length, one))
}

/// [`gamma`] in the number type `R`.
#[inline(always)]
fn units<R: Real>(n: u32) -> R {
    R::splat(f64::from(gamma(n)))
}

#[cfg(test)]
mod exponents;

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::geometry::triangle;

    /// RT-15, RT-16, SI-04: coordinates up to 1e6, and triangles up to a thousand times longer than high. The point lies on
    /// the triangle's plane well within `reach`. The normal is as exact as the rounding of the corners allows.
    #[test]
    fn points_and_normals_of_triangles_are_within_their_bounds() {
        let mut state = 77_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 23) - 1.0
        };
        let u = f64::from(crate::math::UNIT_ROUNDOFF);
        for i in 0..40_000_i32 {
            let place = DVec3::new(random(), random(), random()) * [0.0, 1.0, 1e3, 1e6][i as usize % 4];
            let size = [1.0, 30.0, 1e3][i as usize / 4 % 3] * if i % 4 == 3 { 30.0 } else { 1.0 };
            let (along, aside) = (DVec3::new(random(), random(), random()), DVec3::new(random(), random(), random()));
            let thin = [1.0, 0.1, 1e-3][i as usize / 12 % 3];
            // The corner from which the edges are taken is any of the three.
            let offsets = [DVec3::ZERO, along, along * random().abs() + aside * thin];
            let turn = i as usize % 3;
            let corners = [0, 1, 2].map(|k| (place + offsets[(k + turn) % 3] * size).as_vec3());
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            let spanned = (b - a).cross(c - a);
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            let height = spanned.length() / longest;
            if height < 1e-4 * longest {
                continue;
            }
            let (x, y) = (random().abs(), random().abs());
            let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
            let at = Spot::on_triangle(corners.map(Vector3::from), x as f32, y as f32);
            let (point, outward) = (Vec3::from(at.point).as_dvec3(), Vec3::from(at.outward).as_dvec3());
            let (normal, reach) = (spanned.normalize(), f64::from(at.reach));
            let off = (point - a).dot(normal).abs();
            assert!(off <= reach, "{off:e} beyond {reach:e}: {corners:?}");
            let angle = outward.cross(normal).length().atan2(outward.dot(normal));
            assert!(angle <= 8.0 * u * longest / height, "{angle:e} off, {longest} by {height}: {corners:?}");
        }
    }

    /// Corners in line: rays aimed at the line do meet it here and there, and what starts there is a number.
    #[test]
    fn a_triangle_without_area_can_be_hit_and_has_a_normal_across_its_line() {
        let mut seed = 0x51_7cc1_b727_220a_u64;
        let mut unit = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        let mut hits = 0;
        for _ in 0..20_000 {
            // Multiples of 2^-8 and twice their differences: exactly in line.
            let mut point = || Vec3::new(unit(), unit(), unit());
            let (a, d) = ((point() * 256.0).round() / 256.0, (point() * 256.0).round() / 256.0);
            if d == Vec3::ZERO {
                continue;
            }
            let corners = [a, a + d, a + d * 2.0];
            let (origin, along) = (point() * 4.0, point().x.abs());
            let ray = Ray::new(origin, (corners[0].lerp(corners[2], along) - origin).normalize());
            let Some((_, u, v)) = triangle::intersect(&ray, corners) else { continue };
            hits += 1;
            let spot = Spot::on_triangle(corners.map(Vector3::<f32>::from), u, v);
            let outward = Vec3::from(spot.outward);
            assert!((outward.length() - 1.0).abs() < 1e-6 && outward.dot(d.normalize()).abs() < 1e-6, "{outward}");
            assert!(spot.reach > 0.0 && spot.reach < 1e-4, "{}", spot.reach);
        }
        assert!(hits > 100, "{hits} of 20,000 met the line");
    }
}
