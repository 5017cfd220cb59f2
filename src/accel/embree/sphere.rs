//! Exact spheres as user geometry, by callbacks to the native path's own test.

use std::ffi::c_int;

use glam::Vec3;

use super::options::Mode;
use super::packet;
use super::scene::{UserGeometry, UserRays};
use crate::geometry::slab::SlabRay;
use crate::geometry::{Aabb, COORDINATE_LIMIT, Sphere, sphere};
use crate::simd::{F32x8, Mask8, Vec3x8, set_lanes};

/// Spheres with the same geometry mask, each with its index in the list of geometry.
pub struct SphereGroup {
    spheres: Vec<(Sphere, u32)>,
    mode: Mode,
}

impl SphereGroup {
    /// Creates the group from at least one usable sphere.
    pub fn new(spheres: Vec<(Sphere, u32)>, mode: Mode) -> Self {
        Self { spheres, mode }
    }

    /// Ray parameters of the hits with sphere `i`, and the lanes that hit it, for up to eight lanes from `first` on.
    #[inline(always)]
    fn meet(&self, i: u32, rays: &UserRays, first: usize) -> (F32x8, Mask8) {
        let (Sphere { centre, radius }, _) = self.spheres[i as usize];
        let lanes = (rays.n - first).min(8);
        // Lanes beyond the last get harmless numbers.
        let field = |k: usize, rest: f32| {
            let here = &rays.fields[k * rays.n + first..][..lanes];
            here.try_into().map_or_else(|_| F32x8::from_fn(|i| here.get(i).copied().unwrap_or(rest)), F32x8::new)
        };
        let vector = |k: usize| Vec3x8::new(field(k, 1.0), field(k + 1, 1.0), field(k + 2, 1.0));
        let (origin, dir) = (vector(ORG_X), vector(DIR_X));
        let t_min = packet::before_tnear(field(TNEAR, 1.0), self.mode);
        let slab = SlabRay::new(origin, dir);
        let (t, met) =
            sphere::intersect(&slab, dir, Vec3x8::splat(centre), F32x8::from(radius), t_min, field(TFAR, 0.0));
        let valid =
            rays.valid[first..][..lanes].iter().rev().fold(0, |bits: u8, &v: &c_int| bits << 1 | u8::from(v != 0));
        (t, met & Mask8::from_bits(valid))
    }
}

// Offsets of the fields of `UserRays`, in units of `n` numbers.
const ORG_X: usize = 0;
const TNEAR: usize = 3;
const DIR_X: usize = 4;
const TFAR: usize = 8;
const U: usize = 15;
const V: usize = 16;
const PRIM_ID: usize = 17;
const GEOM_ID: usize = 18;

impl UserGeometry for SphereGroup {
    fn count(&self) -> u32 {
        self.spheres.len() as u32
    }

    fn bounds(&self, i: u32) -> Aabb {
        let (Sphere { centre, radius }, _) = self.spheres[i as usize];
        let (lo, hi) = sphere::grown_bounds::<f32>(centre.into(), radius);
        // The margin may reach beyond what Embree accepts, though the sphere does not.
        let limit = Vec3::splat(COORDINATE_LIMIT);
        Aabb { lo: Vec3::from(lo).max(-limit), hi: Vec3::from(hi).min(limit) }
    }

    fn intersect(&self, i: u32, rays: UserRays) {
        let n = rays.n;
        for first in (0..n).step_by(8) {
            let (t, met) = self.meet(i, &rays, first);
            for lane in set_lanes(met.bits()) {
                let mut set = |field: usize, x: f32| rays.fields[field * n + first + lane] = x;
                set(TFAR, t.lane(lane));
                set(U, 0.0);
                set(V, 0.0);
                set(PRIM_ID, f32::from_bits(0));
                set(GEOM_ID, f32::from_bits(self.spheres[i as usize].1));
            }
        }
    }

    fn occluded(&self, i: u32, rays: UserRays) {
        let n = rays.n;
        for first in (0..n).step_by(8) {
            let (_, met) = self.meet(i, &rays, first);
            for lane in set_lanes(met.bits()) {
                rays.fields[TFAR * n + first + lane] = f32::NEG_INFINITY;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::hierarchy::Embree;
    use super::super::options::{Options, Width};
    use super::super::tests;
    use super::*;
    use crate::accel::{Coherence, Intersector};
    use crate::geometry::{Geometry, GeometryMask, Hit8, Ray, Ray8, Shape};

    #[test]
    fn a_hit_has_the_bits_of_the_native_test_at_every_width() {
        if tests::library("sphere bits").is_none() {
            return;
        }
        let mut state = 3_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let spheres: Vec<Sphere> = (0..50)
            .map(|_| Sphere { centre: Vec3::new(next(), next(), next()) * 4.0 - 2.0, radius: 0.01 + 0.5 * next() })
            .collect();
        // Half of the rays start on a sphere's surface, where the last bits decide the hit.
        let rays: Vec<Ray> = (0..4000)
            .map(|k| {
                let dir = Vec3::new(next(), next(), next()) - 0.5;
                let Sphere { centre, radius } = spheres[k % 50];
                let on = centre + radius * (Vec3::new(next(), next(), next()) - 0.5).normalize();
                let origin = if k % 2 == 0 { on } else { Vec3::new(next(), next(), next()) * 8.0 - 4.0 };
                Ray { t_min: 0.25 * (k % 3) as f32, t_max: 1.0 + 20.0 * next(), ..Ray::new(origin, dir) }
            })
            .collect();
        let alone = |ray: &Ray| {
            let meet = |s: &Sphere| {
                let slab = SlabRay::<f32>::new(ray.origin.into(), ray.dir.into());
                let (centre, dir) = (s.centre.into(), ray.dir.into());
                let (t, met) = sphere::intersect(&slab, dir, centre, s.radius, ray.t_min, ray.t_max);
                met.then_some(t)
            };
            spheres.iter().filter_map(meet).fold(f32::INFINITY, f32::min)
        };
        let want: Vec<f32> = rays.iter().map(alone).collect();
        assert!(want.iter().filter(|t| t.is_finite()).count() > 1000);
        let shapes: Vec<Geometry> =
            spheres.iter().map(|&s| Geometry { shape: Shape::Sphere(s), mask: GeometryMask::ALL }).collect();
        let packets = Ray8::pack(&rays);
        for width in [Width::One, Width::Eight, Width::Sixteen] {
            let accel = Embree::build(&shapes, &Options { width, ..Options::default() }).unwrap();
            let mut hits = vec![Hit8::default(); packets.len()];
            let mut blocked = vec![Mask8::NONE; packets.len()];
            let mut scratch = Default::default();
            accel.closest(&packets, &mut hits, Coherence::Incoherent, &mut scratch);
            accel.occluded(&packets, &mut blocked, Coherence::Incoherent, &mut scratch);
            for (i, want) in want.iter().enumerate() {
                let t = hits[i / 8].t.lane(i % 8);
                assert_eq!(t.to_bits(), want.to_bits(), "{t} for {want} at {:?}, {width:?}", rays[i]);
                assert_eq!(blocked[i / 8].lane(i % 8), want.is_finite());
            }
        }
    }
}
