//! Hits with the primitives of a leaf, and the closest hit so far of one ray and of eight.

use super::tags::Tags;
use crate::geometry::{Hit, Hit8, NO_GEOMETRY};
use crate::math::{LaneMask, Real};
use crate::simd::{F32x8, Mask8, set_lanes};

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

/// The closest hit of one ray so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestHit {
    /// Ray parameter of the hit; the ray's `t_max` before there is one.
    pub t: f32,
    u: f32,
    v: f32,
    geometry: u32,
    primitive: u32,
}

impl ClosestHit {
    /// No hit yet, on a ray that ends at `t_max`.
    #[inline(always)]
    pub fn new(t_max: f32) -> Self {
        Self { t: t_max, u: 0.0, v: 0.0, geometry: NO_GEOMETRY, primitive: 0 }
    }

    /// The hit in a lane of `hits`, or a miss, on a ray that now ends at `t_max`.
    #[inline(always)]
    pub fn of(hits: &Hit8, lane: usize, t_max: f32) -> Self {
        let i = lane & 7;
        let (geometry, primitive) = (hits.geometry[i], hits.primitive[i]);
        Self { t: t_max, u: hits.u.lane(i), v: hits.v.lane(i), geometry, primitive }
    }

    /// Replaces the hit by the closest of `hits` if that is closer. All `t` of `hits` must lie in the ray interval. Of equal
    /// `t` the lower `(geometry, primitive)` wins.
    #[inline(always)]
    pub fn update(&mut self, LeafHits { lanes, t, u, v }: &LeafHits, tags: &Tags) {
        for i in set_lanes(lanes.bits()) {
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

/// The closest hits of eight rays so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestHit8 {
    /// Ray parameters of the hits; a ray's `t_max` before it has one, -inf in lanes without a ray.
    pub t: F32x8,
    u: F32x8,
    v: F32x8,
    /// Geometry ids as bit patterns, so that lanes can be selected.
    geometry: F32x8,
    /// Primitive ids as bit patterns.
    primitive: F32x8,
}

impl ClosestHit8 {
    /// No hits yet, on rays that end at `t_max`.
    #[inline(always)]
    pub fn new(t_max: F32x8) -> Self {
        let none = F32x8::from(f32::from_bits(NO_GEOMETRY));
        Self { t: t_max, u: F32x8::ZERO, v: F32x8::ZERO, geometry: none, primitive: F32x8::ZERO }
    }

    /// Replaces hits by those of `hits` where these are closer. All of `hits` are with primitive `id` (geometry, primitive)
    /// and must lie in the ray intervals. Of equal `t` the lower id wins.
    #[inline(always)]
    pub fn update(&mut self, &LeafHits { lanes, t, u, v }: &LeafHits, (geometry, primitive): (u32, u32)) {
        let mut nearer = lanes & t.lt(self.t);
        let tied = lanes & t.eq(self.t);
        if tied.any() {
            nearer |= tied & Mask8::from_bits(self.later_than(geometry, primitive));
        }
        self.t = nearer.select(t, self.t);
        self.u = nearer.select(u, self.u);
        self.v = nearer.select(v, self.v);
        self.geometry = nearer.select(F32x8::from(f32::from_bits(geometry)), self.geometry);
        self.primitive = nearer.select(F32x8::from(f32::from_bits(primitive)), self.primitive);
    }

    /// Returns the lanes whose current hit has a higher id than the given one.
    #[cold]
    fn later_than(&self, geometry: u32, primitive: u32) -> u8 {
        (0..8).filter(|&i| (geometry, primitive) < self.id(i)).fold(0, |bits, i| bits | 1 << i)
    }

    fn id(&self, lane: usize) -> (u32, u32) {
        (self.geometry.lane(lane).to_bits(), self.primitive.lane(lane).to_bits())
    }

    /// The closest hit in lane `i`, for a kernel that traces its ray alone.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> ClosestHit {
        let (geometry, primitive) = self.id(i);
        ClosestHit { t: self.t.lane(i), u: self.u.lane(i), v: self.v.lane(i), geometry, primitive }
    }

    /// Puts a closest hit into lane `i`.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, hit: &ClosestHit) {
        self.t.set_lane(i, hit.t);
        self.u.set_lane(i, hit.u);
        self.v.set_lane(i, hit.v);
        self.geometry.set_lane(i, f32::from_bits(hit.geometry));
        self.primitive.set_lane(i, f32::from_bits(hit.primitive));
    }

    /// Writes the hits, or misses, into `lanes` of `hits`.
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

    /// Case TR-03 of the catalogue.
    #[test]
    fn of_equal_hits_the_lower_id_stays_whichever_comes_first() {
        for ids in [[(0, 5), (1, 0)], [(2, 3), (2, 4)]] {
            for order in [[0, 1], [1, 0]] {
                let mut eight = ClosestHit8::new(F32x8::from(2.0));
                let mut one = eight.lane(0);
                for (geometry, primitive) in order.map(|i: usize| ids[i]) {
                    let t = F32x8::ONE;
                    eight.update(&LeafHits { lanes: Mask8::ALL, t, u: t, v: t }, (geometry, primitive));
                    one.update(
                        &LeafHits { lanes: Mask8::from_bits(1), t, u: t, v: t },
                        &Tags::new([(geometry, primitive, 1)].into_iter()),
                    );
                }
                assert_eq!(one.hit().id(), (0, ids[0].0, ids[0].1));
                assert!((0..8).all(|i| eight.lane(i).hit() == one.hit()));
            }
        }
    }
}
