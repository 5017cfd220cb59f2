//! Schlick's approximation of 1994.

use crate::math::Real;

/// Schlick's formula for a given cosine. At most 1, to the bit, for `r0` in 0..=1.
#[inline(always)]
pub(super) fn schlick<R: Real>(r0: R, cos: R) -> R {
    let m = (R::one() - cos).max(R::zero());
    let m2 = m * m;
    (R::one() - r0).fma(m2 * m2 * m, r0)
}
