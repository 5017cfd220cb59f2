//! Reflectance of metals.

use super::schlick::schlick;
use crate::math::Real;

/// Reflectance of a metal at normal incidence: `((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2)`.
#[inline(always)]
pub fn conductor_at_normal<R: Real>(eta: R, k: R) -> R {
    let k2 = k * k;
    let (less, more) = (eta - R::one(), eta + R::one());
    less.fma(less, k2) / more.fma(more, k2)
}

/// Schlick's approximation with a metal's reflectance at normal incidence. Its errors are largest around 80 degrees: up
/// to 0.01 (silver), 0.02 (gold), 0.04 (copper), 0.1 (aluminium) and 0.2 (chromium).
#[inline(always)]
pub fn conductor_schlick<R: Real>(cos_i: R, eta: R, k: R) -> R {
    schlick(conductor_at_normal(eta, k), cos_i)
}

/// The Fresnel equations for a metal, unpolarised, 0..=1 (Born & Wolf, section 14.2). The relative error is at most
/// 1.4e-6 for real metals. With `k` = 0 it is the reflectance of a dielectric, total reflection included.
#[inline(always)]
pub fn conductor_exact<R: Real>(cos_i: R, eta: R, k: R) -> R {
    let Metal { r_s, q2, .. } = Metal::new(cos_i, eta, k);
    // `min` also turns the 0/0 of a vanishing index into 1.
    (R::splat(0.5) * r_s.fma(q2, r_s)).min(R::one())
}

/// Reflectances of a metal for both polarisations, and the phase between them.
///
/// Both are quotients of sums of squares, which no rounding makes negative:
///
/// ```text
/// a + i b   = sqrt((eta + i k)^2 - sin^2)
/// R_s       = ((a - c)^2 + b^2) / ((a + c)^2 + b^2)
/// R_p / R_s = ((a c - s^2)^2 + (b c)^2) / ((a c + s^2)^2 + (b c)^2)
/// ```
pub(super) struct Metal<R> {
    /// Reflectance of the `s` part.
    pub r_s: R,
    /// Squared magnitude of `r_p / r_s`.
    pub q2: R,
    /// Real part of `r_p / r_s`, in the sign convention in which both amplitudes agree at normal incidence.
    pub q_re: R,
    /// Imaginary part of `r_p / r_s`.
    pub q_im: R,
}

impl<R: Real> Metal<R> {
    #[inline(always)]
    pub fn new(cos_i: R, eta: R, k: R) -> Self {
        let one = R::one();
        let c = cos_i.max(R::zero()).min(one);
        let s2 = (one - c) * (one + c);
        // (eta + i k)^2 - sin^2 = difference + 2 i product. With 1 - sin^2 written as c^2, nothing is lost at grazing
        // incidence on an index near 1.
        let difference = c.fma(c, (-k).fma(k, (eta - one) * (eta + one)));
        let product = eta * k;
        // The larger part of the root is computed from a sum, the smaller one from their product.
        let modulus = difference.fma(difference, R::splat(4.0) * product * product).sqrt();
        let larger = (R::splat(0.5) * (modulus + difference.abs())).sqrt();
        let smaller = R::select(larger.gt(R::zero()), product / larger, R::zero());
        let forward = difference.ge(R::zero());
        let a = R::select(forward, larger, smaller);
        let b = R::select(forward, smaller, larger);
        let (b2, bc) = (b * b, b * c);
        let b2c2 = bc * bc;
        let (less, more) = (a - c, a + c);
        let r_s = less.fma(less, b2) / more.fma(more, b2);
        let (less, more) = (a.fma(c, -s2), a.fma(c, s2));
        let below = more.fma(more, b2c2);
        let q2 = less.fma(less, b2c2) / below;
        Self { r_s, q2, q_re: less.fma(more, b2c2) / below, q_im: bc * (s2 + s2) / below }
    }
}
