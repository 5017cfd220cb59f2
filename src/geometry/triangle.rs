//! The watertight ray/triangle test of Woop, Benthin & Wald (JCGT 2013). One text serves one ray and one triangle, one ray and
//! eight triangles, and eight rays and one triangle. All of them give a lane the same bits.
//!
//! A shear turns the ray into the axis of its longest direction component. Three signed edge functions then tell on which
//! side of each edge it passes. They are differences of two products. Two triangles that share an edge get exactly opposite
//! values. A value that is not zero has the correct sign, since rounding is monotone. If a value is zero, or so small that it
//! may have lost digits to underflow, `f64` decides, in which these products are exact. So sheared corners are classified
//! without error, and every ray through a shared edge or corner hits a triangle.
//!
//! `t` is an average of the corners' parameters with non-negative weights, clamped to the interval in which the ray is inside
//! the triangle's box. So `t` lies within the triangle's extent, however thin the triangle is.

use glam::Vec3;

use super::ray::Ray;
use super::slab::{SlabRay, grown, upper_end};
use crate::math::{Real, Vector3};

/// Sums of edge functions below this value may have lost digits to underflow: 2^-100.
const SMALL_SUM: f64 = 7.888_609_052_210_118e-31;

/// Reciprocals of sums below [`SMALL_SUM`] are above this value, however they are rounded: 2^99.
const LARGE_SCALE: f64 = 6.338_253_001_141_147e29;

/// Distance beyond the ray interval at which a well-shaped triangle is rejected early, relative to the distance of its
/// farthest corner: 2^-17.
const BEYOND: f64 = 1.0 / 131_072.0;

/// The longest axis of a direction, x before y before z among equals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis<M> {
    /// True if it is x.
    pub is_x: M,
    /// True if it is y.
    pub is_y: M,
}

impl<M: Copy> Axis<M> {
    /// Turns the axes cyclically so that the longest one is last.
    #[inline(always)]
    pub fn turn<R: Real<Mask = M>>(&self, v: Vector3<R>) -> Vector3<R> {
        let pick = |x, y, z| R::select(self.is_x, x, R::select(self.is_y, y, z));
        Vector3::new(pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z))
    }
}

/// A ray prepared for the test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay<R> {
    /// Origin, with its axes turned by [`Axis::turn`].
    pub origin: Vector3<R>,
    /// Negated slopes of the direction: first and second component over the last.
    pub shear: (R, R),
    /// The longest component of the direction.
    pub dz: R,
}

/// The corners of a triangle seen along the ray, and its edge functions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges<R> {
    /// Corners relative to the ray's origin; x and y sheared, z not.
    pub corners: [Vector3<R>; 3],
    /// Value of the edge function opposite each corner.
    value: [R; 3],
}

/// Barycentric weights of the corners, before the division by the direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights<R: Real> {
    /// Reciprocal of the sum of the edge functions.
    scale: R,
    /// Weight of the second corner.
    u: R,
    /// Weight of the third corner.
    v: R,
    /// Ray parameter times the longest component of the direction.
    z: R,
    /// Lanes that only [`Edges::exact`] can decide.
    doubtful: R::Mask,
}

/// The solution of the intersection: `t`, `u` and `v`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solution<R: Real> {
    /// Ray parameter.
    pub t: R,
    /// Weight of the second corner.
    pub u: R,
    /// Weight of the third corner.
    pub v: R,
    /// Lanes that only [`Edges::exact`] can decide.
    pub doubtful: R::Mask,
}

impl<R: Real> ShearedRay<R> {
    /// Prepares a ray. Also returns the longest axis of the direction.
    #[inline(always)]
    pub fn new(origin: Vector3<R>, dir: Vector3<R>) -> (Self, Axis<R::Mask>) {
        Self::by(origin, dir, |a, b| a / b)
    }

    /// As [`ShearedRay::new`], with quotients computed by `quotient`.
    #[inline(always)]
    pub fn by(origin: Vector3<R>, dir: Vector3<R>, quotient: impl Fn(R, R) -> R) -> (Self, Axis<R::Mask>) {
        let d = dir.abs();
        let is_x = d.x.ge(d.y) & d.x.ge(d.z);
        let axis = Axis { is_x, is_y: !is_x & d.y.ge(d.z) };
        let dir = axis.turn(dir);
        (Self { origin: axis.turn(origin), shear: (-quotient(dir.x, dir.z), -quotient(dir.y, dir.z)), dz: dir.z }, axis)
    }

