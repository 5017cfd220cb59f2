//! Rays and triangles: seams, slivers, and triangles that other programs were caught with.

use glam::{DVec3, Vec3};
use vitrum::accel::reference::{Reference, Verdict};
use vitrum::geometry::{GeometryMask, Hit, Ray, TriMesh, intersect_triangle};

use crate::support::aim::{at_seams, count, exactly, placed, places, snapped};
use crate::support::kernels::{Held, KERNELS, sound};
use crate::support::{Rng, contract, shapes};

/// Closed meshes about the origin whose middle sees all of them: round, waving, square, and with poles of 32 edges.
fn closed() -> Vec<TriMesh> {
    vec![
        snapped(shapes::closed_sphere(12, 0.0, 1.0, Vec3::ZERO), -8),
        snapped(shapes::closed_sphere(16, 0.2, 1.0, Vec3::ZERO), -8),
        shapes::cuboid(Vec3::splat(-1.0), Vec3::new(1.0, 0.75, 1.5)),
        snapped(shapes::closed_sphere(32, 0.0, 1.0, Vec3::ZERO), -8),
    ]
}

/// RT-01, RT-02, RT-09, Embree #174 and #181: closed meshes at every scale and position, including Embree's far one.
/// They let no ray out that is aimed exactly at a corner or at a point of an edge.
#[test]
fn no_ray_aimed_exactly_at_an_edge_or_a_corner_slips_out() {
    let mut rng = Rng::new(11);
    let (mut aimed, mut wanted, mut configurations) = (0, 0, 0);
    for mesh in closed() {
        for (scale, offset) in places() {
            let Some(mesh) = placed(&mesh, scale, offset) else { continue };
            let n = count(600);
            let rays = at_seams(&mesh, offset.as_vec3(), 0.25 * scale as f32, n, &mut rng);
            (aimed, wanted, configurations) = (aimed + rays.len(), wanted + n, configurations + 1);
            let native = sound(&[shapes::masked(mesh, GeometryMask::OPAQUE)]);
            for kernel in KERNELS {
                let held = Held(native.clone(), kernel);
                let hits = contract::closest(&held, &rays);
                let leak = hits.iter().position(|h| !h.is_hit());
                assert_eq!(leak, None, "{kernel:?} at {offset} x {scale}: {:?}", leak.map(|i| rays[i]));
                assert!(contract::occluded(&held, &rays).iter().all(|b| *b));
            }
        }
    }
    assert!(configurations >= 40 && aimed * 10 > wanted * 8, "{aimed} of {wanted} in {configurations}");
}

/// RT-02: corners of 3 to 64 triangles, flat or crumpled, hit exactly in the middle from both sides.
#[test]
fn a_corner_of_any_number_of_triangles_is_hit() {
    let mut rng = Rng::new(12);
    for valence in 3..=64_u32 {
        for crumple in [0.0, 0.5] {
            let mut positions = vec![Vec3::ZERO];
            positions.extend((0..valence).map(|i| {
                let (s, c) = (std::f32::consts::TAU * i as f32 / valence as f32).sin_cos();
                Vec3::new(c, s, crumple * rng.signed())
            }));
            let triangles = (0..valence).map(|i| [0, 1 + i, 1 + (i + 1) % valence]).collect();
            let native =
                sound(&[shapes::masked(TriMesh { positions, triangles, ..Default::default() }, GeometryMask::OPAQUE)]);
            let rays: Vec<Ray> = (0..64)
                .filter_map(|i| {
                    let up = if i % 2 == 0 { 4.0 } else { -4.0 };
                    exactly(Vec3::new(rng.signed(), rng.signed(), up), Vec3::ZERO)
                })
                .collect();
            for kernel in KERNELS {
                let hits = contract::closest(&Held(native.clone(), kernel), &rays);
                assert!(hits.iter().all(Hit::is_hit), "{valence} triangles, {kernel:?}");
            }
        }
    }
}

/// Counts how often a ray from `origin` crosses the mesh; each hit is the start of the next interval.
fn crossings(held: &Held, ray: &Ray) -> usize {
    let mut ray = *ray;
    for n in 0..20 {
        let hit = contract::closest(held, std::slice::from_ref(&ray))[0];
        if !hit.is_hit() {
            return n;
        }
        ray.t_min = hit.t;
    }
    panic!("{ray:?} never ends");
}

