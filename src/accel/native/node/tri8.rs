//! Leaves of triangles: one ray against eight triangles, or eight rays against each of them.

use super::super::ray::lane_ray::LaneRay;
use super::super::ray::packet8::{LeafPacket8, TURNED_AXES};
use super::closest_hit::{ClosestHit8, LeafHits};
use super::leaf::{Leaf, LeafQuery};
use super::tags::Tags;
use crate::geometry::Aabb8;
use crate::geometry::triangle::{Edges, ShearedRay, Solution, grown_box};
use crate::math::{LaneMask, Real};
use crate::simd::{F32x8, Mask8, Vec3x8, set_lanes};

/// Up to eight triangles in structure-of-arrays. Empty slots hold NaN, which no ray hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Tri8 {
    /// Positions, by corner and axis.
    corners: [[F32x8; 3]; 3],
    tags: Tags,
}

const _: () = assert!(size_of::<Tri8>() == 384);

/// Tests eight lanes, as [`crate::geometry::triangle::intersect`] tests one. Returns the lanes of `admitted` with a hit.
///
/// The axes of the corners in `turned` are in the order of the ray's longest axis. `limit` clamps `t` to the triangle's
/// box. `t_min` and `t_max` are the ray intervals.
///
/// `EARLY` returns before any division if no lane passes inside the edges. That pays for camera rays side by side, which
/// hit or miss a triangle together. For other rays one branch is faster than two.
#[inline(always)]
fn intersect<const EARLY: bool>(
    ray: &ShearedRay<F32x8>,
    turned: &[Vec3x8; 3],
    limit: impl FnOnce(F32x8) -> (F32x8, Mask8),
    (t_min, t_max): (F32x8, F32x8),
    admitted: impl FnOnce() -> u8,
) -> Option<LeafHits> {
    let edges = ray.edges(turned);
    let inside = edges.may_hit();
    if EARLY && inside.bits() == 0 {
        return None;
    }
    let weights = edges.weigh();
    // One branch that is rarely taken, instead of one at every step: the CPU overlaps consecutive rays as long as it
    // predicts the branch correctly.
    let may_hit = (inside & edges.may_lie_within(&weights, ray, t_min, t_max)).bits();
    if may_hit == 0 {
        return None;
    }
    let candidates = may_hit & admitted();
    if candidates == 0 {
        return None;
    }
    let mut solved = weights.solve(ray);
    let mut lanes = candidates;
    let doubtful = solved.doubtful.bits() & candidates;
    if doubtful != 0 {
        lanes &= !solve_exactly(&edges, &mut solved, ray, doubtful);
    }
    let (t, crossed) = limit(solved.t);
    let lanes = Mask8::from_bits(lanes) & crossed & t_min.lt(t) & t.le(t_max);
    lanes.any().then_some(LeafHits { lanes, t, u: solved.u, v: solved.v })
}

/// Replaces the solutions of doubtful lanes by exact ones. Returns the doubtful lanes that miss.
#[cold]
#[inline(never)]
fn solve_exactly(edges: &Edges<F32x8>, solved: &mut Solution<F32x8>, ray: &ShearedRay<F32x8>, doubtful: u8) -> u8 {
    let mut missed = 0;
    for i in set_lanes(doubtful) {
        match edges.map(|x| x.lane(i)).exact(ray.dz.lane(i)) {
            Some((t, u, v)) => {
                solved.t.set_lane(i, t);
                solved.u.set_lane(i, u);
                solved.v.set_lane(i, v);
            }
            None => missed |= 1 << i,
        }
    }
    missed
}

impl Tri8 {
    /// A leaf of at most eight triangles, given as corners, geometry id, primitive id and mask.
    pub fn new(triangles: &[([glam::Vec3; 3], u32, u32, u8)]) -> Self {
        let mut corners = [[F32x8::from(f32::NAN); 3]; 3];
        for (i, (points, ..)) in triangles.iter().enumerate() {
            for (corner, point) in corners.iter_mut().zip(points) {
                for (axis, x) in corner.iter_mut().zip(point.to_array()) {
                    axis.set_lane(i, x);
                }
            }
        }
        Self {
            corners,
            tags: Tags::new(triangles.iter().map(|&(_, geometry, primitive, mask)| (geometry, primitive, mask))),
        }
    }