    /// The edge functions of a triangle. The axes of its corners are turned by [`Axis::turn`].
    #[inline(always)]
    pub fn edges(&self, corners: &[Vector3<R>; 3]) -> Edges<R> {
        let seen = |p: Vector3<R>| {
            let p = p - self.origin;
            Vector3::new(self.shear.0.fma(p.z, p.x), self.shear.1.fma(p.z, p.y), p.z)
        };
        let (a, b, c) = (seen(corners[0]), seen(corners[1]), seen(corners[2]));
        let value = [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x];
        Edges { corners: [a, b, c], value }
    }
}

impl<R: Real> SlabRay<R> {
    /// Clamps `t` to the interval in which the ray is inside the grown box of a triangle. The mask is false if the ray
    /// misses the box.
    #[inline(always)]
    pub fn limit_to_triangle(&self, corners: &[Vector3<R>; 3], t: R) -> (R, R::Mask) {
        let (lo, hi) = grown_box(corners);
        self.limit(lo, hi, t)
    }
}

/// The bounding box of a triangle, grown by a few ulps ([`grown`]).
#[inline(always)]
pub(crate) fn grown_box<R: Real>(corners: &[Vector3<R>; 3]) -> (Vector3<R>, Vector3<R>) {
    let [a, b, c] = *corners;
    let least = |a: R, b: R, c: R| a.min_or(b.min_or(c));
    let most = |a: R, b: R, c: R| a.max_or(b.max_or(c));
    let lo = Vector3::new(least(a.x, b.x, c.x), least(a.y, b.y, c.y), least(a.z, b.z, c.z));
    let hi = Vector3::new(most(a.x, b.x, c.x), most(a.y, b.y, c.y), most(a.z, b.z, c.z));
    grown(lo, hi)
}

impl<R: Real> Edges<R> {
    /// Returns false in lanes whose edge functions exclude a hit.
    #[inline(always)]
    pub fn may_hit(&self) -> R::Mask {
        let [u, v, w] = self.value;
        u.min_or(v.min_or(w)).ge(R::zero()) | u.max_or(v.max_or(w)).le(R::zero())
    }

    /// Barycentric weights, for lanes in which [`Edges::may_hit`] is true.
    #[inline(always)]
    pub fn weigh(&self) -> Weights<R> {
        self.weigh_by(|x| R::one() / x)
    }

    /// As [`Edges::weigh`], with reciprocals computed by `reciprocal`.
    #[inline(always)]
    pub fn weigh_by(&self, reciprocal: impl Fn(R) -> R) -> Weights<R> {
        let [eu, ev, ew] = self.value;
        let sum = eu + ev + ew;
        let least = eu.least_magnitude(ev).least_magnitude(ew);
        let doubtful = least.eq(R::zero()) | sum.abs().lt(R::splat(SMALL_SUM));
        let scale = reciprocal(sum);
        let (first, u, v) = (eu * scale, ev * scale, ew * scale);
        let [a, b, c] = self.corners;
        Weights { scale, u, v, z: first.fma(a.z, u.fma(b.z, v * c.z)), doubtful }
    }