/// RT-03, Embree #188: a ray through a shared edge or corner of a convex mesh crosses it once from inside, and an even
/// number of times from outside. Each next interval begins at the last hit, and both triangles of an edge give the same
/// t.
#[test]
fn an_edge_counts_as_one_crossing() {
    let mut rng = Rng::new(13);
    for mesh in [shapes::cuboid(Vec3::splat(-1.0), Vec3::new(1.0, 0.75, 1.5)), icosahedron()] {
        let rays = at_seams(&mesh, Vec3::ZERO, 0.25, count(1500), &mut rng);
        let held = Held(sound(&[shapes::masked(mesh, GeometryMask::OPAQUE)]), KERNELS[2]);
        for ray in &rays {
            assert_eq!(crossings(&held, ray), 1, "{ray:?}");
            // The same line from outside, the other way.
            let back = Ray::new(ray.origin + ray.dir * 8.0, -ray.dir);
            let n = crossings(&held, &back);
            assert!(n == 2 || n == 0, "{n} for {back:?}");
        }
    }
}

/// Twenty triangles, each in a plane of its own: convex however it is rounded.
fn icosahedron() -> TriMesh {
    snapped(super::self_intersection::icosahedron(), -10)
}

/// RT-04, Embree #387: a triangle with edges of about 11.2, 9.7 and 1.4 that a ray meets at half a degree to its plane,
/// corners less than 600 away, was reported at t = 12291. Triangles and rays of those proportions: what is hit is hit
/// among the corners' own distances, and where the arbiter says so.
#[test]
fn a_thin_triangle_at_half_a_degree_is_hit_at_its_own_distance() {
    let mut rng = Rng::new(14);
    let mut hit = 0;
    for i in 0..count(20_000) {
        let (x, y) = (rng.direction(), rng.direction());
        let normal = x.cross(y).normalize();
        let y = normal.cross(x).normalize();
        let middle = rng.direction() * 550.0 * rng.unit();
        // The law of cosines puts the third corner 0.83 off a base of 11.2.
        let corners = [Vec3::ZERO, x * 11.2, x * 10.06 + y * 0.83].map(|p| middle + p);
        let flat = (x * rng.signed() + y * rng.signed()).normalize();
        let dir = flat + normal * 0.52_f32.to_radians().tan() * if i % 2 == 0 { 1.0 } else { -1.0 };
        let target = corners[0].lerp(corners[1].lerp(corners[2], rng.unit()), rng.unit()) + normal * 0.1 * rng.signed();
        let ray = Ray::new(target - dir * (rng.unit() * 500.0), dir);
        let Some((t, u, v)) = intersect_triangle(&ray, corners) else { continue };
        hit += 1;
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0);
        let ends = corners.map(|p| (p - ray.origin).as_dvec3().dot(dir.as_dvec3()) / dir.as_dvec3().length_squared());
        let (least, most) = (ends[0].min(ends[1]).min(ends[2]), ends[0].max(ends[1]).max(ends[2]));
        assert!((least - 0.01..=most + 0.01).contains(&f64::from(t)), "{t} not in {least}..{most}");
        let mesh = TriMesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Default::default() };
        let arbiter = Reference::build(&[shapes::masked(mesh, GeometryMask::OPAQUE)]);
        let claim = Hit { t, u, v, instance: 0, geometry: 0, primitive: 0 };
        assert!(!matches!(arbiter.judge(&ray, &claim), Verdict::Wrong(_)), "{ray:?} {corners:?}");
    }
    assert!(hit > 500, "{hit}");
}

