//! Leaves of exact spheres.

use super::super::ray::lane_ray::LaneRay;
use super::super::ray::packet8::LeafPacket8;
use super::closest_hit::{ClosestHit8, LeafHits};
use super::leaf::{Leaf, LeafQuery};
use super::tags::Tags;
use crate::geometry::sphere::{grown_bounds, intersect};
use crate::geometry::{Aabb8, Sphere};
use crate::math::LaneMask;
use crate::simd::{F32x8, Mask8, Vec3x8, set_lanes};

/// Up to eight spheres in structure-of-arrays. Empty slots hold NaN, which no ray hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Sphere8 {
    /// Centres.
    pub centre: Vec3x8,
    /// Radii.
    pub radius: F32x8,
    tags: Tags,
}

impl Sphere8 {
    /// A leaf of at most eight spheres, given as shape, geometry id and mask.
    pub fn new(spheres: &[(Sphere, u32, u8)]) -> Self {
        let nan = F32x8::from(f32::NAN);
        let (mut centre, mut radius) = (Vec3x8::new(nan, nan, nan), nan);
        for (i, (sphere, ..)) in spheres.iter().enumerate() {
            centre.set_lane(i, sphere.centre);
            radius.set_lane(i, sphere.radius);
        }
        Self { centre, radius, tags: Tags::new(spheres.iter().map(|&(_, geometry, mask)| (geometry, 0, mask))) }
    }

    /// All bits of the leaf.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let lanes = [self.centre.x, self.centre.y, self.centre.z, self.radius];
        lanes.into_iter().flat_map(F32x8::to_array).map(f32::to_bits).chain(self.tags.words())
    }

    /// The sphere in slot `i`.
    pub fn sphere(&self, i: usize) -> Sphere {
        Sphere { centre: self.centre.lane(i), radius: self.radius.lane(i) }
    }

    /// Tests eight rays against the sphere in slot `i`. Returns the lanes of `lanes` that hit it, and `t`.
    #[inline(always)]
    fn intersect_packet(&self, i: usize, rays: &LeafPacket8, lanes: u8, t_max: F32x8) -> LeafHits {
        let Sphere { centre, radius } = self.sphere(i);
        let rays = &rays.packet;
        let (t, hit) = intersect(&rays.slab, rays.dir, Vec3x8::splat(centre), F32x8::from(radius), rays.t_min, t_max);
        LeafHits { lanes: hit & Mask8::from_bits(lanes), t, u: F32x8::ZERO, v: F32x8::ZERO }
    }
}

impl Leaf for Sphere8 {
    #[inline(always)]
    fn intersect_ray(&self, ray: &LaneRay, t_max: f32) -> Option<LeafHits> {
        let (t, hit) = intersect(&ray.slab(), ray.dir(), self.centre, self.radius, ray.t_min(), F32x8::from(t_max));
        let lanes = hit & Mask8::from_bits(self.tags.admitted(ray.admits()));
        lanes.any().then_some(LeafHits { lanes, t, u: F32x8::ZERO, v: F32x8::ZERO })
    }

    #[inline(always)]
    fn tags(&self) -> &Tags {
        &self.tags
    }

    #[inline(always)]
    fn boxes(&self) -> Aabb8 {
        let (lo, hi) = grown_bounds(self.centre, self.radius);
        Aabb8::new(lo, hi)
    }

    #[inline(always)]
    fn closest_packet(&self, rays: &LeafPacket8, query: &LeafQuery, slots: u8, closest: &mut ClosestHit8) {
        for i in set_lanes(self.tags.admitted(rays.packet.admits) & slots) {
            let hits = self.intersect_packet(i, rays, query.lanes, closest.t);
            closest.update(&hits, (self.tags.geometry[i], self.tags.primitive[i]));
        }
    }

    #[inline(always)]
    fn occluded_packet(&self, rays: &LeafPacket8, query: &LeafQuery, slots: u8, t_max: F32x8) -> u8 {
        let mut blocked = 0;
        for i in set_lanes(self.tags.admitted(rays.packet.admits) & slots) {
            blocked |= self.intersect_packet(i, rays, query.lanes, t_max).lanes.bits();
            if blocked == query.lanes {
                break;
            }
        }
        blocked
    }

    fn shadow_area(&self) -> f32 {
        (0..self.tags.count()).map(|i| 2.0 * std::f32::consts::PI * self.radius.lane(i).powi(2)).sum()
    }
}
