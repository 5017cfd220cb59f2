//! Exact spheres.

use glam::Vec3;

use super::slab::{SlabRay, grown};
use super::{Aabb, COORDINATE_LIMIT};
use crate::math::{Real, Vector3, next_down, next_up};

/// A sphere; its outside is the side away from the centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, in scene units.
    pub centre: Vec3,
    /// Radius, above zero, in scene units.
    pub radius: f32,
}

impl Sphere {
    /// A box that holds it, rounded outwards.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let grow = |p: Vec3, f: fn(f32) -> f32| Vec3::new(f(p.x), f(p.y), f(p.z));
        Aabb { lo: grow(self.centre - self.radius, next_down), hi: grow(self.centre + self.radius, next_up) }
    }

    /// Whether rays can meet it: a radius above zero, and all of it within [`COORDINATE_LIMIT`].
    #[must_use]
    pub fn is_usable(&self) -> bool {
        let b = self.bounds();
        let limit = Vec3::splat(COORDINATE_LIMIT);
        self.radius > 0.0 && b.lo.abs().cmple(limit).all() && b.hi.abs().cmple(limit).all()
    }
}

/// The box that [`intersect`] limits its hits to, and that hierarchies hold.
#[inline(always)]
pub(crate) fn grown_bounds<R: Real>(centre: Vector3<R>, radius: R) -> (Vector3<R>, Vector3<R>) {
    let r = Vector3::all(radius);
    grown(centre - r, centre + r)
}

/// The first meeting of ray and sphere with `t_min < t <= t_max`: the one on the way in, else the one on the way
/// out. One text for one ray and for eight, and for either side in eight lanes.
///
/// The discriminant comes from the distance between the line and the centre, and the smaller root from the larger,
/// so that neither a far start nor one on the surface cancels (Haines, Günther & Akenine-Möller, "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems 2019, eq. 7-8). Lengths of `dir` whose square leaves
/// the range of `f32` meet nothing.
#[inline(always)]
pub(crate) fn intersect<R: Real>(
    slab: &SlabRay<R>,
    dir: Vector3<R>,
    centre: Vector3<R>,
    radius: R,
    t_min: R,
    t_max: R,
) -> (R, R::Mask) {
    let f = slab.origin - centre;
    let a = dir.length_squared();
    let b = -f.dot(dir);
    let from_centre = dir.fma(b / a, f);
    let discriminant = radius * radius - from_centre.length_squared();
    let root = (discriminant.safe_sqrt() * a.sqrt()).abs();
    let q = R::select(b.lt(R::zero()), b - root, b + root);
    let (c_over_q, q_over_a) = ((f.length_squared() - radius * radius) / q, q / a);
    let (lo, hi) = grown_bounds(centre, radius);
    let (first, crossed) = slab.limit(lo, hi, c_over_q.min_or(q_over_a));
    let (second, _) = slab.limit(lo, hi, c_over_q.max_or(q_over_a));
    let seen = |t: R| t_min.lt(t) & t.le(t_max);
    let t = R::select(seen(first), first, second);
    (t, seen(t) & crossed & discriminant.ge(R::zero()))
}
