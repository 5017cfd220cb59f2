//! Refraction by computing the angles.

use super::formula::{Refracted, RefractionFormula};
use crate::math::{Real, Vector3};
use crate::optics::boundary::{Boundary, Crossing};

/// Snell's law with angles, as both sets of slides begin: `th1 = acos(-(i . n))`, `th2 = asin(eta sin(th1))`, `t =
/// sin(th2) v1 - cos(th2) n` with `v1 = i_perp / |i_perp|` and `i_perp = i + cos(th1) n`.
///
/// Corrections: one deck prints `t = -sin(th2) v1 - cos(th2) v2`, which refracts to the wrong side. `v1` (`b` in the
/// other deck) is 0/0 at normal incidence, where the result is `incident`. The cosine is clamped to 1, above which the
/// arc cosine is NaN. A sine above 1 is total reflection.
///
/// Errors: 1.1e-5 rad at average angles and 5e-4 rad near normal incidence, where the arc cosine loses half the digits.
/// These are sixty to six thousand times those of the algebraic forms. In `f32` the four functions are those of
/// [`crate::math`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Trigonometric;

impl RefractionFormula for Trigonometric {
    #[inline(always)]
    fn refract<R: Real>(
        self,
        boundary: &Boundary<R>,
        incident: Vector3<R>,
        normal: Vector3<R>,
        at: &Crossing<R>,
    ) -> Refracted<R> {
        let (one, zero) = (R::one(), R::zero());
        let (sin_1, _) = at.cos_i.acos().sin_cos();
        let sine = boundary.eta * sin_1;
        let (sin_2, cos_2) = sine.min(one).asin().sin_cos();
        let across = normal.fma(at.cos_i, incident);
        let length = across.length();
        let head_on = length.eq(zero);
        let v1 = across * (one / R::select(head_on, one, length));
        let direction = v1 * sin_2 - normal * cos_2;
        Refracted { direction: Vector3::select(head_on, incident, direction), total: sine.gt(one) }
    }
}
