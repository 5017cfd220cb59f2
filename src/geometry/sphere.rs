//! Exact spheres.

use glam::Vec3;

use super::aabb::Aabb;
use super::limit::COORDINATE_LIMIT;
use super::ray::Ray;
use super::slab::{SlabRay, grown, upper_end};
use crate::math::{Real, Vector3, next_down, next_up};

/// A sphere. Its outside is the side away from the centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, in scene units.
    pub centre: Vec3,
    /// Radius, above zero, in scene units.
    pub radius: f32,
}

impl Sphere {
    /// A bounding box, rounded outwards.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let grow = |p: Vec3, f: fn(f32) -> f32| Vec3::new(f(p.x), f(p.y), f(p.z));
        Aabb { lo: grow(self.centre - self.radius, next_down), hi: grow(self.centre + self.radius, next_up) }
    }

    /// Returns true if rays can hit the sphere: its radius is a normal number above zero, and all of it is within
    /// [`COORDINATE_LIMIT`].
    #[must_use]
    pub fn is_usable(&self) -> bool {
        let b = self.bounds();
        let limit = Vec3::splat(COORDINATE_LIMIT);
        self.radius >= f32::MIN_POSITIVE && b.lo.abs().cmple(limit).all() && b.hi.abs().cmple(limit).all()
    }

    /// Intersects `ray` with the sphere. Returns the `t` of entry, or that of exit if the ray interval begins inside. This
    /// scalar test defines the eight-wide kernels.
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let t_max = upper_end(ray)?;
        let slab = SlabRay::new(ray.origin.into(), ray.dir.into());
        let (t, met) = intersect(&slab, ray.dir.into(), self.centre.into(), self.radius, ray.t_min, t_max);
        met.then_some(t)
    }
}

/// The box that [`intersect`] clamps its hits to, and that hierarchies store.
#[inline(always)]
pub(crate) fn grown_bounds<R: Real>(centre: Vector3<R>, radius: R) -> (Vector3<R>, Vector3<R>) {
    let r = Vector3::all(radius);
    grown(centre - r, centre + r)
}

/// The chord that a sphere cuts out of a line. Lengths are in units of [`Chord::unit`], relative to the centre.
///
/// No digits cancel, however far away the line starts. (Haines, Günther & Akenine-Möller, "Precision Improvements for
/// Ray/Sphere Intersection", Ray Tracing Gems 2019; their equations 7 and 8 leave an error that grows with the squared
/// distance.) The distance of the line from the centre comes from the moment `(origin - centre) x dir`. Its components are
/// correct to 2 unit roundoffs if products are fused. The unit is a power of two near the radius. It causes no rounding and
/// keeps the squares of every radius within the range of `f32`.
#[derive(Clone, Copy, Debug)]
struct Chord<R> {
    /// The power of two at or below the radius, in scene units.
    unit: R,
    /// Cross product of the origin and `dir`.
    moment: Vector3<R>,
    /// Squared half chord times squared length of `dir`; negative if the line misses the sphere.
    discriminant: R,
    /// Square root of the discriminant.
    root: R,
    /// Squared distance of the origin from the centre, minus the squared radius: positive outside.
    outside: R,
    /// The parameter farther from zero, times squared length of `dir`.
    farther: R,
    /// Squared length of `dir`.
    squared: R,
}

impl<R: Real> Chord<R> {
    #[inline(always)]
    fn new(origin: Vector3<R>, dir: Vector3<R>, centre: Vector3<R>, radius: R) -> Self {
        let (unit, scale) = radius.power_of_two();
        let start = (origin - centre) * scale;
        let radius = radius * scale;
        let (squared, within) = (dir.length_squared(), radius * radius);
        let moment = start.cross(dir);
        let discriminant = within.fma(squared, -moment.length_squared());
        let root = discriminant.safe_sqrt();
        let middle = -start.dot(dir);
        let farther = R::select(middle.lt(R::zero()), middle - root, middle + root);
        let outside = start.length_squared() - within;
        Self { unit, moment, discriminant, root, outside, farther, squared }
    }

    /// Parameters of both intersections, the one nearer to zero first.
    #[inline(always)]
    fn parameters(&self) -> (R, R) {
        (self.outside / self.farther * self.unit, self.farther / self.squared * self.unit)
    }
}

