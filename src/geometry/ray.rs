//! One ray and eight.

use glam::Vec3;

use super::GeometryMask;
use crate::simd::{F32x8, Vec3x8};

/// A ray: the points `origin + t * dir` with `t_min < t <= t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start, in scene units.
    pub origin: Vec3,
    /// Direction; of any length but zero, though `t` is a distance only where it is one.
    pub dir: Vec3,
    /// Hits at or below this parameter are not seen.
    pub t_min: f32,
    /// Hits above this parameter are not seen.
    pub t_max: f32,
    /// The kinds of geometry it looks for.
    pub admits: GeometryMask,
}

impl Ray {
    /// A ray over `0 < t <= inf` that sees everything.
    #[must_use]
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        Self { origin, dir, t_min: 0.0, t_max: f32::INFINITY, admits: GeometryMask::ALL }
    }
}

/// Eight rays in structure-of-arrays. Lanes whose `active` bit is clear may hold anything at all.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Ray8 {
    /// Starts, in scene units.
    pub origin: Vec3x8,
    /// Directions, as in [`Ray::dir`].
    pub dir: Vec3x8,
    /// Hits at or below are not seen.
    pub t_min: F32x8,
    /// Hits above are not seen.
    pub t_max: F32x8,
    /// Which lanes hold a ray, lane 0 lowest.
    pub active: u8,
    /// The kinds of geometry that all eight look for: rays are queued by kind, so one mask serves a packet.
    pub admits: GeometryMask,
}

impl Default for Ray8 {
    /// Eight inactive lanes, with numbers that intersection arithmetic stays finite on.
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

    /// Puts `ray` into lane `i` (0..8) and marks it active. The packet takes on the ray's mask.
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
