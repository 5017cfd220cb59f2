//! Single rays read out of packets, for kernels that trace one ray at a time.
//!
//! Rays stay where they are in their packets. A kernel broadcasts one value of one ray from a place that seven other rays
//! share, so that packets need not be transposed into rays first.

use super::packet8::{Packet8, TURNED_AXES};
use crate::geometry::Octant;
use crate::geometry::slab::SlabRay;
use crate::geometry::triangle::ShearedRay;
use crate::math::Real;
use crate::simd::{F32x8, Vec3x8};

/// The data of eight rays that box tests read, in four cache lines. The rays are traced independently.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct BoxRays8 {
    origin: [F32x8; 3],
    t_min: F32x8,
    inverse: [F32x8; 3],
    /// Current upper ends of the ray intervals; -inf ends a ray.
    pub t_max: F32x8,
}

/// The data of eight rays that only leaves read.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct LeafRays8 {
    dir: [F32x8; 3],
    /// [`ShearedRay::shear`].
    shear: [F32x8; 2],
    /// Longest axes of the directions.
    last: [u32; 8],
    admits: u8,
    /// Lanes that hold a ray.
    pub lanes: u8,
    /// Index of the packet in the stream.
    pub packet: u16,
}

const _: () = assert!(size_of::<BoxRays8>() == 256 && size_of::<LeafRays8>() == 256);

/// One ray of a packet; its values are broadcast to all lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneRay<'a> {
    boxes: &'a BoxRays8,
    leaves: &'a LeafRays8,
    lane: usize,
    /// Octant of the direction.
    pub octant: Octant,
}

impl BoxRays8 {
    /// Copies the data for box tests out of a packet.
    #[inline(always)]
    pub fn new(packet: &Packet8) -> Self {
        let (o, d) = (packet.slab.origin, packet.slab.inverse);
        Self { origin: [o.x, o.y, o.z], t_min: packet.t_min, inverse: [d.x, d.y, d.z], t_max: packet.t_max }
    }

    /// Origin and inverse direction of the ray in `lane`, in all lanes.
    #[inline(always)]
    fn slab(&self, lane: usize) -> SlabRay<F32x8> {
        let all = |of: &[F32x8; 3]| {
            let at = |k: usize| F32x8::from(of[k].lane(lane & 7));
            Vec3x8::new(at(0), at(1), at(2))
        };
        SlabRay { origin: all(&self.origin), inverse: all(&self.inverse) }
    }

    /// Tests the ray in `lane` against eight boxes, given by near and far planes for its octant. Returns the boxes hit.
    #[inline(always)]
    pub fn boxes_hit(&self, lane: usize, near: Vec3x8, far: Vec3x8) -> u8 {
        let (t_min, t_max) = (self.t_min.lane(lane & 7), self.t_max.lane(lane & 7));
        let (enter, leave) = self.slab(lane).clip_sorted(near, far, F32x8::from(t_min), F32x8::from(t_max));
        enter.le(leave).bits()
    }
}

impl LeafRays8 {
    /// Copies the data for leaves out of packet number `index` of the stream, of which the rays in `lanes` are traced.
    #[inline(always)]
    pub fn new(packet: &Packet8, index: usize, lanes: u8) -> Self {
        let (ray, axis) = ShearedRay::new(packet.slab.origin, packet.dir);
        let number = |n: u32| F32x8::from(f32::from_bits(n));
        let last = axis.is_x.select(number(0), axis.is_y.select(number(1), number(2)));
        let d = packet.dir;
        Self {
            dir: [d.x, d.y, d.z],
            shear: [ray.shear.0, ray.shear.1],
            last: bytemuck::cast(last),
            admits: packet.admits,
            lanes,
            packet: index as u16,
        }
    }
}

impl<'a> LaneRay<'a> {
    /// The ray in `lane`, whose direction lies in `octant`.
    #[inline(always)]
    pub fn new(boxes: &'a BoxRays8, leaves: &'a LeafRays8, lane: usize, octant: Octant) -> Self {
        Self { boxes, leaves, lane: lane & 7, octant }
    }

    /// Origin and inverse direction.
    #[inline(always)]
    pub fn slab(&self) -> SlabRay<F32x8> {
        self.boxes.slab(self.lane)
    }

    /// The ray sheared for the triangle test.
    #[inline(always)]
    pub fn sheared(&self) -> ShearedRay<F32x8> {
        let [x, y, z] = self.axes();
        let at = |of: &F32x8| F32x8::from(of.lane(self.lane));
        let (BoxRays8 { origin, .. }, LeafRays8 { dir, shear, .. }) = (self.boxes, self.leaves);
        ShearedRay {
            origin: Vec3x8::new(at(&origin[x]), at(&origin[y]), at(&origin[z])),
            shear: (at(&shear[0]), at(&shear[1])),
            dz: at(&dir[z]),
        }
    }

    /// Axes in the order of the triangle test, the longest last.
    #[inline(always)]
    pub fn axes(&self) -> [usize; 3] {
        TURNED_AXES[self.leaves.last[self.lane] as usize]
    }

    /// Direction.
    #[inline(always)]
    pub fn dir(&self) -> Vec3x8 {
        let at = |k: usize| F32x8::from(self.leaves.dir[k].lane(self.lane));
        Vec3x8::new(at(0), at(1), at(2))
    }

    /// Lower end of the ray interval.
    #[inline(always)]
    pub fn t_min(&self) -> F32x8 {
        F32x8::from(self.boxes.t_min.lane(self.lane))
    }

    /// Bits of the ray's [`crate::geometry::GeometryMask`].
    #[inline(always)]
    pub fn admits(&self) -> u8 {
        self.leaves.admits
    }
}