/// RT-04, Embree #423: an edge of one triangle, as a ray over 0..=1, met another triangle far away from it under SSE and
/// AVX but not with fused products. Edges near the planes of triangles that they end well short of meet nothing.
#[test]
fn the_edge_of_a_far_triangle_meets_nothing() {
    let mut rng = Rng::new(15);
    for i in 0..count(100_000) {
        let (a, size) = (rng.point(), 10_f32.powi(-(i as i32 % 5)));
        let (b, c) = (a + rng.point() * size, a + rng.point() * size);
        // A short edge in, or within an ulp or so of, the plane of the triangle.
        let (u, v) = (rng.signed() * 40.0, rng.signed() * 40.0);
        if u.abs() + v.abs() < 8.0 {
            continue;
        }
        let start = a + (b - a) * u + (c - a) * v;
        let edge = (b - a) * rng.signed() + (c - a) * rng.signed() + rng.point() * 1e-7;
        let ray = Ray { t_max: 1.0, ..Ray::new(start, edge) };
        let apart = (0..3).any(|k| {
            let (lo, hi) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            let (s, e) = (start[k].min(start[k] + edge[k]), start[k].max(start[k] + edge[k]));
            e < lo - 0.01 * size || s > hi + 0.01 * size
        });
        if apart {
            assert_eq!(intersect_triangle(&ray, [a, b, c]), None, "{ray:?} {a} {b} {c}");
        }
    }
}

/// Embree #381: a closed sphere of radius 5 about the origin, looked at from (100, 0, 0), showed its back here and there,
/// mainly where rays met corners.
#[test]
fn the_back_of_a_closed_sphere_is_never_seen() {
    let mesh = snapped(shapes::closed_sphere(24, 0.0, 5.0, Vec3::ZERO), -8);
    let eye = Vec3::new(100.0, 0.0, 0.0);
    let mut rays: Vec<Ray> = mesh.positions.iter().filter_map(|&p| exactly(eye, p)).collect();
    let edges = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    rays.extend(
        edges.filter_map(|(a, b)| exactly(eye, mesh.positions[a as usize].midpoint(mesh.positions[b as usize]))),
    );
    assert!(rays.len() > 3000, "{}", rays.len());
    let native = sound(&[shapes::masked(mesh, GeometryMask::OPAQUE)]);
    for kernel in KERNELS {
        for (ray, hit) in rays.iter().zip(contract::closest(&Held(native.clone(), kernel), &rays)) {
            // The outline may be passed by; what is aimed inside of it may not.
            let aside = (ray.dir.y.hypot(ray.dir.z) / -ray.dir.x * 100.0) / 5.0;
            assert!(hit.is_hit() || aside > 0.97, "{ray:?}");
            let x = eye.x + hit.t * ray.dir.x;
            assert!(!hit.is_hit() || x > -0.1, "{x} for {ray:?}");
        }
    }
}

/// RT-08: triangles with coordinates of 10^-8 to 10^8, each on its own (as pbrt's `Triangle.Reintersect` makes them), and
/// starts of another scale: the arbiter finds no fault.
#[test]
fn triangles_and_starts_of_any_scale_are_met_where_they_are() {
    let mut rng = Rng::new(16);
    let mut any = |spread: f32| rng.signed().signum() * 10_f32.powf(rng.signed() * spread);
    let mut hits = 0;
    for i in 0..count(20_000) {
        let mut point = |spread: f32| Vec3::new(any(spread), any(spread), any(spread));
        let corners = [point(8.0), point(8.0), point(8.0)];
        let origin = point(if i % 2 == 0 { 8.0 } else { 2.0 });
        let target = corners[0] * 0.3 + corners[1] * 0.3 + corners[2] * 0.4;
        let ray = Ray::new(origin, target - origin);
        let mesh = TriMesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Default::default() };
        let claim = intersect_triangle(&ray, corners).map_or(Hit::MISS, |(t, u, v)| Hit {
            t,
            u,
            v,
            instance: 0,
            geometry: 0,
            primitive: 0,
        });
        hits += usize::from(claim.is_hit());
        let verdict = Reference::build(&[shapes::masked(mesh, GeometryMask::OPAQUE)]).judge(&ray, &claim);
        assert!(!matches!(verdict, Verdict::Wrong(_)), "{verdict:?}: {ray:?} {corners:?} {claim:?}");
    }
    assert!(hits > 10_000, "{hits}");
}

