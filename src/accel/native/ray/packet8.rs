//! Ray packets prepared for traversal, so that no step computes the same value twice.

use crate::geometry::slab::{SlabRay, T_LIMIT, is_traceable};
use crate::geometry::triangle::{Axis, ShearedRay};
use crate::geometry::{Aabb8, Octant, Ray8};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, Vec3x8, set_lanes, transpose_bits};

/// Axes in the order of [`Axis::turn`], indexed by the longest axis.
pub(crate) const TURNED_AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// A ray packet prepared for box tests.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet8 {
    /// Origins and inverse directions.
    pub slab: SlabRay<F32x8>,
    /// Directions.
    pub dir: Vec3x8,
    /// Lower ends of the ray intervals.
    pub t_min: F32x8,
    /// Upper ends of the ray intervals; -inf in lanes without a traceable ray.
    pub t_max: F32x8,
    /// Lanes with a traceable ray.
    pub lanes: u8,
    /// Bits of the [`crate::geometry::GeometryMask`] of all eight rays.
    pub admits: u8,
    /// Sign bits of the inverse directions, by axis.
    backwards: [u8; 3],
}

impl Packet8 {
    /// Prepares a packet. Lanes whose ray cannot hit anything (inactive, NaN, empty interval) are masked out.
    #[inline(always)]
    pub fn new(rays: &Ray8) -> Self {
        let t_max = Real::min(rays.t_max, F32x8::from(T_LIMIT));
        let sound = is_traceable(rays.origin, rays.dir, rays.t_min, t_max) & rays.t_max.eq(rays.t_max);
        let lanes = sound.bits() & rays.active;
        let slab = SlabRay::new(rays.origin, rays.dir);
        Self {
            slab,
            dir: rays.dir,
            t_min: rays.t_min,
            t_max: Mask8::from_bits(lanes).select(t_max, F32x8::from(f32::NEG_INFINITY)),
            lanes,
            admits: rays.admits.0,
            backwards: [slab.inverse.x.sign_bits(), slab.inverse.y.sign_bits(), slab.inverse.z.sign_bits()],
        }
    }

    /// Returns the lanes of `lanes` in the same octant as the lowest of them.
    #[inline(always)]
    pub fn same_octant(&self, lanes: u8) -> u8 {
        let first = lanes.trailing_zeros() & 7;
        self.backwards.iter().fold(lanes, |kept, &b| kept & if b >> first & 1 != 0 { b } else { !b })
    }

    /// Compares the rays of `lanes` with the lowest of them. Returns the lanes whose directions differ by an angle whose
    /// squared cosine is at least `agreement`, and those of them that also have the same origin.
    #[inline(always)]
    pub fn similar(&self, lanes: u8, agreement: f64) -> (u8, u8) {
        let first = lanes.trailing_zeros() as usize & 7;
        let (dir, start) = (Vec3x8::splat(self.dir.lane(first)), Vec3x8::splat(self.slab.origin.lane(first)));
        let along = self.dir.dot(dir);
        let all = self.dir.length_squared() * dir.length_squared();
        let o = self.slab.origin;
        let together = o.x.eq(start.x) & o.y.eq(start.y) & o.z.eq(start.z);
        let close = (F32x8::splat(agreement) * all).le(along * along.abs()).bits() & lanes;
        (close, close & together.bits())
    }

    /// The octant of the ray in `lane`.
    #[inline(always)]
    pub fn octant(&self, lane: usize) -> Octant {
        self.backwards.map(|b| usize::from(b >> lane & 1))
    }

    /// The octants of all rays as bits: x lowest, a bit set where the ray runs towards lower coordinates.
    #[inline(always)]
    pub fn octants(&self) -> [u8; 8] {
        let [x, y, z] = self.backwards.map(u64::from);
        transpose_bits(x | y << 8 | z << 16).to_le_bytes()
    }

