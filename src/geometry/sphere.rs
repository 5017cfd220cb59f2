//! Exact spheres.

use glam::Vec3;

use super::Aabb;
use crate::math::{next_down, next_up};

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
}
