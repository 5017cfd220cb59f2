//! Leaves of triangles: eight of them for one ray, or each of them for eight rays.

use super::bvh8::Planes;
use super::leaf::{Best8, Leaf, Met, Tags, Towards};
use super::one::One;
use super::rays::{Eight, TURNED};
use crate::geometry::triangle::{Edges, ShearedRay, Solution, grown_box};
use crate::math::{LaneMask, Real};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Up to eight triangles in structure-of-arrays; empty slots hold NaN, which nothing meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Tri8 {
    /// Positions, by corner and axis.
    corners: [[F32x8; 3]; 3],
    tags: Tags,
}

const _: () = assert!(size_of::<Tri8>() == 384);

/// The eight-lane form of [`crate::geometry::triangle::intersect`], for lanes of `admitted`: corners as `turned` for
/// the ray; `limit` keeps `t` within the triangle's box; the rays' intervals are `t_min` and `t_max`.
///
/// `EARLY` ends it before anything is divided where no lane passes inside the edges. That pays for camera rays side by side,
/// which meet a triangle together or pass it together; else one branch is better than two.
#[inline(always)]
fn intersect<const EARLY: bool>(
    ray: &ShearedRay<F32x8>,
    turned: &[Vec3x8; 3],
    limit: impl FnOnce(F32x8) -> (F32x8, Mask8),
    (t_min, t_max): (F32x8, F32x8),
    admitted: impl FnOnce() -> u8,
) -> Option<Met> {
    let edges = ray.edges(turned);
    let inside = edges.may_hit();
    if EARLY && inside.bits() == 0 {
        return None;
    }
    let weights = edges.weigh();
    // One branch that is seldom taken, instead of one at every step: rays overlap in the CPU as far as it guesses right.
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
        lanes &= !settle(&edges, &mut solved, ray, doubtful);
    }
    let (t, crossed) = limit(solved.t);
    let lanes = Mask8::from_bits(lanes) & crossed & t_min.lt(t) & t.le(t_max);
    lanes.any().then_some(Met { lanes, t, u: solved.u, v: solved.v })
}

/// Replaces the solutions of doubtful lanes by exact ones; which of them are misses after all.
#[cold]
#[inline(never)]
fn settle(edges: &Edges<F32x8>, solved: &mut Solution<F32x8>, ray: &ShearedRay<F32x8>, mut doubtful: u8) -> u8 {
    let mut missed = 0;
    while doubtful != 0 {
        let i = doubtful.trailing_zeros() as usize & 7;
        doubtful &= doubtful - 1;
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
    /// From at most eight triangles: corners, geometry, primitive, mask.
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

    /// Every bit of it.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        self.corners.iter().flatten().flat_map(|x| x.to_array()).map(f32::to_bits).chain(self.tags.words())
    }

    /// The corners of all eight.
    pub fn corners(&self) -> [Vec3x8; 3] {
        self.corners.map(|[x, y, z]| Vec3x8::new(x, y, z))
    }

    /// The corners of the triangle in slot `i`.
    pub fn triangle(&self, i: usize) -> [glam::Vec3; 3] {
        self.corners.map(|c| glam::Vec3::new(c[0].lane(i), c[1].lane(i), c[2].lane(i)))
    }

    /// Calls `found` with the hits with each triangle in `slots` that the rays look for; it gives the new limits, or
    /// nothing where it has seen enough.
    #[inline(always)]
    fn meet_eight<const EARLY: bool>(
        &self,
        rays: &Eight,
        to: &Towards,
        slots: u8,
        found: impl FnMut(usize, Met) -> Option<F32x8>,
        t_max: F32x8,
    ) {
        let slots = self.tags.admitted(rays.way.admits) & slots;
        match rays.common_axis(to.lanes) {
            Some(0) => self.meet_along::<0, EARLY>(rays, to, slots, found, t_max),
            Some(1) => self.meet_along::<1, EARLY>(rays, to, slots, found, t_max),
            Some(_) => self.meet_along::<2, EARLY>(rays, to, slots, found, t_max),
            None => self.meet_along::<3, EARLY>(rays, to, slots, found, t_max),
        }
    }

    /// The same for rays whose longest axis is `LAST`, or whose axes differ if it is 3.
    #[inline(always)]
    fn meet_along<const LAST: usize, const EARLY: bool>(
        &self,
        rays: &Eight,
        to: &Towards,
        mut slots: u8,
        mut found: impl FnMut(usize, Met) -> Option<F32x8>,
        mut t_max: F32x8,
    ) {
        while slots != 0 {
            let i = slots.trailing_zeros() as usize & 7;
            slots &= slots - 1;
            let at = |k: usize, axis: usize| F32x8::from(self.corners[k][axis].lane(i));
            let corner = |k: usize| {
                if LAST < 3 {
                    let [x, y, z] = TURNED[LAST];
                    Vec3x8::new(at(k, x), at(k, y), at(k, z))
                } else {
                    rays.axis.turn(Vec3x8::new(at(k, 0), at(k, 1), at(k, 2)))
                }
            };
            let turned = [corner(0), corner(1), corner(2)];
            // The rays share an octant, so that which plane is near needs no choice by lane.
            let limit = |t: F32x8| {
                let near = |axis: usize| F32x8::from(to.boxes[axis][to.octant[axis] & 1].lane(i));
                let far = |axis: usize| F32x8::from(to.boxes[axis][(to.octant[axis] & 1) ^ 1].lane(i));
                let (near, far) = (Vec3x8::new(near(0), near(1), near(2)), Vec3x8::new(far(0), far(1), far(2)));
                rays.way.slab.limit_sorted(near, far, t)
            };
            let met = intersect::<EARLY>(&rays.sheared, &turned, limit, (rays.way.t_min, t_max), || to.lanes);
            if let Some(met) = met {
                let Some(limit) = found(i, met) else { return };
                t_max = limit;
            }
        }
    }
}