    /// One row for each ray: origin, `t_min`, inverse direction, `t_max`.
    #[inline(always)]
    pub fn rows(&self) -> [F32x8; 8] {
        let (o, d) = (self.slab.origin, self.slab.inverse);
        F32x8::transpose([o.x, o.y, o.z, self.t_min, d.x, d.y, d.z, self.t_max])
    }

    /// Returns the lanes of `lanes` with `t_min >= 0`.
    #[inline(always)]
    pub fn ahead(&self, lanes: u8) -> u8 {
        F32x8::ZERO.le(self.t_min).bits() & lanes
    }

    /// Returns the boxes among `candidates` that a ray of `lanes` hits before `t_max`. All these rays share `octant`.
    #[inline(always)]
    pub fn boxes_hit(&self, lanes: u8, t_max: F32x8, octant: Octant, boxes: &Aabb8, candidates: u8) -> u8 {
        let mut kept = 0;
        set_lanes(candidates).for_each(|c| {
            let (near, far) = boxes.sorted_lane(octant, c);
            let (enter, leave) = self.slab.clip_sorted(near, far, self.t_min, t_max);
            kept |= u8::from(enter.le(leave).bits() & lanes != 0) << c;
        });
        kept
    }
}

/// A ray packet prepared for box tests and for the primitive tests in leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafPacket8 {
    /// The rays, prepared for box tests.
    pub packet: Packet8,
    /// The rays, sheared for the triangle test.
    pub sheared: ShearedRay<F32x8>,
    /// Longest axes of the directions.
    pub axis: Axis<Mask8>,
    /// Lanes whose longest axis is x, and those whose longest axis is y.
    axis_bits: (u8, u8),
}

impl LeafPacket8 {
    /// Prepares a packet for leaves.
    #[inline(always)]
    pub fn new(packet: &Packet8) -> Self {
        let (sheared, axis) = ShearedRay::new(packet.slab.origin, packet.dir);
        Self { packet: *packet, sheared, axis, axis_bits: (axis.is_x.bits(), axis.is_y.bits()) }
    }

    /// Returns the longest axis of the rays in `lanes` if it is the same for all of them.
    #[inline(always)]
    pub fn common_axis(&self, lanes: u8) -> Option<usize> {
        let (x, y) = (self.axis_bits.0 & lanes, self.axis_bits.1 & lanes);
        match (x == lanes, y == lanes, x | y == 0) {
            (true, _, _) => Some(0),
            (_, true, _) => Some(1),
            (_, _, true) => Some(2),
            _ => None,
        }
    }
}

impl Default for LeafPacket8 {
    /// A packet without rays.
    fn default() -> Self {
        Self::new(&Packet8::new(&Ray8::default()))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::Ray;

    /// LN-04: a ray that can meet nothing costs no traversal: it is left out at the door, and its neighbours are not.
    #[test]
    fn rays_that_can_meet_nothing_are_left_out_before_traversal() {
        let good = Ray::new(Vec3::ONE, Vec3::new(0.1, -0.2, 0.9));
        let bad = [
            Ray { dir: Vec3::new(f32::NAN, 0.0, 1.0), ..good },
            Ray { dir: Vec3::new(0.0, f32::INFINITY, 1.0), ..good },
            Ray { dir: Vec3::new(0.0, -0.0, 0.0), ..good },
            Ray { origin: Vec3::new(0.0, 0.0, f32::NAN), ..good },
            Ray { origin: Vec3::new(0.0, f32::NEG_INFINITY, 0.0), ..good },
            Ray { t_min: f32::NAN, ..good },
            Ray { t_max: f32::NAN, ..good },
            Ray { t_min: 2.0, t_max: 2.0, ..good },
        ];
        for lane in 0..8 {
            for bad in bad {
                let mut rays = [good; 8];
                rays[lane] = bad;
                assert_eq!(Packet8::new(&Ray8::pack(&rays)[0]).lanes, !(1 << lane), "{bad:?}");
            }
        }
        assert_eq!(Packet8::new(&Ray8::pack(&bad)[0]).lanes, 0);
    }
}