/// RT-10: a start on the triangle itself is t = 0, which an interval from 0 excludes and one from below includes, in the
/// native path and for the arbiter. (Along an axis of the triangle's plane t comes out as 0 but for rounding: that is what
/// offsets are for.)
#[test]
fn a_start_on_the_triangle_is_left_out_by_an_interval_from_zero() {
    let mesh = TriMesh {
        positions: vec![Vec3::new(-1.0, -1.0, 2.0), Vec3::new(3.0, -1.0, 2.0), Vec3::new(-1.0, 3.0, 2.0)],
        triangles: vec![[0, 1, 2]],
        ..Default::default()
    };
    let starts = [[0.0, 0.0, 2.0], [-1.0, -1.0, 2.0], [1.0, -1.0, 2.0]].map(Vec3::from);
    let geometry = [shapes::masked(mesh, GeometryMask::OPAQUE)];
    let (native, arbiter) = (sound(&geometry), Reference::build(&geometry));
    for dir in [Vec3::Z, -Vec3::Z, Vec3::new(0.25, 0.5, 1.0), Vec3::new(0.5, 0.25, -0.75)] {
        let from_zero = starts.map(|s| Ray::new(s, dir));
        let from_below = from_zero.map(|r| Ray { t_min: -1e-30, ..r });
        for kernel in KERNELS {
            let held = Held(native.clone(), kernel);
            assert!(contract::closest(&held, &from_zero).iter().all(|h| *h == Hit::MISS), "{dir}");
            assert!(contract::closest(&held, &from_below).iter().all(|h| h.t == 0.0 && h.is_hit()), "{dir}");
        }
        assert!(contract::closest(&arbiter, &from_zero).iter().all(|h| *h == Hit::MISS));
        assert!(contract::closest(&arbiter, &from_below).iter().all(|h| h.t == 0.0));
    }
}

/// RT-14: the products of edges of 1e-20 underflow in `f32`, so that every sign test passes at once. Rays beside such a
/// triangle by a fifth of its size must still miss it, and rays inside must hit.
#[test]
fn a_triangle_too_small_for_products_is_not_hit_beside_it() {
    let mut rng = Rng::new(17);
    for exponent in [-12, -19, -20, -25, -30, -36] {
        let s = 10_f32.powi(exponent);
        let corners = [Vec3::new(0.0, 0.0, s), Vec3::new(s, 0.0, s), Vec3::new(0.0, s, s)];
        for _ in 0..count(2000) {
            let (x, y) = (rng.signed() * 2.0, rng.signed() * 2.0);
            let margin = x.min(y).min(1.0 - x - y);
            if margin.abs() < 0.1 {
                continue;
            }
            let at = Vec3::new(x * s, y * s, 0.0);
            let tilt = Vec3::new(0.1, -0.05, 1.0);
            let ray = Ray::new(at - Vec3::new(0.1, -0.05, 0.0) * s, tilt);
            assert_eq!(intersect_triangle(&ray, corners).is_some(), margin > 0.0, "1e{exponent}: {x} {y}");
        }
    }
}

/// Embree #52 and #230 have their like here: weights put the hit where `t` does, at any place.
/// RT-15: the point that weights give lies on the triangle's plane to the roundings of seven operations, however far the
/// start was.
#[test]
fn weights_put_the_point_on_the_triangle_whatever_the_distance() {
    let mut rng = Rng::new(18);
    let mut worst = 0.0_f64;
    for i in 0..count(50_000) {
        let offset = DVec3::new(1.0, -0.5, 0.25) * [0.0, 1e3, 1e6][i % 3];
        let corner = |rng: &mut Rng| (offset + rng.point().as_dvec3() * 30.0).as_vec3();
        let corners = [corner(&mut rng), corner(&mut rng), corner(&mut rng)];
        let origin = (offset + rng.direction().as_dvec3() * 10_f64.powi(i as i32 % 7)).as_vec3();
        let target = (corners[0] + corners[1] + corners[2]) / 3.0;
        let Some((_, u, v)) = intersect_triangle(&Ray::new(origin, target - origin), corners) else { continue };
        let [a, b, c] = corners;
        let w = 1.0 - u - v;
        let point = a * w + b * u + c * v;
        let bound = a.abs() * w + b.abs() * u + c.abs() * v;
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a);
        if normal.length() < 1.0 {
            continue;
        }
        let normal = normal.normalize();
        let off = (point.as_dvec3() - a).dot(normal).abs();
        worst = worst.max(off / bound.as_dvec3().dot(normal.abs()));
    }
    assert!(worst > 0.0 && worst <= f64::from(vitrum::math::gamma(7)), "{worst:e}");
}
