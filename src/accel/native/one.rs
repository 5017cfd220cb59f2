//! One ray of eight, for kernels that take it alone.
//!
//! Rays stay where they are in their packets: a step reads a number of one ray into all lanes, from a place it shares with
//! seven others, and nothing has to be turned from lanes into rays first.

use super::rays::{TURNED, Way8};
use crate::geometry::slab::SlabRay;
use crate::geometry::triangle::ShearedRay;
use crate::math::Real;
use crate::simd::{F32x8, Vec3x8};

/// What box tests ask of eight rays that are walked apart: each lane is one of them, in four cache lines with the others.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Hot8 {
    origin: [F32x8; 3],
    t_min: F32x8,
    inverse: [F32x8; 3],
    /// How far they are looked at from here on; -inf ends one.
    pub t_max: F32x8,
}

/// What else is asked of them, where they reach a leaf.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Cold8 {
    dir: [F32x8; 3],
    /// As [`ShearedRay`] has them.
    shear: [F32x8; 2],
    /// The longest axes of the directions.
    last: [u32; 8],
    admits: u8,
    /// Which of them there are.
    pub lanes: u8,
    /// Whose they are.
    pub packet: u16,
}

const _: () = assert!(size_of::<Hot8>() == 256 && size_of::<Cold8>() == 256);

/// One ray for kernels that take it alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct One<'a> {
    hot: &'a Hot8,
    cold: &'a Cold8,
    lane: usize,
    /// For each axis, 1 where the ray runs backwards along it.
    pub octant: [usize; 3],
}

impl Hot8 {
    /// From what is known of a packet.
    #[inline(always)]
    pub fn new(way: &Way8) -> Self {
        let (o, d) = (way.slab.origin, way.slab.inverse);
        Self { origin: [o.x, o.y, o.z], t_min: way.t_min, inverse: [d.x, d.y, d.z], t_max: way.t_max }
    }

    /// Start and inverse direction of one of them, in all lanes.
    #[inline(always)]
    fn slab(&self, lane: usize) -> SlabRay<F32x8> {
        let all = |of: &[F32x8; 3]| {
            let at = |k: usize| F32x8::from(of[k].lane(lane & 7));
            Vec3x8::new(at(0), at(1), at(2))
        };
        SlabRay { origin: all(&self.origin), inverse: all(&self.inverse) }
    }

    /// Which of eight boxes one of them meets, by their planes in the order in which it reaches them.
    #[inline(always)]
    pub fn meet(&self, lane: usize, near: Vec3x8, far: Vec3x8) -> u8 {
        let (t_min, t_max) = (self.t_min.lane(lane & 7), self.t_max.lane(lane & 7));
        let (enter, leave) = self.slab(lane).clip_sorted(near, far, F32x8::from(t_min), F32x8::from(t_max));
        enter.le(leave).bits()
    }
}

impl Cold8 {
    /// From what is known of a packet, of which only some rays are walked apart.
    #[inline(always)]
    pub fn new(way: &Way8, packet: usize, lanes: u8) -> Self {
        let (ray, axis) = ShearedRay::new(way.slab.origin, way.dir);
        let number = |n: u32| F32x8::from(f32::from_bits(n));
        let last = axis.is_x.select(number(0), axis.is_y.select(number(1), number(2)));
        let d = way.dir;
        Self {
            dir: [d.x, d.y, d.z],
            shear: [ray.shear.0, ray.shear.1],
            last: bytemuck::cast(last),
            admits: way.admits,
            lanes,
            packet: packet as u16,
        }
    }
}

impl<'a> One<'a> {
    /// A ray of eight.
    #[inline(always)]
    pub fn new(hot: &'a Hot8, cold: &'a Cold8, lane: usize, octant: [usize; 3]) -> Self {
        Self { hot, cold, lane: lane & 7, octant }
    }

    /// Start and inverse direction.
    #[inline(always)]
    pub fn slab(&self) -> SlabRay<F32x8> {
        self.hot.slab(self.lane)
    }

    /// Turned and sheared for the triangle test.
    #[inline(always)]
    pub fn sheared(&self) -> ShearedRay<F32x8> {
        let [x, y, z] = self.axes();
        let at = |of: &F32x8| F32x8::from(of.lane(self.lane));
        let (Hot8 { origin, .. }, Cold8 { dir, shear, .. }) = (self.hot, self.cold);
        ShearedRay {
            origin: Vec3x8::new(at(&origin[x]), at(&origin[y]), at(&origin[z])),
            shear: (at(&shear[0]), at(&shear[1])),
            dz: at(&dir[z]),
        }
    }

    /// The axes in the order in which the triangle test wants them, the longest last.
    #[inline(always)]
    pub fn axes(&self) -> [usize; 3] {
        TURNED[self.cold.last[self.lane] as usize]
    }

    /// Direction.
    #[inline(always)]
    pub fn dir(&self) -> Vec3x8 {
        let at = |k: usize| F32x8::from(self.cold.dir[k].lane(self.lane));
        Vec3x8::new(at(0), at(1), at(2))
    }

    /// Lower end of the interval.
    #[inline(always)]
    pub fn t_min(&self) -> F32x8 {
        F32x8::from(self.hot.t_min.lane(self.lane))
    }

    /// Kinds of geometry looked for.
    #[inline(always)]
    pub fn admits(&self) -> u8 {
        self.cold.admits
    }
}
