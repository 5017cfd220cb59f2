//! Rays, and packets of eight rays.

use glam::Vec3;

use super::mask::GeometryMask;
use crate::simd::{F32x8, Vec3x8};

/// A ray: the points `origin + t * dir` with `t_min < t <= t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin, in scene units.
    pub origin: Vec3,
    /// Direction, of any length except zero. `t` is a distance only if the length is 1.
    pub dir: Vec3,
    /// Hits with `t <= t_min` are ignored.
    pub t_min: f32,
    /// Hits with `t > t_max` are ignored.
    pub t_max: f32,
    /// The geometry classes that the ray can hit.
    pub admits: GeometryMask,
}

impl Ray {
    /// A ray over `0 < t <= inf` that can hit all geometry.
    #[must_use]
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        Self { origin, dir, t_min: 0.0, t_max: f32::INFINITY, admits: GeometryMask::ALL }
    }
}

/// A ray packet: eight rays in structure-of-arrays. Lanes whose `active` bit is clear may hold any value.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Ray8 {
    /// Origins, in scene units.
    pub origin: Vec3x8,
    /// Directions, as in [`Ray::dir`].
    pub dir: Vec3x8,
    /// Hits with `t <= t_min` are ignored.
    pub t_min: F32x8,
    /// Hits with `t > t_max` are ignored.
    pub t_max: F32x8,
    /// Lanes that hold a ray, lane 0 in the lowest bit.
    pub active: u8,
    /// The geometry classes that all eight rays can hit. Rays with different masks are queued apart.
    pub admits: GeometryMask,
}

impl Default for Ray8 {
    /// Eight inactive lanes, with values on which intersection arithmetic stays finite.
    fn default() -> Self {
        Self {
            origin: Vec3x8::splat(Vec3::ZERO),
            dir: Vec3x8::splat(Vec3::Z),
            t_min: F32x8::ZERO,
            t_max: F32x8::INFINITY,
            active: 0,
            admits: GeometryMask::ALL,
        }
    }
}

impl Ray8 {
    /// The ray in lane `i` (0..8).
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, i: usize) -> Ray {
        Ray {
            origin: self.origin.lane(i),
            dir: self.dir.lane(i),
            t_min: self.t_min.lane(i),
            t_max: self.t_max.lane(i),
            admits: self.admits,
        }
    }

    /// Puts `ray` into lane `i` (0..8) and marks it active. The whole packet takes the mask of the ray.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, ray: &Ray) {
        self.origin.set_lane(i, ray.origin);
        self.dir.set_lane(i, ray.dir);
        self.t_min.set_lane(i, ray.t_min);
        self.t_max.set_lane(i, ray.t_max);
        self.active |= 1 << i;
        self.admits = ray.admits;
    }

    /// Packs rays in order, eight to a packet; the last one may be partly filled. All rays must share one mask.
    #[must_use]
    pub fn pack(rays: &[Ray]) -> Vec<Self> {
        rays.chunks(8)
            .map(|chunk| {
                let mut packet = Self::default();
                for (i, ray) in chunk.iter().enumerate() {
                    packet.set_lane(i, ray);
                }
                packet
            })
            .collect()
    }
}