    /// Returns false if `t` certainly lies outside `t_min..=t_max`, for lanes in which [`Edges::may_hit`] is true. This rejects
    /// triangles before any division by the direction.
    ///
    /// The sheared corners are classified without error. So some point of the triangle lies on the ray, at `z*` along its
    /// longest axis. The interval inside the box, to which `t` is clamped, contains that point except for 8 u (`WIDEN` in
    /// [`super::slab`]).
    ///
    /// The `z` of [`Edges::weigh`] differs from `z*` because its weights have errors. Each edge function has an error of at
    /// most 4 u of `most`, which no product in it exceeds. So `z` differs from `z*` by at most 12 u `most` over the sum, times
    /// twice the farthest corner's distance. The other roundings add 6 u of that distance. The bound used is 128 u of both.
    ///
    /// The margin covers the error of the sum, too. If `most` exceeds the sum by so much that it does not, the bound is so
    /// large that no triangle is rejected. Neither is one whose sum may have lost digits to underflow. An edge function of
    /// zero has no larger error than the others.
    #[inline(always)]
    pub fn may_lie_within(&self, weights: &Weights<R>, ray: &ShearedRay<R>, t_min: R, t_max: R) -> R::Mask {
        let [a, b, c] = &self.corners;
        let largest = |p: R, q: R, r: R| p.greatest_magnitude(q).greatest_magnitude(r);
        let most = largest(a.x, b.x, c.x) * largest(a.y, b.y, c.y);
        let far = a.z.greatest_magnitude(b.z).greatest_magnitude(c.z);
        let share = most.fma(weights.scale.abs(), R::one());
        let room = (far * R::splat(BEYOND)).fma(share, R::splat(f64::from(f32::MIN_POSITIVE)));
        let (start, end) = (t_min * ray.dz, t_max * ray.dz);
        let below = (weights.z + room).lt(start.min_or(end));
        let above = start.max_or(end).lt(weights.z - room);
        !(below | above) | R::splat(LARGE_SCALE).lt(weights.scale.abs())
    }
}

impl<R: Real> Weights<R> {
    /// Solves for `t`, `u` and `v`.
    #[inline(always)]
    pub fn solve(&self, ray: &ShearedRay<R>) -> Solution<R> {
        self.solve_by(ray, |a, b| a / b)
    }

    /// As [`Weights::solve`], with quotients computed by `quotient`.
    #[inline(always)]
    pub fn solve_by(&self, ray: &ShearedRay<R>, quotient: impl Fn(R, R) -> R) -> Solution<R> {
        // `v` is at most what `u` leaves, so that 1 - u - v is never negative.
        let u = self.u.min_or(R::one());
        let v = self.v.min_or(R::one() - u);
        Solution { t: quotient(self.z, ray.dz), u, v, doubtful: self.doubtful }
    }
}

