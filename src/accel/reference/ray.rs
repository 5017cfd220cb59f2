//! Rays and hits in `f64`.

use glam::DVec3;

use crate::geometry::{GeometryMask, Hit, NO_GEOMETRY, Ray};

/// A ray in `f64`: the points `origin + t * dir` with `t_min < t <= t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray64 {
    /// Start, in scene units.
    pub origin: DVec3,
    /// Direction, of any length but zero.
    pub dir: DVec3,
    /// Hits at or below this parameter do not count.
    pub t_min: f64,
    /// Hits above this parameter do not count.
    pub t_max: f64,
    /// Kinds of geometry that it may hit.
    pub admits: GeometryMask,
}

impl Ray64 {
    /// Creates a ray over `0 < t <= inf` that admits all geometry.
    #[must_use]
    pub fn new(origin: DVec3, dir: DVec3) -> Self {
        Self { origin, dir, t_min: 0.0, t_max: f64::INFINITY, admits: GeometryMask::ALL }
    }

    /// The point at parameter `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.dir * t
    }

    /// Returns true if it can hit anything: finite, of non-zero direction, over an interval that is not empty.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        self.origin.is_finite() && self.dir.is_finite() && self.dir != DVec3::ZERO && self.t_min < self.t_max
    }

    /// Returns true if `t` lies in its interval.
    #[must_use]
    pub fn sees(&self, t: f64) -> bool {
        self.t_min < t && t <= self.t_max
    }
}

impl From<&Ray> for Ray64 {
    /// Widens a ray; this is exact.
    fn from(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.as_dvec3(),
            dir: ray.dir.as_dvec3(),
            t_min: f64::from(ray.t_min),
            t_max: f64::from(ray.t_max),
            admits: ray.admits,
        }
    }
}

/// Hit of one ray on one primitive, or a miss. The fields have the meaning of those of [`Hit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit64 {
    /// Ray parameter; infinite on a miss.
    pub t: f64,
    /// Barycentric weight of the triangle's second corner.
    pub u: f64,
    /// Barycentric weight of the triangle's third corner.
    pub v: f64,
    /// Instance; 0, since scenes have no instances yet.
    pub instance: u32,
    /// Index of the geometry in the list; [`NO_GEOMETRY`] on a miss.
    pub geometry: u32,
    /// Index of the triangle in the mesh; 0 for other shapes.
    pub primitive: u32,
}

impl Hit64 {
    /// A miss.
    pub const MISS: Self = Self { t: f64::INFINITY, u: 0.0, v: 0.0, instance: 0, geometry: NO_GEOMETRY, primitive: 0 };

    /// Returns true if this is a hit.
    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.geometry != NO_GEOMETRY
    }

    /// Order of two hits at the same `t`: the lower one wins.
    #[must_use]
    pub fn id(&self) -> (u32, u32, u32) {
        (self.instance, self.geometry, self.primitive)
    }

    /// Returns true if this hit is nearer than `o`, with ties settled by id.
    #[must_use]
    pub fn is_before(&self, o: &Self) -> bool {
        self.t < o.t || (self.t == o.t && self.id() < o.id())
    }

    /// Rounds to the nearest [`Hit`] that lies in the interval `t_min < t <= t_max` of the `f32` ray.
    #[must_use]
    pub fn to_f32(&self, t_min: f32) -> Hit {
        if !self.is_hit() {
            return Hit::MISS;
        }
        // Rounding is monotonic, so `t <= t_max` still holds. `t_min < t` and finiteness may not.
        let t = (self.t as f32).min(f32::MAX);
        let t = if t > t_min { t } else { t_min.next_up() };
        Hit {
            t,
            u: self.u as f32,
            v: self.v as f32,
            instance: self.instance,
            geometry: self.geometry,
            primitive: self.primitive,
        }
    }
}
