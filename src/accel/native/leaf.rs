//! What a hierarchy asks of its leaves, and what is kept of the nearest hit so far.

use super::bvh8::Planes;
use super::one::One;
use super::rays::Eight;
use crate::geometry::{Hit, Hit8, NO_GEOMETRY};
use crate::math::{LaneMask, Real};
use crate::simd::{F32x8, Mask8};

/// Up to eight primitives of one kind, stored for eight lanes.
pub(super) trait Leaf: Sync {
    /// What one ray meets of these primitives at or before `t_max`.
    fn meet_one(&self, ray: &One, t_max: f32) -> Option<Met>;
    /// What the primitives are.
    fn tags(&self) -> &Tags;
    /// The boxes of the primitives, by slot; those of empty slots may be anything.
    fn boxes(&self) -> Planes;
    /// Takes the nearest hits of rays with the primitives in `slots` into `best`, where they are nearer.
    fn closest_eight(&self, rays: &Eight, to: &Towards, slots: u8, best: &mut Best8);
    /// Which rays meet any of the primitives in `slots` at or before their `t_max`.
    fn occluded_eight(&self, rays: &Eight, to: &Towards, slots: u8, t_max: F32x8) -> u8;
    /// Twice the mean area of the shadows that the primitives throw, over all directions: of a triangle, its area.
    fn cover(&self) -> f32;
    /// Ids of the primitives within, `(geometry, primitive)`.
    fn ids(&self) -> impl Iterator<Item = (u32, u32)>;
}

/// Hits of some lanes.
pub(super) struct Met {
    /// Which; of one ray, at least one.
    pub lanes: Mask8,
    /// Ray parameters.
    pub t: F32x8,
    /// Weights of the second corners.
    pub u: F32x8,
    /// Weights of the third corners.
    pub v: F32x8,
}

/// Which rays of a packet are tested, and what they have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Towards<'a> {
    /// The rays.
    pub lanes: u8,
    /// The octant that all of them run into.
    pub octant: [usize; 3],
    /// [`Leaf::boxes`].
    pub boxes: &'a Planes,
}

/// Ids and kinds of the primitives in a block.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Tags {
    /// Geometries.
    pub geometry: [u32; 8],
    /// Primitives.
    pub primitive: [u32; 8],
    /// Masks of the geometries; 0 in empty slots, so that no ray looks for them.
    kinds: u64,
    /// How many slots are filled; they come first.
    count: u64,
}

impl Tags {
    /// From `(geometry, primitive, mask)` of at most eight primitives.
    pub fn new(of: impl Iterator<Item = (u32, u32, u8)>) -> Self {
        let mut tags = Self { geometry: [NO_GEOMETRY; 8], primitive: [0; 8], kinds: 0, count: 0 };
        for (i, (geometry, primitive, mask)) in of.enumerate() {
            tags.geometry[i] = geometry;
            tags.primitive[i] = primitive;
            tags.kinds |= u64::from(mask) << (8 * i);
            tags.count += 1;
        }
        tags
    }

    /// Every bit of them.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let (kinds, count) = (self.kinds, self.count);
        let rest = [kinds as u32, (kinds >> 32) as u32, count as u32];
        self.geometry.into_iter().chain(self.primitive).chain(rest)
    }

    /// How many slots are filled.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// The slots whose kinds share a bit with `admits`, one bit a slot.
    #[inline(always)]
    pub fn admitted(&self, admits: u8) -> u8 {
        const LOW7: u64 = 0x7f7f_7f7f_7f7f_7f7f;
        let shared = self.kinds & (u64::from(admits) * 0x0101_0101_0101_0101);
        // The top bit of each byte that is not zero, then those eight bits side by side.
        let top = (((shared & LOW7) + LOW7) | shared) & !LOW7;
        ((top >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
    }
}

/// The nearest hit of one ray so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best {
    /// Its parameter; the ray's own limit before there is a hit.
    pub t: f32,
    u: f32,
    v: f32,
    geometry: u32,
    primitive: u32,
}

impl Best {
    /// No hit yet.
    #[inline(always)]
    pub fn new(t_max: f32) -> Self {
        Self { t: t_max, u: 0.0, v: 0.0, geometry: NO_GEOMETRY, primitive: 0 }
    }

    /// What a lane holds of them, seen as far as `t_max`.
    #[inline(always)]
    pub fn of(hits: &Hit8, lane: usize, t_max: f32) -> Self {
        let i = lane & 7;
        let (geometry, primitive) = (hits.geometry[i], hits.primitive[i]);
        Self { t: t_max, u: hits.u.lane(i), v: hits.v.lane(i), geometry, primitive }
    }

    /// Takes the nearest of the hits of one ray, whose `t` are all seen by it, unless the present one is nearer.
    #[inline(always)]
    pub fn take(&mut self, met: &Met, tags: &Tags) {
        let (mut lanes, Met { t, u, v, .. }) = (met.lanes.bits(), met);
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize & 7;
            lanes &= lanes - 1;
            let (at, id) = (t.lane(i), (tags.geometry[i], tags.primitive[i]));
            if at < self.t || (at == self.t && id < (self.geometry, self.primitive)) {
                *self = Self { t: at, u: u.lane(i), v: v.lane(i), geometry: id.0, primitive: id.1 };
            }
        }
    }

    /// The hit, or a miss.
    #[inline(always)]
    pub fn hit(&self) -> Hit {
        if self.geometry == NO_GEOMETRY {
            return Hit::MISS;
        }
        Hit { t: self.t, u: self.u, v: self.v, instance: 0, geometry: self.geometry, primitive: self.primitive }
    }
}

