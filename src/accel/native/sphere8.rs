//! Leaves of exact spheres.

use super::bvh8::Planes;
use super::leaf::{Best8, Leaf, Met, Tags, Towards};
use super::one::One;
use super::rays::Eight;
use crate::geometry::sphere::{grown_bounds, intersect};
use crate::geometry::{Sphere, slab::SlabRay};
use crate::math::LaneMask;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Up to eight spheres in structure-of-arrays; empty slots hold NaN, which nothing meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Sphere8 {
    pub centre: Vec3x8,
    pub radius: F32x8,
    tags: Tags,
}

/// Eight rays against one sphere: `t`, and the lanes that meet it within their intervals.
#[inline(always)]
pub(crate) fn intersect_eight(
    slab: &SlabRay<F32x8>,
    dir: Vec3x8,
    sphere: &Sphere,
    t_min: F32x8,
    t_max: F32x8,
) -> (F32x8, Mask8) {
    intersect(slab, dir, Vec3x8::splat(sphere.centre), F32x8::from(sphere.radius), t_min, t_max)
}

impl Sphere8 {
    /// From at most eight spheres: shape, geometry, mask.
    pub fn new(spheres: &[(Sphere, u32, u8)]) -> Self {
        let nan = F32x8::from(f32::NAN);
        let (mut centre, mut radius) = (Vec3x8::new(nan, nan, nan), nan);
        for (i, (sphere, ..)) in spheres.iter().enumerate() {
            centre.set_lane(i, sphere.centre);
            radius.set_lane(i, sphere.radius);
        }
        Self { centre, radius, tags: Tags::new(spheres.iter().map(|&(_, geometry, mask)| (geometry, 0, mask))) }
    }

    /// Every bit of it.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let lanes = [self.centre.x, self.centre.y, self.centre.z, self.radius];
        lanes.into_iter().flat_map(F32x8::to_array).map(f32::to_bits).chain(self.tags.words())
    }

    /// The sphere in slot `i`.
    pub fn sphere(&self, i: usize) -> Sphere {
        Sphere { centre: self.centre.lane(i), radius: self.radius.lane(i) }
    }
}

impl Leaf for Sphere8 {
    #[inline(always)]
    fn meet_one(&self, ray: &One, t_max: f32) -> Option<Met> {
        let (t, met) = intersect(&ray.slab(), ray.dir(), self.centre, self.radius, ray.t_min(), F32x8::from(t_max));
        let lanes = met & Mask8::from_bits(self.tags.admitted(ray.admits()));
        lanes.any().then_some(Met { lanes, t, u: F32x8::ZERO, v: F32x8::ZERO })
    }

    #[inline(always)]
    fn tags(&self) -> &Tags {
        &self.tags
    }

    #[inline(always)]
    fn boxes(&self) -> Planes {
        let (lo, hi) = grown_bounds(self.centre, self.radius);
        [[lo.x, hi.x], [lo.y, hi.y], [lo.z, hi.z]]
    }

    #[inline(always)]
    fn closest_eight(&self, rays: &Eight, to: &Towards, slots: u8, best: &mut Best8) {
        let mut slots = self.tags.admitted(rays.way.admits) & slots;
        while slots != 0 {
            let i = slots.trailing_zeros() as usize & 7;
            slots &= slots - 1;
            let (t, met) = intersect_eight(&rays.way.slab, rays.way.dir, &self.sphere(i), rays.way.t_min, best.t);
            let met = met & Mask8::from_bits(to.lanes);
            best.take(met, t, F32x8::ZERO, F32x8::ZERO, self.tags.geometry[i], self.tags.primitive[i]);
        }
    }

    #[inline(always)]
    fn occluded_eight(&self, rays: &Eight, to: &Towards, slots: u8, t_max: F32x8) -> u8 {
        let mut slots = self.tags.admitted(rays.way.admits) & slots;
        let mut blocked = 0;
        while slots != 0 {
            let i = slots.trailing_zeros() as usize & 7;
            slots &= slots - 1;
            let (_, met) = intersect_eight(&rays.way.slab, rays.way.dir, &self.sphere(i), rays.way.t_min, t_max);
            blocked |= met.bits() & to.lanes;
            if blocked == to.lanes {
                break;
            }
        }
        blocked
    }

    fn cover(&self) -> f32 {
        (0..self.tags.count()).map(|i| 2.0 * std::f32::consts::PI * self.radius.lane(i).powi(2)).sum()
    }

    fn ids(&self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.tags.count()).map(|i| (self.tags.geometry[i], self.tags.primitive[i]))
    }
}