    /// All bits of the leaf.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        self.corners.iter().flatten().flat_map(|x| x.to_array()).map(f32::to_bits).chain(self.tags.words())
    }

    /// Corners of the eight triangles.
    #[inline(always)]
    pub fn corners(&self) -> [Vec3x8; 3] {
        self.corners_along([0, 1, 2])
    }

    /// Corners of the eight triangles with their axes in the given order.
    #[inline(always)]
    fn corners_along(&self, [x, y, z]: [usize; 3]) -> [Vec3x8; 3] {
        // Written out: a `map` over these arrays goes through memory.
        let [a, b, c] = &self.corners;
        [Vec3x8::new(a[x], a[y], a[z]), Vec3x8::new(b[x], b[y], b[z]), Vec3x8::new(c[x], c[y], c[z])]
    }

    /// Corners of the triangle in slot `i`.
    pub fn triangle(&self, i: usize) -> [glam::Vec3; 3] {
        self.corners.map(|c| glam::Vec3::new(c[0].lane(i), c[1].lane(i), c[2].lane(i)))
    }

    /// Tests rays of a packet against the triangles in `slots`, one triangle after the other. Calls `found` with each slot
    /// that has hits. `found` returns the new limits of the rays, or `None` to stop.
    #[inline(always)]
    fn intersect_packet<const EARLY: bool>(
        &self,
        rays: &LeafPacket8,
        query: &LeafQuery,
        slots: u8,
        found: impl FnMut(usize, LeafHits) -> Option<F32x8>,
        t_max: F32x8,
    ) {
        let slots = self.tags.admitted(rays.packet.admits) & slots;
        match rays.common_axis(query.lanes) {
            Some(0) => self.intersect_along::<0, EARLY>(rays, query, slots, found, t_max),
            Some(1) => self.intersect_along::<1, EARLY>(rays, query, slots, found, t_max),
            Some(_) => self.intersect_along::<2, EARLY>(rays, query, slots, found, t_max),
            None => self.intersect_along::<3, EARLY>(rays, query, slots, found, t_max),
        }
    }

    /// As [`Tri8::intersect_packet`] for rays whose longest axis is `LAST`; 3 stands for rays with different longest axes.
    #[inline(always)]
    fn intersect_along<const LAST: usize, const EARLY: bool>(
        &self,
        rays: &LeafPacket8,
        query: &LeafQuery,
        slots: u8,
        mut found: impl FnMut(usize, LeafHits) -> Option<F32x8>,
        mut t_max: F32x8,
    ) {
        for i in set_lanes(slots) {
            let at = |k: usize, axis: usize| F32x8::from(self.corners[k][axis].lane(i));
            let corner = |k: usize| {
                if LAST < 3 {
                    let [x, y, z] = TURNED_AXES[LAST];
                    Vec3x8::new(at(k, x), at(k, y), at(k, z))
                } else {
                    rays.axis.turn(Vec3x8::new(at(k, 0), at(k, 1), at(k, 2)))
                }
            };
            let turned = [corner(0), corner(1), corner(2)];
            // The rays share an octant, so that near planes need no selection by lane.
            let limit = |t: F32x8| {
                let (near, far) = query.boxes.sorted_lane(query.octant, i);
                rays.packet.slab.limit_sorted(near, far, t)
            };
            let hits = intersect::<EARLY>(&rays.sheared, &turned, limit, (rays.packet.t_min, t_max), || query.lanes);
            if let Some(hits) = hits {
                let Some(limit) = found(i, hits) else { return };
                t_max = limit;
            }
        }
    }
}

impl Leaf for Tri8 {
    #[inline(always)]
    fn intersect_ray(&self, ray: &LaneRay, t_max: f32) -> Option<LeafHits> {
        let turned = self.corners_along(ray.axes());
        let limit = |t: F32x8| {
            let (lo, hi) = grown_box(&self.corners());
            let (near, far) = Aabb8::new(lo, hi).sorted(ray.octant);
            ray.slab().limit_sorted(near, far, t)
        };
        let interval = (ray.t_min(), F32x8::from(t_max));
        intersect::<false>(&ray.sheared(), &turned, limit, interval, || self.tags.admitted(ray.admits()))
    }

    #[inline(always)]
    fn tags(&self) -> &Tags {
        &self.tags
    }

    #[inline(always)]
    fn boxes(&self) -> Aabb8 {
        let (lo, hi) = grown_box(&self.corners());
        Aabb8::new(lo, hi)
    }

    #[inline(always)]
    fn closest_packet(&self, rays: &LeafPacket8, query: &LeafQuery, slots: u8, closest: &mut ClosestHit8) {
        let t_max = closest.t;
        let found = |i: usize, hits: LeafHits| {
            closest.update(&hits, (self.tags.geometry[i], self.tags.primitive[i]));
            Some(closest.t)
        };
        self.intersect_packet::<true>(rays, query, slots, found, t_max);
    }

    #[inline(always)]
    fn occluded_packet(&self, rays: &LeafPacket8, query: &LeafQuery, slots: u8, t_max: F32x8) -> u8 {
        let mut blocked = 0;
        let found = |_, hits: LeafHits| {
            blocked |= hits.lanes.bits();
            (blocked != query.lanes).then_some(t_max)
        };
        self.intersect_packet::<false>(rays, query, slots, found, t_max);
        blocked
    }

    fn shadow_area(&self) -> f32 {
        let [a, b, c] = self.corners();
        let areas = ((b - a).cross(c - a).length() * F32x8::from(0.5)).to_array();
        areas[..self.tags.count()].iter().sum()
    }
}
