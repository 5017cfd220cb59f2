//! The boundary between two media: refraction and Fresnel reflectance from one square root.
//!
//! With `kc = 1 - (n2 / n1)^2` and `b = (n2 / n1) cos_t = sqrt(cos_i^2 - kc)`, both refraction and Fresnel need the
//! difference `cos_i - b`. It is computed as `kc / (cos_i + b)`, which does not cancel at any index ratio. `kc` is kept
//! as a high and a low part and subtracted with one rounding, so that the critical angle loses no digits either.
//!
//! Weights carry flux, as in the Whitted model: the factor `(n2 / n1)^2` by which radiance grows inside the denser
//! medium is omitted. It cancels for light that leaves again.

use crate::math::{Real, Vector3};

/// Constants of a pair of media.
#[derive(Clone, Copy, Debug)]
pub struct Boundary<R> {
    /// `n1 / n2`, incident over transmitted.
    pub eta: R,
    /// `1 - (n2 / n1)^2`, rounded.
    pub kc: R,
    /// Rounding error of `kc`: the exact value is `kc + kc_low`.
    pub kc_low: R,
    /// Reflectance at normal incidence, `((n1 - n2) / (n1 + n2))^2`.
    pub r0: R,
}

/// One ray at a boundary.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<R: Real> {
    /// Cosine of the angle of incidence, clamped to 0..=1.
    pub cos_i: R,
    /// `(n2 / n1) cos_t`; 0 under total reflection.
    pub b: R,
    /// Cosine of the angle of refraction; 0 under total reflection.
    pub cos_t: R,
    /// True under total reflection: all light is reflected and no refracted direction exists.
    pub total: R::Mask,
}

impl<R: Real> Boundary<R> {
    /// Boundary of a ray that travels from index `n1` into index `n2`. Both are above zero and finite, and their ratio
    /// is within 1e-15..1e15 (else `kc` leaves the range of `f32`).
    #[must_use]
    pub fn new(n1: f64, n2: f64) -> Self {
        let (kc, kc_low) = R::split((n1 - n2) * (n1 + n2) / (n1 * n1));
        let r = (n1 - n2) / (n1 + n2);
        Self { eta: R::splat(n1 / n2), kc, kc_low, r0: R::splat(r * r) }
    }

    /// Computes the crossing of a ray with the cosine `cos_i`. It is clamped to 0..=1, so that all later formulas use
    /// the same cosine. NaN counts as 0, at which all light is reflected.
    ///
    /// With fused products ([`crate::math::FUSED`]), `b` is within 1.5 ulp of the exact value down to the critical
    /// angle. Without them, rounding of `cos_i^2` causes an error of up to `2^-25 cos_i^2 / b`. Total reflection is decided
    /// by the same difference, exact to about 2^-48 where products are fused and 2^-24 elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn cross(&self, cos_i: R) -> Crossing<R> {
        let cos_i = cos_i.max(R::zero()).min(R::one());
        let b_squared = cos_i.fma(cos_i, -self.kc) - self.kc_low;
        let total = b_squared.lt(R::zero());
        let b = b_squared.safe_sqrt();
        Crossing { cos_i, b, cos_t: b * self.eta, total }
    }

    /// Returns the refracted direction: `eta (i + kc / (cos_i + b) n)`, of unit length for unit arguments. With equal
    /// indices it is `incident` to the bit. Under total reflection it is `eta i`, which is finite but has no meaning.
    ///
    /// Errors (angle): 3e-7 rad where refraction is well conditioned; `2e-7 / cos_t` near the critical angle, where
    /// every formula is limited by the rounding of its arguments.
    #[inline(always)]
    #[must_use]
    pub fn refract(&self, incident: Vector3<R>, normal: Vector3<R>, at: &Crossing<R>) -> Vector3<R> {
        let bend = self.bend(at);
        normal.fma(bend, incident) * self.eta
    }

    /// Returns `cos_i - b`, as `kc / (cos_i + b)`. It is 0 between equal indices, also at grazing incidence, where the
    /// quotient is 0/0, and under total reflection.
    #[inline(always)]
    fn bend(&self, at: &Crossing<R>) -> R {
        let straight = self.kc.eq(R::zero()) | at.total;
        R::select(straight, R::zero(), self.kc / (at.cos_i + at.b))
    }
}