impl Leaf for Tri8 {
    #[inline(always)]
    fn meet_one(&self, ray: &One, t_max: f32) -> Option<Met> {
        let [x, y, z] = ray.axes();
        let [a, b, c] = &self.corners;
        let turned = [Vec3x8::new(a[x], a[y], a[z]), Vec3x8::new(b[x], b[y], b[z]), Vec3x8::new(c[x], c[y], c[z])];
        let limit = |t: F32x8| {
            let plain = [Vec3x8::new(a[0], a[1], a[2]), Vec3x8::new(b[0], b[1], b[2]), Vec3x8::new(c[0], c[1], c[2])];
            let (lo, hi) = grown_box(&plain);
            let planes = [[lo.x, hi.x], [lo.y, hi.y], [lo.z, hi.z]];
            let near = |axis: usize| planes[axis][ray.octant[axis] & 1];
            let far = |axis: usize| planes[axis][(ray.octant[axis] & 1) ^ 1];
            let (near, far) = (Vec3x8::new(near(0), near(1), near(2)), Vec3x8::new(far(0), far(1), far(2)));
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
    fn boxes(&self) -> Planes {
        // Spelled out: a `map` over these arrays goes through memory.
        let corner = |k: usize| Vec3x8::new(self.corners[k][0], self.corners[k][1], self.corners[k][2]);
        let (lo, hi) = grown_box(&[corner(0), corner(1), corner(2)]);
        [[lo.x, hi.x], [lo.y, hi.y], [lo.z, hi.z]]
    }

    #[inline(always)]
    fn closest_eight(&self, rays: &Eight, to: &Towards, slots: u8, best: &mut Best8) {
        let t_max = best.t;
        let tags = &self.tags;
        let found = |i: usize, met: Met| {
            best.take(met.lanes, met.t, met.u, met.v, tags.geometry[i], tags.primitive[i]);
            Some(best.t)
        };
        self.meet_eight::<true>(rays, to, slots, found, t_max);
    }

    #[inline(always)]
    fn occluded_eight(&self, rays: &Eight, to: &Towards, slots: u8, t_max: F32x8) -> u8 {
        let mut blocked = 0;
        let found = |_, met: Met| {
            blocked |= met.lanes.bits();
            (blocked != to.lanes).then_some(t_max)
        };
        self.meet_eight::<false>(rays, to, slots, found, t_max);
        blocked
    }

    fn cover(&self) -> f32 {
        let corner = |k: usize| Vec3x8::new(self.corners[k][0], self.corners[k][1], self.corners[k][2]);
        let a = corner(0);
        let areas = ((corner(1) - a).cross(corner(2) - a).length() * F32x8::from(0.5)).to_array();
        areas[..self.tags.count()].iter().sum()
    }

    fn ids(&self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.tags.count()).map(|i| (self.tags.geometry[i], self.tags.primitive[i]))
    }
}
