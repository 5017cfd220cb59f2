//! Decisions in `f64` for lanes that a test cannot decide.

use super::formula::{Meeting, same_side};
use super::lanes::Lanes;
use crate::math::Vector3;

/// Replaces the lanes in `asked` of a meeting by the decisions of `f64`.
#[cold]
#[inline(never)]
pub(super) fn settle<R: Lanes>(
    meeting: &mut Meeting<R>,
    asked: R::Mask,
    verdict: impl Fn(usize) -> Option<(f64, f64, f64)>,
) {
    let asked = R::bits(asked);
    let mut hit = R::bits(meeting.hit) & !asked;
    for i in (0..R::COUNT).filter(|i| asked >> i & 1 != 0) {
        if let Some((t, u, v)) = verdict(i) {
            hit |= 1 << i;
            meeting.t.set_lane(i, t);
            meeting.u.set_lane(i, u);
            meeting.v.set_lane(i, v);
        }
    }
    meeting.hit = R::mask(hit);
    meeting.settled = R::mask(asked);
}

/// The watertight test for sheared corners, with edge functions whose sign is always correct. Rounding is monotone, so that
/// rounded products have the order of the exact ones. If they are equal, their rounding errors decide.
pub(super) fn meet_sheared([a, b, c]: [Vector3<f64>; 3], dz: f64) -> Option<(f64, f64, f64)> {
    let edge = |p: Vector3<f64>, q: Vector3<f64>| {
        let (first, second) = (p.x * q.y, p.y * q.x);
        (first - second) + (p.x.mul_add(q.y, -first) - p.y.mul_add(q.x, -second))
    };
    let edges = [edge(c, b), edge(a, c), edge(b, a)];
    let whole: f64 = edges.iter().sum();
    if !same_side(edges) || whole == 0.0 || whole.is_nan() {
        return None;
    }
    let [_, u, v] = edges.map(|e| (e / whole).clamp(0.0, 1.0));
    let t = (edges[0] * a.z + edges[1] * b.z + edges[2] * c.z) / whole / dz;
    t.is_finite().then_some((t, u, v))
}

/// Lane `i` of three corners.
#[inline(always)]
pub(super) fn corners_of<R: Lanes>(corners: &[Vector3<R>; 3], i: usize) -> [Vector3<f64>; 3] {
    corners.map(|p| Vector3::new(p.x.lane(i), p.y.lane(i), p.z.lane(i)))
}