/// The nearest hits of eight rays so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best8 {
    /// Their parameters; a ray's own limit before it has a hit, -inf in lanes without a ray.
    pub t: F32x8,
    u: F32x8,
    v: F32x8,
    /// Bit patterns, not numbers: as lanes they take part in selections.
    geometry: F32x8,
    primitive: F32x8,
}

impl Best8 {
    /// No hits yet.
    #[inline(always)]
    pub fn new(t_max: F32x8) -> Self {
        let none = F32x8::from(f32::from_bits(NO_GEOMETRY));
        Self { t: t_max, u: F32x8::ZERO, v: F32x8::ZERO, geometry: none, primitive: F32x8::ZERO }
    }

    /// Takes the hits of `met` with one primitive, all of which the rays see, where they are nearer.
    #[inline(always)]
    pub fn take(&mut self, met: Mask8, t: F32x8, u: F32x8, v: F32x8, geometry: u32, primitive: u32) {
        let mut nearer = met & t.lt(self.t);
        let tied = met & t.eq(self.t);
        if tied.any() {
            nearer |= tied & Mask8::from_bits(self.later_than(geometry, primitive));
        }
        self.t = nearer.select(t, self.t);
        self.u = nearer.select(u, self.u);
        self.v = nearer.select(v, self.v);
        self.geometry = nearer.select(F32x8::from(f32::from_bits(geometry)), self.geometry);
        self.primitive = nearer.select(F32x8::from(f32::from_bits(primitive)), self.primitive);
    }

    /// The lanes whose present hit has a higher id than the given one.
    #[cold]
    fn later_than(&self, geometry: u32, primitive: u32) -> u8 {
        (0..8).filter(|&i| (geometry, primitive) < self.id(i)).fold(0, |bits, i| bits | 1 << i)
    }

    fn id(&self, lane: usize) -> (u32, u32) {
        (self.geometry.lane(lane).to_bits(), self.primitive.lane(lane).to_bits())
    }

    /// The state of one lane, for a kernel that follows its ray alone.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> Best {
        let (geometry, primitive) = self.id(i);
        Best { t: self.t.lane(i), u: self.u.lane(i), v: self.v.lane(i), geometry, primitive }
    }

    /// Puts back what [`Best8::lane`] gave.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, best: &Best) {
        self.t.set_lane(i, best.t);
        self.u.set_lane(i, best.u);
        self.v.set_lane(i, best.v);
        self.geometry.set_lane(i, f32::from_bits(best.geometry));
        self.primitive.set_lane(i, f32::from_bits(best.primitive));
    }

    /// Writes hits or misses into `lanes` of `hits`.
    #[inline(always)]
    pub fn write(&self, lanes: u8, hits: &mut Hit8) {
        let lanes = Mask8::from_bits(lanes);
        let put = |new: F32x8, old: [u32; 8]| bytemuck::cast(lanes.select(new, bytemuck::cast(old)));
        let geometry: [u32; 8] = bytemuck::cast(self.geometry);
        let t = self.t.as_array();
        let t = F32x8::from_fn(|i| if geometry[i] == NO_GEOMETRY { f32::INFINITY } else { t[i] });
        hits.t = lanes.select(t, hits.t);
        hits.u = lanes.select(self.u, hits.u);
        hits.v = lanes.select(self.v, hits.v);
        hits.instance = put(F32x8::ZERO, hits.instance);
        hits.geometry = put(self.geometry, hits.geometry);
        hits.primitive = put(self.primitive, hits.primitive);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_is_admitted_where_it_shares_a_kind() {
        let masks = [0_u8, 1, 2, 3, 4, 128, 255, 0];
        for filled in 0..=8 {
            let tags = Tags::new(masks[..filled].iter().map(|&m| (7, 9, m)));
            assert_eq!(tags.count(), filled);
            for admits in 0..=u8::MAX {
                let want = masks[..filled].iter().enumerate().fold(0, |b, (i, m)| b | u8::from(m & admits != 0) << i);
                assert_eq!(tags.admitted(admits), want, "{admits:08b}");
            }
        }
    }

    /// Case TR-03 of the catalogue.
    #[test]
    fn of_equal_hits_the_lower_id_stays_whichever_comes_first() {
        for ids in [[(0, 5), (1, 0)], [(2, 3), (2, 4)]] {
            for order in [[0, 1], [1, 0]] {
                let mut eight = Best8::new(F32x8::from(2.0));
                let mut one = eight.lane(0);
                for (geometry, primitive) in order.map(|i: usize| ids[i]) {
                    let t = F32x8::ONE;
                    eight.take(Mask8::ALL, t, t, t, geometry, primitive);
                    one.take(
                        &Met { lanes: Mask8::from_bits(1), t, u: t, v: t },
                        &Tags::new([(geometry, primitive, 1)].into_iter()),
                    );
                }
                assert_eq!(one.hit().id(), (0, ids[0].0, ids[0].1));
                assert!((0..8).all(|i| eight.lane(i).hit() == one.hit()));
            }
        }
    }
}
