//! Sine, cosine and their inverses for `f32` and eight lanes of it, from the same operations in the same order.
//!
//! Only the trigonometric refraction of the lecture notes needs them. They cover its angles: sine and cosine up to 3 pi / 4,
//! for which no range reduction is needed.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::real::Real;

/// `asin(s) = s + s^3 P(s^2)` on `|s| <= 1/2`, highest first: Moshier's minimax coefficients (Cephes, `asinf.c`).
const ASIN_POLY: [f64; 5] =
    [4.216_319_904_8e-2, 2.418_131_104_9e-2, 4.547_002_599_8e-2, 7.495_300_268_6e-2, 1.666_675_242_2e-1];

/// `sin(r) = r + r^3 P(r^2)` on `|r| <= pi / 4`, highest first: Taylor's, whose first omitted term is below 3e-9 of the
/// result there.
const SIN_POLY: [f64; 4] = [1.0 / 362_880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0];

/// `cos(r) = 1 - r^2 / 2 + r^4 P(r^2)` on `|r| <= pi / 4`, highest first: Taylor's, to 3e-10.
const COS_POLY: [f64; 4] = [-1.0 / 3_628_800.0, 1.0 / 40_320.0, -1.0 / 720.0, 1.0 / 24.0];

/// Evaluates a polynomial by Horner's rule, coefficients of high powers first.
#[inline(always)]
fn polynomial<R: Real>(coefficients: &[f64], x: R) -> R {
    let mut p = R::splat(coefficients[0]);
    for &c in &coefficients[1..] {
        p = p.fma(x, R::splat(c));
    }
    p
}

/// The common part of [`asin`] and [`acos`]. The mask is true if `|x| > 1/2`; the number is then half the arc cosine of `|x|`,
/// else the arc sine of `|x|`.
#[inline(always)]
fn arc<R: Real>(x: R) -> (R::Mask, R) {
    let half = R::splat(0.5);
    let a = x.abs();
    let steep = a.gt(half);
    let z = R::select(steep, half * (R::one() - a), a * a);
    let s = R::select(steep, z.sqrt(), a);
    (steep, polynomial(&ASIN_POLY, z).fma(z * s, s))
}

/// Arc sine of `x` in radians, for `-1..=1`; NaN outside. At most 2 ulp off.
#[inline(always)]
pub fn asin<R: Real>(x: R) -> R {
    let (steep, p) = arc(x);
    let (high, low) = R::split(FRAC_PI_2);
    let y = R::select(steep, (high - (p + p)) + low, p);
    R::select(x.lt(R::zero()), -y, y)
}

/// Arc cosine of `x` in radians, for `-1..=1`; NaN outside. At most 2 ulp off.
#[inline(always)]
pub fn acos<R: Real>(x: R) -> R {
    let (steep, p) = arc(x);
    let negative = x.lt(R::zero());
    let (half_turn, half_turn_low) = R::split(PI);
    let (right, right_low) = R::split(FRAC_PI_2);
    let twice = p + p;
    let steep_y = R::select(negative, (half_turn - twice) + half_turn_low, twice);
    let flat_y = R::select(negative, right + (p + right_low), right - (p - right_low));
    R::select(steep, steep_y, flat_y)
}

/// Sine and cosine of `x` in radians, for `|x| <= 3 pi / 4` (inaccurate beyond). At most 2 ulp off, but for the cosine
/// next to its zero at a quarter turn, where it is within 2^-48 of the truth.
#[inline(always)]
pub fn sin_cos<R: Real>(x: R) -> (R, R) {
    let a = x.abs();
    let swap = a.gt(R::splat(FRAC_PI_4));
    let (right, right_low) = R::split(FRAC_PI_2);
    let r = R::select(swap, (right - a) + right_low, a);
    let r2 = r * r;
    let s = polynomial(&SIN_POLY, r2).fma(r2 * r, r);
    let c = polynomial(&COS_POLY, r2).fma(r2 * r2, R::splat(-0.5).fma(r2, R::one()));
    let sin = R::select(swap, c, s);
    let cos = R::select(swap, s, c);
    let negative = x.lt(R::zero());
    (R::select(negative, -sin, sin), cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ulps_off(got: f32, want: f64) -> f64 {
        (f64::from(got) - want).abs() / f64::from(crate::math::ulp(want as f32))
    }

    #[test]
    fn arcs_are_within_two_ulp_of_the_f64_value() {
        let mut worst = [0.0_f64; 2];
        for i in -500_000..=500_000 {
            let x = i as f32 / 500_000.0;
            worst[0] = worst[0].max(ulps_off(asin(x), f64::from(x).asin()));
            worst[1] = worst[1].max(ulps_off(acos(x), f64::from(x).acos()));
        }
        assert!(worst[0] <= 2.0 && worst[1] <= 2.0, "asin {} ulp, acos {} ulp", worst[0], worst[1]);
    }

    #[test]
    fn sine_and_cosine_are_within_two_ulp_of_the_f64_value() {
        let mut worst = [0.0_f64; 2];
        for i in -500_000..=500_000 {
            let x = 2.356_f32 * (i as f32 / 500_000.0);
            let (sin, cos) = sin_cos(x);
            let wide = f64::from(x);
            worst[0] = worst[0].max(ulps_off(sin, wide.sin()));
            // Next to its zero the cosine has the absolute error of pi / 2 in two parts.
            let slack = 2.0_f64.powi(-48) / f64::from(crate::math::ulp(wide.cos() as f32));
            worst[1] = worst[1].max(ulps_off(cos, wide.cos()) - slack);
        }
        assert!(worst[0] <= 2.0 && worst[1] <= 2.0, "sin {} ulp, cos {} ulp", worst[0], worst[1]);
    }

    #[test]
    fn known_angles_come_out() {
        assert_eq!(asin(0.0_f32), 0.0);
        assert_eq!(asin(1.0_f32), std::f32::consts::FRAC_PI_2);
        assert_eq!(acos(1.0_f32), 0.0);
        assert_eq!(acos(-1.0_f32), std::f32::consts::PI);
        assert_eq!(sin_cos(0.0_f32), (0.0, 1.0));
        assert!(asin(1.5_f32).is_nan() && acos(-1.5_f32).is_nan() && sin_cos(f32::NAN).0.is_nan());
    }
}
