//! The test of the renderer.

use super::exact::{corners_of, meet_sheared, settle};
use super::formula::{Meeting, TriangleTest};
use super::lanes::Lanes;
use crate::geometry::slab::SlabRay;
use crate::geometry::triangle::{Axis, ShearedRay};
use crate::math::{LaneMask, Real, Vector3};
use crate::simd::Reciprocal;

/// The watertight test of Woop, Benthin & Wald ("Watertight ray/triangle intersection", JCGT 2(1), 2013), as in
/// [`crate::geometry::intersect_triangle`] and in the native hierarchy. `f64` decides if an edge function is zero or may have
/// lost digits to underflow. `t` is clamped to the interval in which the ray is inside the triangle's box.
///
/// Every ray through a shared edge or corner of a closed mesh hits a triangle. Known failures: none of that kind. The sheared
/// corners are rounded, so that the hit may lie up to 4 u of the ray's length beside the exact triangle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watertight;

/// A ray prepared for [`Watertight`].
#[derive(Clone, Copy, Debug)]
pub struct WatertightRay<R: Real> {
    sheared: ShearedRay<R>,
    axis: Axis<R::Mask>,
    slab: SlabRay<R>,
}

impl TriangleTest for Watertight {
    type Ray<R: Lanes> = WatertightRay<R>;

    #[inline(always)]
    fn prepare_by<R: Lanes, D: Reciprocal>(origin: Vector3<R>, dir: Vector3<R>) -> Self::Ray<R> {
        let (sheared, axis) = ShearedRay::by(origin, dir, D::quotient);
        WatertightRay { sheared, axis, slab: SlabRay::by(origin, dir, D::of) }
    }

    #[inline(always)]
    fn meet_by<R: Lanes, D: Reciprocal>(ray: &Self::Ray<R>, corners: &[Vector3<R>; 3]) -> Meeting<R> {
        let edges = ray.sheared.edges(&corners.map(|p| ray.axis.turn(p)));
        let hit = edges.may_hit();
        let zero = R::zero();
        let none = R::mask(0);
        if !hit.any() {
            return Meeting { hit, t: zero, u: zero, v: zero, settled: none };
        }
        let solved = edges.weigh_by(D::of).solve_by(&ray.sheared, D::quotient);
        let mut meeting = Meeting { hit, t: solved.t, u: solved.u, v: solved.v, settled: none };
        let doubtful = solved.doubtful & hit;
        if doubtful.any() {
            settle(&mut meeting, doubtful, |i| meet_sheared(corners_of(&edges.corners, i), ray.sheared.dz.lane(i)));
            // `v` is at most what `u` leaves, as rounded.
            meeting.v = meeting.v.min_or(R::one() - meeting.u);
        }
        let (t, crossed) = ray.slab.limit_to_triangle(corners, meeting.t);
        Meeting { hit: meeting.hit & crossed, t, ..meeting }
    }
}
