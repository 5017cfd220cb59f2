//! The interface between traversal and leaves: primitive tests, and ids of the primitives.

use super::super::ray::lane_ray::LaneRay;
use super::super::ray::packet8::LeafPacket8;
use super::closest_hit::ClosestHit8;
use crate::geometry::{Aabb8, NO_GEOMETRY, Octant};
use crate::simd::{F32x8, Mask8};

/// A leaf: up to eight primitives of one shape in structure-of-arrays.
pub(crate) trait Leaf: Sync {
    /// Tests one ray against all primitives. Returns the hits with `t_min < t <= t_max`, if there are any.
    fn intersect_ray(&self, ray: &LaneRay, t_max: f32) -> Option<LeafHits>;
    /// Ids and masks of the primitives.
    fn tags(&self) -> &Tags;
    /// Boxes of the primitives, by slot. Boxes of empty slots are undefined.
    fn boxes(&self) -> Aabb8;
    /// Tests rays of a packet against the primitives in `slots`. Closer hits replace those in `closest`.
    fn closest_packet(&self, rays: &LeafPacket8, query: &LeafQuery, slots: u8, closest: &mut ClosestHit8);
    /// Tests rays of a packet against the primitives in `slots`. Returns the lanes with any hit at or before `t_max`.
    fn occluded_packet(&self, rays: &LeafPacket8, query: &LeafQuery, slots: u8, t_max: F32x8) -> u8;
    /// Twice the area of the primitives' shadows, averaged over all directions. For a triangle this is its area.
    fn shadow_area(&self) -> f32;

    /// Ids of the primitives, as `(geometry, primitive)`.
    fn ids(&self) -> impl Iterator<Item = (u32, u32)> {
        let tags = self.tags();
        (0..tags.count()).map(|i| (tags.geometry[i], tags.primitive[i]))
    }
}

/// Hits in some lanes: of one ray with eight primitives, or of eight rays with one primitive.
pub(crate) struct LeafHits {
    /// Lanes with a hit; at least one lane in a hit of a single ray.
    pub lanes: Mask8,
    /// Ray parameters.
    pub t: F32x8,
    /// Barycentric weights of the second corners; 0 on spheres.
    pub u: F32x8,
    /// Barycentric weights of the third corners; 0 on spheres.
    pub v: F32x8,
}

/// The rays of a packet that a leaf tests, and the properties that they share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafQuery<'a> {
    /// Lanes of the rays.
    pub lanes: u8,
    /// Common octant of the rays.
    pub octant: Octant,
    /// Boxes of the primitives, from [`Leaf::boxes`].
    pub boxes: &'a Aabb8,
}

/// Ids and masks of the primitives in a leaf.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Tags {
    /// Geometry ids.
    pub geometry: [u32; 8],
    /// Primitive ids.
    pub primitive: [u32; 8],
    /// Geometry masks, one byte a slot; 0 in empty slots, which no ray admits.
    masks: u64,
    /// Number of filled slots. Filled slots come first.
    count: u64,
}

impl Tags {
    /// Tags of at most eight primitives, given as `(geometry, primitive, mask)`.
    pub fn new(of: impl Iterator<Item = (u32, u32, u8)>) -> Self {
        let mut tags = Self { geometry: [NO_GEOMETRY; 8], primitive: [0; 8], masks: 0, count: 0 };
        for (i, (geometry, primitive, mask)) in of.enumerate() {
            tags.geometry[i] = geometry;
            tags.primitive[i] = primitive;
            tags.masks |= u64::from(mask) << (8 * i);
            tags.count += 1;
        }
        tags
    }

    /// All bits of the tags.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let (masks, count) = (self.masks, self.count);
        let rest = [masks as u32, (masks >> 32) as u32, count as u32];
        self.geometry.into_iter().chain(self.primitive).chain(rest)
    }

    /// Number of filled slots.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// Returns the slots whose geometry mask shares a bit with `admits`.
    #[inline(always)]
    pub fn admitted(&self, admits: u8) -> u8 {
        const LOW7: u64 = 0x7f7f_7f7f_7f7f_7f7f;
        let shared = self.masks & (u64::from(admits) * 0x0101_0101_0101_0101);
        // Sets the top bit of each byte that is not zero, then packs the eight top bits into one byte.
        let top = (((shared & LOW7) + LOW7) | shared) & !LOW7;
        ((top >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
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
}
