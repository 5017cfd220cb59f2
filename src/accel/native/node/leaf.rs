//! The interface between traversal and leaves.

use super::super::ray::lane_ray::LaneRay;
use super::super::ray::packet8::LeafPacket8;
use super::closest_hit::{ClosestHit8, LeafHits};
use super::tags::Tags;
use crate::geometry::{Aabb8, Octant};
use crate::simd::F32x8;

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
