//! `exp` and `pow` for `f32` and eight lanes of it, from the same operations in the same order.

use super::real::Real;

/// Operations of binary32 beyond [`Real`]: splitting a number into exponent and mantissa, and the reverse.
pub trait Binary32: Real {
    /// The nearest integer, ties to even.
    fn round_ties_even(self) -> Self;
    /// `2^self` for integer-valued lanes in `-126..=127`.
    fn exp2_of_integer(self) -> Self;
    /// For positive normal lanes: mantissa in `[sqrt(1/2), sqrt(2))` and integer-valued exponent.
    fn mantissa_and_exponent(self) -> (Self, Self);
}

impl Binary32 for f32 {
    #[inline(always)]
    fn round_ties_even(self) -> Self {
        f32::round_ties_even(self)
    }

    #[inline(always)]
    fn exp2_of_integer(self) -> Self {
        f32::from_bits(((self as i32 + 127) as u32) << 23)
    }

    #[inline(always)]
    fn mantissa_and_exponent(self) -> (Self, Self) {
        let (bits, exponent) = split_exponent(self.to_bits());
        (f32::from_bits(bits), exponent as f32)
    }
}

/// Bits of sqrt(1/2): subtracting them before the shift rounds the exponent so that the mantissa straddles 1.
pub(crate) const SQRT_HALF_BITS: u32 = 0x3f35_04f3;

fn split_exponent(bits: u32) -> (u32, i32) {
    let exponent = (bits.wrapping_sub(SQRT_HALF_BITS) as i32) >> 23;
    (bits.wrapping_sub((exponent as u32) << 23), exponent)
}

/// Coefficients of `exp(r) - 1 - r` on `|r| <= ln 2 / 2`, highest first: Taylor's, whose first omitted term is
/// `r^8 / 8!`, below 1e-8 of the result there.
const EXP_POLY: [f64; 6] = [1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5];

/// ln 2 in two parts; the high one has ten trailing zero bits, so that a product with an exponent is exact
/// (Cody & Waite 1980, ch. 6).
const LN2_HIGH: f64 = 0.693_145_751_953_125;
const LN2_LOW: f64 = std::f64::consts::LN_2 - LN2_HIGH;

/// e to the power `x`: 0 below -87.33 (where the result would be denormal), infinite above 88.72, NaN for NaN.
#[inline(always)]
pub fn exp<R: Binary32>(x: R) -> R {
    let clamped = x.max(R::splat(-87.5)).min(R::splat(88.75));
    let k = (clamped * R::splat(std::f64::consts::LOG2_E)).round_ties_even();
    let r = k.fma(R::splat(-LN2_LOW), k.fma(R::splat(-LN2_HIGH), clamped));
    let mut p = R::splat(EXP_POLY[0]);
    for &c in &EXP_POLY[1..] {
        p = p.fma(r, R::splat(c));
    }
    let e = (p * r).fma(r, r) + R::one();
    // 2^k in two factors, since k = 128 and k = -127 have no power of two of their own.
    let half = (k * R::splat(0.5)).round_ties_even();
    let y = e * half.exp2_of_integer() * (k - half).exp2_of_integer();
    let y = R::select(x.lt(R::splat(-87.336_54)), R::zero(), y);
    let y = R::select(x.gt(R::splat(88.722_83)), R::splat(f64::INFINITY), y);
    R::select(x.eq(x), y, x)
}

/// `x` to the power `n`, for `x >= 0` and finite `n`: 1 where `n` is 0, 0 where `x` is 0 (or denormal) and `n > 0`.
///
/// At most `3 |n ln x| + 3` ulp off: the logarithm is good to an ulp and a half, and the product is rounded before it
/// is exponentiated. Results worth seeing in a picture (above 1e-3) are therefore good to 24 ulp, 3e-6.
#[inline(always)]
pub fn pow<R: Binary32>(x: R, n: R) -> R {
    let usable = x.ge(R::splat(f64::from(f32::MIN_POSITIVE)));
    let (m, e) = R::select(usable, x, R::one()).mantissa_and_exponent();
    // ln m = 2 atanh(s), s = (m - 1) / (m + 1), |s| <= 0.1716: the series keeps full relative accuracy near m = 1,
    // which is where highlights live.
    let s = (m - R::one()) / (m + R::one());
    let s2 = s * s;
    let mut p = R::splat(2.0 / 11.0);
    for c in [2.0 / 9.0, 2.0 / 7.0, 2.0 / 5.0, 2.0 / 3.0] {
        p = p.fma(s2, R::splat(c));
    }
    let ln_m = (p * s2).fma(s, s + s);
    let ln_x = e.fma(R::splat(LN2_HIGH), e.fma(R::splat(LN2_LOW), ln_m));
    let y = exp(n * ln_x);
    let y = R::select(usable, y, R::select(x.eq(x), R::zero(), x));
    R::select(n.eq(R::zero()), R::one(), y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ulps_off(got: f32, want: f64) -> f64 {
        (f64::from(got) - want).abs() / f64::from(crate::math::ulp(want as f32))
    }

    #[test]
    fn exp_is_within_two_ulp_of_the_f64_value_over_its_whole_range() {
        let mut worst = 0.0_f64;
        for i in 0..2_000_000 {
            let x = -87.3 + 176.0 * (i as f32 / 2_000_000.0);
            worst = worst.max(ulps_off(exp(x), f64::from(x).exp()));
        }
        assert!(worst <= 2.0, "worst {worst} ulp");
    }

    #[test]
    fn exp_of_infinities_and_nan_is_what_absorption_needs() {
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
        assert_eq!(exp(-1000.0_f32), 0.0);
        assert_eq!(exp(f32::INFINITY), f32::INFINITY);
        assert_eq!(exp(0.0_f32), 1.0);
        assert!(exp(f32::NAN).is_nan());
    }

    #[test]
    fn pow_keeps_its_stated_bound() {
        for n in [0.5_f32, 1.0, 2.2, 10.0, 100.0, 1000.0] {
            for i in 1..=100_000 {
                let x = i as f32 / 100_000.0;
                let want = f64::from(x).powf(f64::from(n));
                if want > 1e-30 {
                    let off = ulps_off(pow(x, n), want);
                    let bound = 3.0 * want.ln().abs() + 3.0;
                    assert!(off <= bound, "{x}^{n}: {off} ulp, bound {bound}");
                }
            }
        }
        assert_eq!(pow(0.0_f32, 5.0), 0.0);
        assert_eq!(pow(0.0_f32, 0.0), 1.0);
        assert_eq!(pow(1.0_f32, 77.0), 1.0);
    }
}