impl Edges<f32> {
    /// Decides in `f64`, in which the edge functions are exact. Returns `t`, `u` and `v` of a hit.
    #[cold]
    #[inline(never)]
    pub fn exact(&self, dz: f32) -> Option<(f32, f32, f32)> {
        let [a, b, c] = self.corners.map(|p| Vector3::new(f64::from(p.x), f64::from(p.y), f64::from(p.z)));
        let (eu, ev, ew) = (c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
        let same_side = (eu >= 0.0 && ev >= 0.0 && ew >= 0.0) || (eu <= 0.0 && ev <= 0.0 && ew <= 0.0);
        let sum = eu + ev + ew;
        if !same_side || sum == 0.0 {
            return None;
        }
        let t = (eu * a.z + ev * b.z + ew * c.z) / sum / f64::from(dz);
        // The zero on the right turns -0 into 0.
        let weight = |e: f64| ((e / sum) as f32).max_or(0.0);
        let u = weight(ev).min_or(1.0);
        Some((t as f32, u, weight(ew).min_or(1.0 - u)))
    }
}

impl<R: Real> Edges<R> {
    /// Extracts one lane by `lane`.
    #[inline(always)]
    pub fn map(&self, lane: impl Fn(R) -> f32) -> Edges<f32> {
        Edges {
            corners: self.corners.map(|p| Vector3::new(lane(p.x), lane(p.y), lane(p.z))),
            value: self.value.map(lane),
        }
    }
}

/// Intersects `ray` with a triangle, on either face. Returns `t`, the weight `u` of the second corner and the weight `v` of the
/// third.
///
/// This scalar test defines the eight-wide kernels.
#[must_use]
pub fn intersect(ray: &Ray, corners: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let t_max = upper_end(ray)?;
    let (origin, dir) = (ray.origin.into(), ray.dir.into());
    let (sheared, axis) = ShearedRay::<f32>::new(origin, dir);
    let corners = corners.map(Into::into);
    let edges = sheared.edges(&corners.map(|p| axis.turn(p)));
    if !edges.may_hit() {
        return None;
    }
    let solved = edges.weigh().solve(&sheared);
    let (t, u, v) = if solved.doubtful { edges.exact(sheared.dz)? } else { (solved.t, solved.u, solved.v) };
    let (t, crossed) = SlabRay::<f32>::new(origin, dir).limit_to_triangle(&corners, t);
    (crossed && ray.t_min < t && t <= t_max).then_some((t, u, v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::slab::T_LIMIT;

    fn random(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*state >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    fn point(state: &mut u32) -> Vec3 {
        Vec3::new(random(state), random(state), random(state))
    }

    #[test]
    fn weights_belong_to_the_second_and_third_corner() {
        let corners = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(8.0, 0.0, 2.0), Vec3::new(0.0, 4.0, 2.0)];
        let ray = Ray::new(Vec3::new(2.0, 0.5, 0.0), Vec3::Z * 0.5);
        assert_eq!(intersect(&ray, corners), Some((4.0, 0.25, 0.125)));
        for k in 0..3 {
            let at = Ray::new(corners[k] - Vec3::Z, Vec3::Z);
            let weights = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][k];
            assert_eq!(intersect(&at, corners), Some((1.0, weights.0, weights.1)));
        }
    }

    /// Case RT-07 of the catalogue.
    #[test]
    fn a_triangle_seen_from_its_edge_is_missed() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(intersect(&Ray::new(Vec3::new(-1.0, 0.25, 0.0), Vec3::X), corners), None);
        assert_eq!(intersect(&Ray::new(Vec3::new(-1.0, 0.0, 0.0), Vec3::X), corners), None);
    }

    /// Case RT-05 of the catalogue.
    #[test]
    fn coinciding_corners_are_missed_and_corners_in_line_are_no_wider_than_rounding() {
        let (a, b) = (Vec3::new(1.0, 1.0, 5.0), Vec3::new(2.0, -1.0, 5.0));
        for target in [a, b, a * 0.5 + b * 0.5, a * 0.25 + b * 0.75] {
            let ray = Ray::new(Vec3::ZERO, target);
            for corners in [[a, a, b], [a, b, a], [b, a, a], [a, a, a]] {
                assert_eq!(intersect(&ray, corners), None, "{corners:?}");
            }
            // Such a one may be hit, since it may hold the edges of its neighbours, but only where it is.
            if let Some((t, u, v)) = intersect(&ray, [a, b, b * 2.0 - a]) {
                assert!((t - 1.0).abs() < 1e-6 && u >= 0.0 && v >= 0.0 && u + v <= 1.0);
            }
            let aside = Ray::new(Vec3::ZERO, target + Vec3::new(0.02, 0.01, 0.0) * 1e-3);
            assert_eq!(intersect(&aside, [a, b, b * 2.0 - a]), None);
        }
    }

    /// Case RT-06 of the catalogue.
    #[test]
    fn the_bad_triangle_that_pbrt_recorded_is_missed() {
        // pbrt-v4, shapes_test.cpp, Triangle.BadCases.
        let of = |x: f64, y: f64, z: f64| glam::DVec3::new(x, y, z).as_vec3();
        let corners = [-79.049_614, -87.092_269_9, -79.209_014_9].map(|y| of(-1_113.454_59, y, -56.243_190_8));
        let origin = of(-1_081.479_25, 99.999_954_2, 87.770_111_1);
        let ray = Ray { t_max: 0.9999, ..Ray::new(origin, of(-32.107_299_8, -183.355_865, -144.607_635)) };
        assert_eq!(intersect(&ray, corners), None);
    }

    /// However thin the triangle, and whatever its box makes of `t`.
    #[test]
    fn what_is_met_within_the_interval_is_never_left_out_unsolved() {
        let mut state = 11;
        let mut hits = 0;
        for i in 0..300_000 {
            let (a, b) = (point(&mut state), point(&mut state));
            let c = a.lerp(b, random(&mut state)) + point(&mut state) * 10_f32.powi(-(i % 9));
            let corners = if i % 2 == 0 { [a, b, c] } else { [c * 1e-3, a * 1e-3, b * 1e-3] };
            let target =
                corners[0].lerp(corners[1].lerp(corners[2], random(&mut state).abs()), random(&mut state).abs());
            let origin = if i % 3 == 0 { target } else { point(&mut state) * 3.0 };
            let dir = if i % 3 == 0 { point(&mut state) } else { target - origin };
            let ray = Ray { t_min: -T_LIMIT, ..Ray::new(origin, dir) };
            let Some((t, ..)) = intersect(&ray, corners) else { continue };
            hits += 1;
            let (sheared, axis) = ShearedRay::<f32>::new(origin.into(), dir.into());
            let edges = sheared.edges(&corners.map(|p| axis.turn(p.into())));
            let within = |t_min, t_max| edges.may_lie_within(&edges.weigh(), &sheared, t_min, t_max);
            assert!(within(t.next_down(), t) && within(t.next_down(), f32::INFINITY), "{ray:?} {corners:?}");
        }
        assert!(hits > 30_000, "{hits}");
    }

    /// Cases RT-12, RT-13 of the catalogue.
    #[test]
    fn turning_or_mirroring_the_corners_changes_no_verdict() {
        let mut state = 3;
        let mut hits = 0;
        for i in 0..200_000 {
            let corners = [point(&mut state), point(&mut state), point(&mut state)];
            let origin = point(&mut state) * 3.0;
            // Through an edge, through a corner, or anywhere.
            let target = match i % 3 {
                0 => corners[0] + (corners[1] - corners[0]) * random(&mut state).abs(),
                1 => corners[2],
                _ => point(&mut state),
            };
            let ray = Ray::new(origin, target - origin);
            let first = intersect(&ray, corners);
            let [a, b, c] = corners;
            for same in [[b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]] {
                let other = intersect(&ray, same);
                assert_eq!(first.is_some(), other.is_some(), "{ray:?} {corners:?}");
            }
            if let (Some((t, u, v)), Some((t2, v2, u2))) = (first, intersect(&ray, [a, c, b])) {
                let near = |x: f32, y: f32, scale: f32| (x - y).abs() <= 4.0 * f32::EPSILON * scale;
                assert!(near(t, t2, t.abs().max(6.0 / ray.dir.length())) && near(u, u2, 1.0) && near(v, v2, 1.0));
                hits += 1;
            }
        }
        assert!(hits > 50_000, "{hits}");
    }

    /// Cases RT-04, RT-11 of the catalogue.
    #[test]
    fn the_parameter_of_a_sliver_lies_among_those_of_its_corners() {
        let mut state = 5;
        let mut hits = 0;
        for i in 0..400_000 {
            // Needles a millionth as thick as they are long, and rays almost along them.
            let (a, along) = (point(&mut state) * 10.0, point(&mut state) * 100.0);
            let b = a + along;
            let c = a + along * random(&mut state).abs() + point(&mut state) * 1e-4;
            let target = a + along * random(&mut state).abs();
            let aside = if i % 2 == 0 { point(&mut state) } else { along * 0.5 + point(&mut state) * 1e-3 };
            let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(target - aside * 4.0, aside) };
            let Some((t, u, v)) = intersect(&ray, [a, b, c]) else { continue };
            hits += 1;
            assert!((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v) && 1.0 - u - v >= 0.0);
            let longest = [0, 1, 2].into_iter().max_by(|&j, &k| aside[j].abs().total_cmp(&aside[k].abs())).unwrap();
            let of = |p: Vec3| (f64::from(p[longest]) - f64::from(ray.origin[longest])) / f64::from(aside[longest]);
            let (t, [ta, tb, tc]) = (f64::from(t), [of(a), of(b), of(c)]);
            let slack = 8.0 * f64::from(f32::EPSILON) * ta.abs().max(tb.abs()).max(tc.abs());
            assert!(ta.min(tb).min(tc) - slack <= t && t <= ta.max(tb).max(tc) + slack, "{t}: {ta} {tb} {tc}");
        }
        assert!(hits > 1000, "{hits}");
    }

    /// Case RT-14 of the catalogue.
    #[test]
    fn triangles_of_any_size_are_hit_in_their_middle() {
        for exponent in -37..=17 {
            let s = 10_f32.powi(exponent);
            let corners = [Vec3::new(-s, -s, s), Vec3::new(s, -s, s), Vec3::new(0.0, s, s)];
            let (t, u, v) = intersect(&Ray::new(Vec3::ZERO, Vec3::Z), corners).expect("straight ahead");
            assert!((t / s - 1.0).abs() < 1e-6 && (u - 0.25).abs() < 1e-6 && (v - 0.5).abs() < 1e-6, "1e{exponent}");
        }
    }
}
