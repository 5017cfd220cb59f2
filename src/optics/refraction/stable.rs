//! Refraction without cancellation, and no refraction.

use super::formula::{Refracted, RefractionFormula};
use crate::math::{LaneMask, Real, Vector3};
use crate::optics::boundary::{Boundary, Crossing};

/// `t = eta (i + kc / (c + b) n)`, see [`Boundary::refract`]. It does not cancel at any index ratio, and Fresnel needs
/// the same square root. Between equal indices it is `incident` to the bit.
///
/// Errors: 2e-7 rad on the way into any denser medium, index ratios one ulp from 1 included.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stable;

impl RefractionFormula for Stable {}

/// The direction of incidence, as if there were no boundary. Never total.
#[derive(Clone, Copy, Debug, Default)]
pub struct StraightThrough;

impl RefractionFormula for StraightThrough {
    #[inline(always)]
    fn refract<R: Real>(
        self,
        _boundary: &Boundary<R>,
        incident: Vector3<R>,
        _normal: Vector3<R>,
        _at: &Crossing<R>,
    ) -> Refracted<R> {
        Refracted { direction: incident, total: R::Mask::splat(false) }
    }
}
