//! Exact spheres.

use glam::Vec3;
use vitrum::geometry::{Geometry, GeometryMask, Ray, Sphere};

use crate::support::aim::count;
use crate::support::kernels::assert_bits_of_brute_force;
use crate::support::{Rng, shapes};

/// Both parameters in `f64`, for the same numbers.
fn roots(ray: &Ray, s: &Sphere) -> Option<(f64, f64)> {
    let (o, d, c) = (ray.origin.as_dvec3(), ray.dir.as_dvec3(), s.centre.as_dvec3());
    let r = f64::from(s.radius);
    let a = d.length_squared();
    let f = o - c;
    let aside = f - d * (f.dot(d) / a);
    let below = r * r - aside.length_squared();
    (below > 0.05 * r * r).then(|| {
        let (middle, half) = (-f.dot(d) / a, (below / a).sqrt());
        (middle - half, middle + half)
    })
}

/// SP-02: the near root is not the difference of two nearly equal numbers, whether the start is far away, inside, or close
/// to the surface.
#[test]
fn both_roots_are_right_from_far_inside_and_close_by() {
    let mut rng = Rng::new(21);
    let mut tested = 0;
    for i in 0..count(60_000) {
        let s = Sphere { centre: rng.point(), radius: 0.25 + rng.unit() };
        let away = [1e-3, 0.5, 0.999, 1.001, 1.5, 1e2, 1e4][i % 7];
        let origin = s.centre + rng.direction() * (s.radius * away);
        let dir = (s.centre + rng.point() * s.radius * 0.5 - origin) * [0.01, 1.0, 70.0][i % 3];
        let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, dir) };
        let Some((near, far)) = roots(&ray, &s) else { continue };
        tested += 1;
        // Distances to a few ulp of the largest length that takes part.
        let within = 6.0 * f64::from(f32::EPSILON) * f64::from(s.radius).max((origin - s.centre).as_dvec3().length());
        let length = dir.as_dvec3().length();
        let got = f64::from(s.intersect(&ray).expect("well inside the outline"));
        assert!((got - near).abs() * length <= within, "{got} for {near}: {ray:?} {s:?}");
        let then = s.intersect(&Ray { t_min: got as f32, ..ray }).expect("there is a way out");
        assert!((f64::from(then) - far).abs() * length <= within, "{then} for {far}: {ray:?} {s:?}");
    }
    assert!(tested > 20_000, "{tested}");
}

/// SP-03: a sphere of 1e5 for a ground is hit to about 1e-2, the ulp of its radius; a plane would be exact.
#[test]
fn a_huge_sphere_for_a_ground_is_hit_within_two_ulp_of_its_radius() {
    let ground = Sphere { centre: Vec3::new(0.0, -1e5, 0.0), radius: 1e5 };
    let mut rng = Rng::new(22);
    let mut worst = 0.0_f64;
    for _ in 0..count(20_000) {
        let origin = Vec3::new(rng.signed() * 5.0, 1.0 + rng.unit() * 4.0, rng.signed() * 5.0);
        let target = Vec3::new(rng.signed() * 5.0, 0.0, rng.signed() * 5.0);
        let ray = Ray::new(origin, (target - origin).normalize());
        if let (Some((near, _)), Some(got)) = (roots(&ray, &ground), ground.intersect(&ray)) {
            // Height off the ground is what shows.
            worst = worst.max((f64::from(got) - near).abs() * f64::from(ray.dir.y.abs()));
        }
    }
    assert!(worst > 0.0 && worst <= 2.0 * 1e5 * f64::from(f32::EPSILON), "{worst}");
}

/// SP-04: touching rays, starts on the surface and inside, and spheres of next to no radius: whatever is decided, every
/// kernel decides it the same way.
#[test]
fn a_touching_ray_is_decided_the_same_way_by_every_kernel() {
    let mut rng = Rng::new(23);
    let (mut geometry, mut rays): (Vec<Geometry>, Vec<Ray>) = Default::default();
    for i in 0..40 {
        let radius = [1.0, 0.1, 1e-6, 1e-20, 30.0][i % 5];
        geometry.push(shapes::ball(rng.point() * 3.0, radius, GeometryMask::OPAQUE));
    }
    for _ in 0..count(2000) {
        let vitrum::geometry::Shape::Sphere(s) = geometry[rng.below(40)].shape else { unreachable!() };
        let out = rng.direction();
        let along = out.cross(rng.direction()).normalize();
        let touch = s.centre + out * s.radius;
        rays.push(Ray::new(touch - along * rng.unit() * 4.0, along));
        rays.push(Ray::new(touch, along));
        rays.push(Ray::new(touch, -out));
        rays.push(Ray::new(s.centre, along));
    }
    assert!(assert_bits_of_brute_force(&geometry, &rays) > 1000);
    // Exactly touching, in numbers without rounding: the closed ball is met.
    let unit = Sphere { centre: Vec3::ZERO, radius: 1.0 };
    assert_eq!(unit.intersect(&Ray::new(Vec3::new(1.0, -2.0, 0.0), Vec3::Y)), Some(2.0));
    assert_eq!(unit.intersect(&Ray::new(Vec3::new(1.0_f32.next_up(), -2.0, 0.0), Vec3::Y)), None);
}
