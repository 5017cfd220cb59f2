//! Infinite planes.

use glam::Vec3;

/// The points `p` with `normal . (p - point) = 0`; the outside is where the normal points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point on it, in scene units.
    pub point: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}
