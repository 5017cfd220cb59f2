//! Rays and boxes, by the hierarchy that is made of them.

use glam::{DVec3, Vec3};
use vitrum::geometry::{Geometry, GeometryMask, Ray};

use crate::support::aim::count;
use crate::support::kernels::{Held, KERNELS, assert_bits_of_brute_force, sound};
use crate::support::{Rng, contract, shapes};

/// Many small closed boxes, so that nodes and not only leaves are tested.
fn boxes(offset: f32, n: usize, rng: &mut Rng) -> (Vec<Geometry>, Vec<Vec3>) {
    let half = 0.01;
    let centres: Vec<Vec3> = (0..n).map(|_| Vec3::splat(offset) + rng.point() * 8.0).collect();
    let cuboids = centres.iter().map(|&c| shapes::masked(shapes::cuboid(c - half, c + half), GeometryMask::OPAQUE));
    (cuboids.collect(), centres)
}

/// RB-07: `lo * rd - o * rd` with fused products loses everything far from the origin; planes are taken relative to the
/// start first.
#[test]
fn small_boxes_far_from_the_origin_are_met_where_they_are() {
    let mut rng = Rng::new(71);
    for offset in [0.0, 1e3, 1e5] {
        let (geometry, centres) = boxes(offset, 300, &mut rng);
        let native = sound(&geometry);
        let mut rays = Vec::new();
        for i in 0..count(3000) {
            let (centre, from) = (centres[i % centres.len()], Vec3::splat(offset) + rng.point() * 20.0);
            let ray = Ray::new(from, centre - from);
            // Only where the ray as rounded passes well within the box as rounded.
            let mesh = shapes::cuboid(centre - 0.01, centre + 0.01);
            let (lo, hi) = (mesh.bounds().lo.as_dvec3(), mesh.bounds().hi.as_dvec3());
            let at = ray.origin.as_dvec3() + ray.dir.as_dvec3();
            let inset = (hi - lo) * 0.25;
            if (at - lo - inset).cmpge(DVec3::ZERO).all() && (hi - inset - at).cmpge(DVec3::ZERO).all() {
                rays.push(ray);
            }
        }
        assert!(rays.len() > 2000, "{} at {offset}", rays.len());
        for kernel in KERNELS {
            let missed = contract::closest(&Held(native.clone(), kernel), &rays).iter().filter(|h| !h.is_hit()).count();
            assert_eq!(missed, 0, "{kernel:?} at {offset}");
        }
    }
}

/// RB-05: one over a denormal is infinite, and a processor that flushes denormals sees a zero: both give the same hits but
/// for which of two triangles at an edge it is.
#[test]
fn a_denormal_direction_component_counts_as_zero() {
    let mut rng = Rng::new(72);
    let geometry = [
        shapes::masked(shapes::soup(400, 0.4, &mut rng), GeometryMask::OPAQUE),
        shapes::masked(shapes::grid(8), GeometryMask::OPAQUE),
    ];
    let native = sound(&geometry);
    let mut rays = Vec::new();
    for _ in 0..count(2000) {
        let mut ray = Ray::new(rng.point() * 3.0, rng.point());
        let axis = rng.below(3);
        ray.origin[axis] = [ray.origin[axis] * 0.3, 1.0, 2.0][rng.below(3)];
        ray.dir[axis] = [1e-45, -1e-45, 1e-40, -1.1e-38][rng.below(4)];
        rays.push(ray);
    }
    let flushed: Vec<Ray> = rays
        .iter()
        .map(|r| Ray {
            dir: Vec3::from_array(r.dir.to_array().map(|x| if x.is_subnormal() { x * 0.0 } else { x })),
            ..*r
        })
        .collect();
    for kernel in KERNELS {
        let held = Held(native.clone(), kernel);
        let (denormal, zero) = (contract::closest(&held, &rays), contract::closest(&held, &flushed));
        assert!(denormal.iter().filter(|h| h.is_hit()).count() > 100);
        for ((a, b), ray) in denormal.iter().zip(&zero).zip(&rays) {
            // To a few ulp of the lengths that take part.
            let near = a.t == b.t || (a.t - b.t).abs() <= 16.0 * f32::EPSILON * a.t.abs().max(1.0);
            assert!(a.is_hit() == b.is_hit() && near, "{kernel:?} {ray:?}: {a:?} and {b:?}");
        }
    }
    assert_bits_of_brute_force(&geometry, &rays);
}

/// RB-06: from inside a box every face is met; an interval that ends exactly at the face sees it, and one that ends an
/// ulp before does not; a box behind is not seen.
#[test]
fn a_ray_from_inside_a_box_meets_the_face_where_its_interval_ends() {
    let lo = Vec3::new(-1.0, -2.0, 3.0);
    let hi = Vec3::new(2.0, 1.0, 7.0);
    let native = sound(&[shapes::masked(shapes::cuboid(lo, hi), GeometryMask::OPAQUE)]);
    let start = Vec3::new(0.25, -0.5, 4.0);
    for axis in 0..3 {
        for (sign, wall) in [(1.0, hi[axis]), (-1.0, lo[axis])] {
            let t = (wall - start[axis]).abs();
            let straight = Ray::new(start, Vec3::AXES[axis] * sign);
            let outside = Ray::new(start + straight.dir * (t + 1.0), straight.dir);
            let rays = [
                straight,
                Ray { t_max: t, ..straight },
                Ray { t_max: t.next_down(), ..straight },
                Ray { t_min: t.next_down(), ..straight },
                Ray { t_min: t, ..straight },
                outside,
            ];
            for kernel in KERNELS {
                let hits = contract::closest(&Held(native.clone(), kernel), &rays);
                let seen: Vec<bool> = hits.iter().map(|h| h.is_hit()).collect();
                assert_eq!(seen, [true, true, false, true, false, false], "{kernel:?} {straight:?}");
                assert_eq!(hits[0].t, t);
            }
        }
    }
}
