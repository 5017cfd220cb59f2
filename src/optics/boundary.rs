//! The boundary between two media, and crossing it: refraction and Fresnel from one square root.
//!
//! With `kc = 1 - (n2 / n1)^2` and `b = (n2 / n1) cos_t = sqrt(cos_i^2 - kc)`, the difference that both refraction
//! and Fresnel need, `cos_i - b`, is `kc / (cos_i + b)`: no cancellation at any index ratio. `kc` is kept as a high
//! and a low part and subtracted with one rounding, so that the critical angle loses no digits either.
//!
//! Weights carry flux, as the Whitted model has it: the factor `(n2 / n1)^2` by which radiance grows inside the denser
//! medium is left out. It cancels for light that leaves again.

use crate::math::{Real, Vector3};

/// What is computed once for a pair of media.
#[derive(Clone, Copy, Debug)]
pub struct Boundary<R> {
    /// `n1 / n2`, incident over transmitted.
    pub eta: R,
    /// `1 - (n2 / n1)^2`, rounded.
    pub kc: R,
    /// What `kc` misses.
    pub kc_low: R,
    /// Reflectance at normal incidence, `((n1 - n2) / (n1 + n2))^2`.
    pub r0: R,
}

/// One ray at a boundary.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<R: Real> {
    /// Cosine of the angle of incidence, 0..=1: as given, but for what rounding puts outside.
    pub cos_i: R,
    /// `(n2 / n1) cos_t`; 0 under total reflection.
    pub b: R,
    /// Cosine of the angle of refraction; 0 under total reflection.
    pub cos_t: R,
    /// Where all light is reflected and no refracted direction exists.
    pub total: R::Mask,
}

impl<R: Real> Boundary<R> {
    /// The boundary a ray meets on its way from index `n1` into index `n2`, both above zero and finite, their ratio
    /// within 1e-15..1e15 (else `kc` leaves the range of `f32`).
    #[must_use]
    pub fn new(n1: f64, n2: f64) -> Self {
        let (kc, kc_low) = R::split((n1 - n2) * (n1 + n2) / (n1 * n1));
        let r = (n1 - n2) / (n1 + n2);
        Self { eta: R::splat(n1 / n2), kc, kc_low, r0: R::splat(r * r) }
    }

    /// What happens to a ray that arrives at `cos_i` (0..=1; what lies outside counts as the nearer end, so that all
    /// that follows sees one and the same cosine; NaN counts as 0, where all light is reflected).
    ///
    /// `b` is within 1.5 ulp of the exact one down to the critical angle where products are fused
    /// ([`crate::math::FUSED`]); elsewhere rounding of `cos_i^2` puts it off by up to `2^-25 cos_i^2 / b`. Whether the
    /// crossing is total is decided on the same difference, exact to about 2^-48 where fused and 2^-24 where not.
    #[inline(always)]
    #[must_use]
    pub fn cross(&self, cos_i: R) -> Crossing<R> {
        let cos_i = cos_i.max(R::zero()).min(R::one());
        let b_squared = cos_i.fma(cos_i, -self.kc) - self.kc_low;
        let total = b_squared.lt(R::zero());
        let b = b_squared.safe_sqrt();
        Crossing { cos_i, b, cos_t: b * self.eta, total }
    }

    /// The refracted direction: `eta (i + kc / (cos_i + b) n)`, of unit length for unit arguments. With equal
    /// indices it is `incident` to the bit. Where the crossing is total it is `eta i`: finite, and nobody's direction.
    ///
    /// Errors (angle): 3e-7 rad where refraction is well conditioned; `2e-7 / cos_t` near the critical angle, where
    /// every formula is limited by the rounding of its arguments.
    #[inline(always)]
    #[must_use]
    pub fn refract(&self, incident: Vector3<R>, normal: Vector3<R>, at: &Crossing<R>) -> Vector3<R> {
        let bend = self.bend(at);
        normal.fma(bend, incident) * self.eta
    }

    /// `cos_i - b`, as `kc / (cos_i + b)`; 0 between equal indices, even where grazing makes it 0/0, and where the
    /// crossing is total.
    #[inline(always)]
    fn bend(&self, at: &Crossing<R>) -> R {
        let straight = self.kc.eq(R::zero()) | at.total;
        R::select(straight, R::zero(), self.kc / (at.cos_i + at.b))
    }
}