/// The outward unit normal at the end of the chord whose parameter is nearer to `t`, computed as [`intersect`] does.
///
/// It is not computed from the point at `t`, which has the rounding error of its distance. The error is at most 12 unit
/// roundoffs divided by the cosine of incidence, if the difference of origin and centre is exact.
#[inline(always)]
pub(crate) fn normal<R: Real>(origin: Vector3<R>, dir: Vector3<R>, centre: Vector3<R>, radius: R, t: R) -> Vector3<R> {
    let chord = Chord::new(origin, dir, centre, radius);
    let (s, e) = chord.parameters();
    let (enter, leave) = (s.min_or(e), s.max_or(e));
    let leaves = (leave - t).abs().lt((enter - t).abs());
    // The foot of the centre on the line, times the squared length of `dir`.
    let foot = dir.cross(chord.moment);
    dir.fma(R::select(leaves, chord.root, -chord.root), foot).normalized()
}

/// Returns the first intersection of ray and sphere with `t_min < t <= t_max`: the entry, else the exit. One text serves one
/// ray and eight lanes, with eight rays or eight spheres.
///
/// The smaller root is computed from the larger one, so that nothing cancels for an origin on the surface. A ray misses if
/// the squared length of `dir` leaves the range of `f32`.
#[inline(always)]
pub(crate) fn intersect<R: Real>(
    slab: &SlabRay<R>,
    dir: Vector3<R>,
    centre: Vector3<R>,
    radius: R,
    t_min: R,
    t_max: R,
) -> (R, R::Mask) {
    let chord = Chord::new(slab.origin, dir, centre, radius);
    let (s, e) = chord.parameters();
    let (lo, hi) = grown_bounds(centre, radius);
    let (first, crossed) = slab.limit(lo, hi, s.min_or(e));
    let (second, _) = slab.limit(lo, hi, s.max_or(e));
    let seen = |t: R| t_min.lt(t) & t.le(t_max);
    let t = R::select(seen(first), first, second);
    (t, seen(t) & crossed & chord.discriminant.ge(R::zero()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Case SP-02 of the catalogue.
    #[test]
    fn both_ways_through_are_found() {
        let s = Sphere { centre: Vec3::new(0.0, 0.0, 5.0), radius: 2.0 };
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        assert_eq!(s.intersect(&ray), Some(3.0));
        assert_eq!(s.intersect(&Ray { t_min: 3.0, ..ray }), Some(7.0));
        assert_eq!(s.intersect(&Ray { t_min: 7.0, ..ray }), None);
        assert_eq!(s.intersect(&Ray { t_max: 2.9, ..ray }), None);
        assert_eq!(s.intersect(&Ray::new(s.centre, Vec3::X * 0.5)), Some(4.0));
        assert_eq!(s.intersect(&Ray { dir: -Vec3::Z, ..ray }), None);
        assert_eq!(s.intersect(&Ray { dir: -Vec3::Z, t_min: -10.0, ..ray }), Some(-7.0));
        // From the surface inwards, and touching it.
        assert_eq!(s.intersect(&Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::Z)), Some(4.0));
        assert_eq!(s.intersect(&Ray::new(Vec3::new(2.0, 0.0, 0.0), Vec3::Z)), Some(5.0));
    }

    /// Case SP-01 of the catalogue.
    #[test]
    fn a_small_sphere_far_away_is_hit_where_it_is() {
        let mut state = 11_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 23) - 1.0
        };
        for distance in [10.0, 1e3, 1e5] {
            for _ in 0..20_000 {
                let towards = glam::DVec3::new(random(), random(), random()).normalize_or(glam::DVec3::X);
                let centre = (towards * distance).as_vec3();
                let aside = glam::DVec3::new(random(), random(), random()) * 0.5;
                let dir = (centre.as_dvec3() + aside).normalize().as_vec3();
                let s = Sphere { centre, radius: 1.0 };
                // The answer in f64, for the same numbers.
                let (d, c) = (dir.as_dvec3(), centre.as_dvec3());
                let nearest = d * (c.dot(d) / d.dot(d));
                let below = 1.0 - (c - nearest).length_squared();
                if below < 0.1 {
                    continue;
                }
                let want = (c.dot(d) - (below * d.dot(d)).sqrt()) / d.dot(d);
                let got = f64::from(s.intersect(&Ray::new(Vec3::ZERO, dir)).expect("aimed well inside"));
                assert!((got - want).abs() < 3e-6 * distance + 1e-6, "{got} for {want} at {distance}");
            }
        }
    }

    /// Case SP-04 of the catalogue.
    #[test]
    fn spheres_that_cannot_be_are_refused() {
        let of = |radius, x| Sphere { centre: Vec3::new(x, 0.0, 0.0), radius }.is_usable();
        assert!(of(1.0, 0.0));
        for radius in [0.0, -1.0, 1e-39, f32::NAN, f32::INFINITY, 1e19] {
            assert!(!of(radius, 0.0), "{radius}");
        }
        assert!(!of(1.0, f32::NAN) && !of(1.0, 2e18));
    }
}
