//! Rounding of positions that counts as contact.

use glam::DVec3;

use crate::geometry::aabb::Aabb;
use crate::math::UNIT_ROUNDOFF;

/// Distance up to which two surfaces at a place of the given largest coordinate coincide, in scene units: eight units of
/// rounding. Each face is off by at most four, one for each coordinate of a corner and one for the transform.
#[must_use]
pub fn tolerance(largest_coordinate: f64) -> f64 {
    8.0 * f64::from(UNIT_ROUNDOFF) * largest_coordinate
}

/// A box in `f64` grown by the tolerance of its own coordinates.
pub(super) fn grown(b: &Aabb) -> (DVec3, DVec3) {
    let margin = tolerance(f64::from(b.lo.abs().max(b.hi.abs()).max_element()));
    (b.lo.as_dvec3() - margin, b.hi.as_dvec3() + margin)
}
