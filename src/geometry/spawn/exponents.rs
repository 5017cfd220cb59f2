//! Starts of rays over all exponents of size and place, both signs, any tilt, seen from near and far. Judged in `f64`.

use glam::{DVec3, Vec3};

use super::Spot;
use crate::geometry::plane::Plane;
use crate::geometry::ray::Ray;
use crate::geometry::sphere::Sphere;
use crate::geometry::triangle;
use crate::math::{UNIT_ROUNDOFF, Vector3};

const U: f64 = UNIT_ROUNDOFF as f64;

/// Numbers between -1 and 1.
struct Numbers(u64);

impl Numbers {
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn between(&mut self, lo: i32, hi: i32) -> i32 {
        lo + ((0.5 + 0.5 * self.signed()) * f64::from(hi - lo + 1)) as i32
    }

    /// Of either sign, with an exponent of 2 in the range.
    fn of_exponent(&mut self, lo: i32, hi: i32) -> f64 {
        let sign = self.signed().signum();
        sign * (1.5 + 0.5 * self.signed()) * 2_f64.powi(self.between(lo, hi))
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.signed(), self.signed(), self.signed());
            if (0.01..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }

    /// A coordinate axis of either sign, a direction within roundings of one, or any direction.
    fn normal(&mut self) -> Vec3 {
        let axis = DVec3::AXES[self.between(0, 2) as usize] * self.signed().signum();
        match self.between(0, 3) {
            0 | 1 => axis.as_vec3(),
            2 => (axis + self.direction() * 2_f64.powi(self.between(-40, -5))).normalize().as_vec3(),
            _ => self.direction().as_vec3().normalize(),
        }
    }

    /// A unit direction to the side of `normal`, with a cosine down to 2^-16.
    fn leaving(&mut self, normal: DVec3) -> Vec3 {
        let across = normal.cross(self.direction()).normalize();
        let cos = 2_f64.powi(self.between(-16, 0)) * (0.75 + 0.2 * self.signed());
        (across * (1.0 - cos * cos).sqrt() + normal * cos).normalize().as_vec3()
    }
}

/// Magnitude of a place along a normal: what its roundings are relative to.
fn spread(normal: DVec3, point: DVec3) -> f64 {
    normal.abs().dot(point.abs())
}

/// SI-09: planes at any height above the origin, down to the smallest number. The start is at most 10 roundings of the
/// coordinates across the plane from it, and a squared rounding of the ray's length.
#[test]
fn a_ray_that_leaves_a_plane_of_any_height_and_tilt_does_not_meet_it_again() {
    let mut numbers = Numbers(1);
    let mut left = 0;
    for _ in 0..200_000 {
        let scale = numbers.between(-60, 40);
        let normal = numbers.normal();
        let n = normal.as_dvec3().normalize();
        let height = if numbers.between(0, 9) == 0 { 0.0 } else { numbers.of_exponent(-149, scale + 10) };
        let aside = if numbers.between(0, 2) == 0 { 0.0 } else { 2_f64.powi(scale) };
        let along = n.cross(numbers.direction()).normalize();
        let plane = Plane { point: (n * height + along * aside).as_vec3(), normal };
        let target = plane.point.as_dvec3() + n.cross(numbers.direction()).normalize() * 2_f64.powi(scale);
        let side = numbers.signed().signum();
        let arriving = numbers.leaving(n * side);
        let from = target - arriving.as_dvec3() * 2_f64.powi(scale + numbers.between(-8, 20));
        let ray = Ray::new(from.as_vec3(), arriving);
        let Some(t) = plane.intersect(&ray) else { continue };
        let near = Vector3::from(ray.dir).fma(t, ray.origin.into());
        let spot = Spot::on_plane(plane.point.into(), normal.into(), near);
        let (point, reach) = (Vec3::from(spot.point).as_dvec3(), f64::from(spot.reach));
        let anchor = plane.point.as_dvec3();
        let off = (point - anchor).dot(n).abs();
        assert!(off <= reach, "{off:e} beyond {reach:e}: {plane:?}, {ray:?}");
        let length = f64::from(t) + ray.origin.as_dvec3().length() + anchor.length();
        let enough = 10.0 * U * (spread(n, point) + spread(n, anchor)) + U * U * length;
        assert!(reach <= enough, "{reach:e} is more than {enough:e}: {plane:?}, {ray:?}");
        for side in [normal, -normal] {
            let start = Vec3::from(spot.leave(side.into()));
            for _ in 0..2 {
                let away = Ray::new(start, numbers.leaving(side.as_dvec3().normalize()));
                assert_eq!(plane.intersect(&away), None, "{plane:?}, {ray:?}, {away:?}");
                left += 1;
            }
        }
    }
    assert!(left > 400_000, "{left}");
}

/// SI-09: Spheres from 1e-30 to 1e12, at the origin and away from it, from inside, from near and from a million radii away.
/// The start is at most 15 roundings of the radius and 6 of the coordinates across the surface from it.
#[test]
fn a_ray_that_leaves_a_sphere_of_any_radius_seen_from_anywhere_starts_on_its_side_with_the_right_normal() {
    let mut numbers = Numbers(2);
    let mut left = 0;
    for _ in 0..200_000 {
        let exponent = numbers.between(-100, 40);
        let radius = numbers.of_exponent(exponent, exponent).abs() as f32;
        let r = f64::from(radius);
        let away = if numbers.between(0, 1) == 0 { 0.0 } else { r * 2_f64.powi(numbers.between(-10, 14)) };
        let sphere = Sphere { centre: (numbers.direction() * away).as_vec3(), radius };
        let c = sphere.centre.as_dvec3();
        let inside = numbers.between(0, 3) == 0;
        let far = if inside { 0.9 * r * numbers.signed().abs() } else { r * 2_f64.powi(numbers.between(1, 20)) };
        let back = if numbers.between(0, 2) == 0 { numbers.normal().as_dvec3() } else { numbers.direction() };
        let origin = (c + back * far).as_vec3();
        let aim = c + numbers.direction() * (r * 0.999 * numbers.signed().abs().sqrt());
        let dir = (aim - origin.as_dvec3()).normalize().as_vec3();
        let ray = Ray::new(origin, dir);
        // The line's foot and half chord, of the ray as it is.
        let (f, d) = (origin.as_dvec3() - c, dir.as_dvec3().normalize());
        let foot = f - d * f.dot(d);
        let foot = foot - d * foot.dot(d);
        let below = 1.0 - (foot / r).length_squared();
        // The rounding of `origin - centre` moves the line as a whole.
        let moved = if away == 0.0 { 0.0 } else { 2.0 * U * f.length() / r };
        if below < 1e-4 + 8.0 * moved {
            continue;
        }
        let cos = below.sqrt();
        let t = sphere.intersect(&ray).unwrap_or_else(|| panic!("{sphere:?} is missed by {ray:?}"));
        let (c3, o3, d3) = (sphere.centre.into(), origin.into(), dir.into());
        let spot = Spot::on_sphere(c3, radius, o3, d3, t);
        let (point, outward) = (Vec3::from(spot.point).as_dvec3(), Vec3::from(spot.outward).as_dvec3());
        let reach = f64::from(spot.reach);
        let want = (foot / r + d * if inside { cos } else { -cos }).normalize();
        let bound = (12.0 * U + moved) / cos;
        assert!(
            (outward - want).length() <= bound,
            "{:e} over {bound:e}: {sphere:?}, {ray:?}",
            (outward - want).length()
        );
        let off = ((point - c).length() - r).abs();
        assert!(off <= reach, "{off:e} beyond {reach:e}: {sphere:?}, {ray:?}");
        let enough = U * (15.0 * r + 6.0 * spread(outward, c));
        assert!(reach <= enough, "{reach:e} is more than {enough:e}: {sphere:?}, {ray:?}");
        let (outside, within) = (Vec3::from(spot.leave(spot.outward)), Vec3::from(spot.leave(-spot.outward)));
        for _ in 0..2 {
            let away = Ray::new(outside, numbers.leaving(outward));
            assert_eq!(sphere.intersect(&away), None, "{sphere:?}, {ray:?}, {away:?}");
            let on = Ray::new(within, numbers.leaving(-outward));
            // What goes inside meets the far side, 2 r cos away.
            let half = -on.dir.as_dvec3().dot((within.as_dvec3() - c) / r) * r;
            let met = sphere.intersect(&on).map(f64::from);
            assert!(met.is_some_and(|t| t > half), "{met:?} not beyond {half:e}: {sphere:?}, {ray:?}, {on:?}");
            left += 2;
        }
    }
    assert!(left > 400_000, "{left}");
}

/// Triangles of any size, place and shape up to a thousand times longer than high.
#[test]
fn a_ray_that_leaves_a_triangle_of_any_size_and_place_does_not_meet_it_again() {
    let mut numbers = Numbers(3);
    let mut left = 0;
    for _ in 0..100_000 {
        let exponent = numbers.between(-50, 40);
        let size = 2_f64.powi(exponent);
        let place = numbers.direction()
            * if numbers.between(0, 1) == 0 { 0.0 } else { size * 2_f64.powi(numbers.between(-8, 12)) };
        let (along, aside) = (numbers.direction(), numbers.direction());
        let thin = 2_f64.powi(numbers.between(-10, 0));
        let corners = [DVec3::ZERO, along, along * (0.5 + 0.5 * numbers.signed()) + aside * thin];
        let turn = numbers.between(0, 2) as usize;
        let corners = [0, 1, 2].map(|k| (place + corners[(k + turn) % 3] * size).as_vec3());
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let spanned = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        if spanned.length() < 1e-4 * longest * longest {
            continue;
        }
        let (x, y) = (0.5 + 0.5 * numbers.signed(), 0.5 + 0.5 * numbers.signed());
        let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
        let spot = Spot::on_triangle(corners.map(Vector3::from), x as f32, y as f32);
        let n = spanned.normalize();
        let off = (Vec3::from(spot.point).as_dvec3() - a).dot(n).abs();
        assert!(off <= f64::from(spot.reach), "{off:e} beyond {:e}: {corners:?}", spot.reach);
        for side in [spot.outward, -spot.outward] {
            let start = Vec3::from(spot.leave(side));
            for _ in 0..2 {
                let away = Ray::new(start, numbers.leaving(Vec3::from(side).as_dvec3().normalize()));
                let met = triangle::intersect(&away, corners);
                assert_eq!(met, None, "{corners:?} at {x}, {y}: {away:?}");
                left += 1;
            }
        }
    }
    assert!(left > 200_000, "{left}");
}
