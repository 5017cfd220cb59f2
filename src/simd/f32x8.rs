//! Eight `f32` lanes: a newtype over `wide::f32x8` without the 12-bit `recip` and `recip_sqrt`, and without `fast_min` and
//! `fast_max`, whose result for a NaN depends on the CPU.

#![allow(unsafe_code, reason = "intrinsics of the CPU")]

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use wide::Select;

#[cfg(all(target_feature = "avx512dq", target_feature = "avx512vl"))]
use super::magnitude;
use super::mask8::Mask8;
use crate::math::{self, Binary32, Real};

/// Eight `f32` numbers, one a lane; 32 bytes, aligned to 32.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct F32x8(pub(super) wide::f32x8);

impl F32x8 {
    /// Zero in all lanes.
    pub const ZERO: Self = Self::new([0.0; 8]);
    /// One in all lanes.
    pub const ONE: Self = Self::new([1.0; 8]);
    /// Positive infinity in all lanes.
    pub const INFINITY: Self = Self::new([f32::INFINITY; 8]);

    /// Lanes from an array, lane 0 first.
    #[inline(always)]
    #[must_use]
    pub const fn new(lanes: [f32; 8]) -> Self {
        Self(wide::f32x8::new(lanes))
    }

    /// Lanes as an array, lane 0 first.
    #[inline(always)]
    #[must_use]
    pub fn to_array(self) -> [f32; 8] {
        self.0.to_array()
    }

    /// Lanes as a slice in place.
    #[inline(always)]
    #[must_use]
    pub fn as_array(&self) -> &[f32; 8] {
        bytemuck::cast_ref(self)
    }

    /// Lanes as a mutable slice in place.
    #[inline(always)]
    pub fn as_mut_array(&mut self) -> &mut [f32; 8] {
        bytemuck::cast_mut(self)
    }

    /// The number in lane `i` (0..8).
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, i: usize) -> f32 {
        self.as_array()[i]
    }

    /// Puts `x` into lane `i` (0..8).
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, x: f32) {
        self.as_mut_array()[i] = x;
    }

    /// Lanes by a function of the lane number.
    #[inline(always)]
    pub fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
        Self::new(std::array::from_fn(f))
    }

    /// Lanes whose sign bit is set, as bits (lane 0 lowest).
    #[inline(always)]
    #[must_use]
    pub fn sign_bits(self) -> u8 {
        self.0.to_bitmask() as u8
    }

    /// Lanes that are neither infinite nor NaN.
    #[inline(always)]
    #[must_use]
    pub fn is_finite(self) -> Mask8 {
        Mask8(self.0.is_finite())
    }

    /// Transposes a matrix of 8 by 8: lane `k` of row `i` becomes lane `i` of row `k`.
    #[inline(always)]
    #[must_use]
    pub fn transpose(rows: [Self; 8]) -> [Self; 8] {
        wide::f32x8::transpose(rows.map(|r| r.0)).map(Self)
    }

    /// Rounds towards zero. Lanes outside the range of `i32` give an undefined number.
    #[inline(always)]
    #[must_use]
    pub fn truncated(self) -> [i32; 8] {
        self.0.fast_trunc_int().to_array()
    }

    /// The largest lane. No lane may be NaN.
    #[inline(always)]
    #[must_use]
    pub fn reduce_max(self) -> f32 {
        let [a, b, c, d, e, f, g, h] = self.to_array();
        let (a, b, c, d) = (a.max_or(e), b.max_or(f), c.max_or(g), d.max_or(h));
        a.max_or(c).max_or(b.max_or(d))
    }
}

impl Mask8 {
    /// `yes` where true, else `no`.
    #[inline(always)]
    #[must_use]
    pub fn select(self, yes: F32x8, no: F32x8) -> F32x8 {
        F32x8(Select::select(self.0, yes.0, no.0))
    }
}

impl From<f32> for F32x8 {
    /// The same number in all lanes.
    #[inline(always)]
    fn from(x: f32) -> Self {
        Self(wide::f32x8::splat(x))
    }
}

impl Real for F32x8 {
    type Mask = Mask8;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self::from(x as f32)
    }
    #[inline(always)]
    fn split(x: f64) -> (Self, Self) {
        let (high, low) = <f32 as Real>::split(x);
        (Self::from(high), Self::from(low))
    }
    #[inline(always)]
    fn power_of_two(self) -> (Self, Self) {
        let bits: wide::i32x8 = bytemuck::cast(self.0);
        let bits = bits & wide::i32x8::splat(math::EXPONENT_BITS as i32);
        (Self(bytemuck::cast(bits)), Self(bytemuck::cast(wide::i32x8::splat(math::INVERSE_BITS as i32) - bits)))
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        // `wide` fuses exactly where `math::FUSED` is true, and rounds twice elsewhere, as the scalar twin does.
        Self(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        mask.select(yes, no)
    }
    #[inline(always)]
    fn min_or(self, other: Self) -> Self {
        // `wide` hands this to the instruction of each CPU; only those of x86 answer `other` to a NaN.
        if cfg!(target_arch = "x86_64") { Self(self.0.fast_min(other.0)) } else { self.lt(other).select(self, other) }
    }
    #[inline(always)]
    fn max_or(self, other: Self) -> Self {
        if cfg!(target_arch = "x86_64") { Self(self.0.fast_max(other.0)) } else { other.lt(self).select(self, other) }
    }
    #[cfg(all(target_feature = "avx512dq", target_feature = "avx512vl"))]
    #[inline(always)]
    fn least_magnitude(self, other: Self) -> Self {
        Self(magnitude::least(self.0, other.0))
    }
    #[cfg(all(target_feature = "avx512dq", target_feature = "avx512vl"))]
    #[inline(always)]
    fn greatest_magnitude(self, other: Self) -> Self {
        Self(magnitude::greatest(self.0, other.0))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        math::exp(self)
    }
    #[inline(always)]
    fn pow(self, exponent: Self) -> Self {
        math::pow(self, exponent)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        math::asin(self)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        math::acos(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        math::sin_cos(self)
    }
}

impl Binary32 for F32x8 {
    #[inline(always)]
    fn round_ties_even(self) -> Self {
        Self(self.0.round_ties_even())
    }

    #[inline(always)]
    fn exp2_of_integer(self) -> Self {
        let biased = self.0.fast_trunc_int() + wide::i32x8::splat(127);
        Self(bytemuck::cast(biased << 23_u32))
    }

    #[inline(always)]
    fn mantissa_and_exponent(self) -> (Self, Self) {
        let bits: wide::i32x8 = bytemuck::cast(self.0);
        let exponent = (bits - wide::i32x8::splat(math::SQRT_HALF_BITS as i32)) >> 23_u32;
        let mantissa = bits - (exponent << 23_u32);
        (Self(bytemuck::cast(mantissa)), Self(exponent.round_float()))
    }
}

impl Add for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0)
    }
}

impl Sub for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self(self.0 - o.0)
    }
}

impl Mul for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self(self.0 * o.0)
    }
}

impl Div for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        Self(self.0 / o.0)
    }
}

impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for F32x8 {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for F32x8 {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl MulAssign for F32x8 {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stream of numbers that covers every exponent, both signs and the special values.
    fn awkward() -> Vec<f32> {
        let mut state = 0x1234_5678_u32;
        let mut v =
            vec![0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, 1e-45, f32::MAX, f32::INFINITY, -f32::INFINITY, f32::NAN];
        for _ in 0..20_000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            v.push(f32::from_bits(state));
        }
        v.resize(v.len().next_multiple_of(8), 1.0);
        v
    }

    #[test]
    fn magnitudes_are_compared_as_every_cpu_compares_them() {
        let mut numbers = vec![0.0, -0.0, 1e-45, -1e-45, f32::MIN_POSITIVE, 1.0, -1.0, f32::MAX, f32::NEG_INFINITY];
        let mut state = 7_u32;
        while numbers.len() < 400 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            numbers.extend(Some(f32::from_bits(state)).filter(|x| !x.is_nan()));
        }
        for &x in &numbers {
            for y in numbers.as_chunks::<8>().0 {
                let (x, y) = (F32x8::from(x), F32x8::new(*y));
                let bits = |z: F32x8| z.to_array().map(f32::to_bits);
                assert_eq!(bits(x.least_magnitude(y)), bits(x.abs().min_or(y.abs())), "{x:?} {y:?}");
                assert_eq!(bits(x.greatest_magnitude(y)), bits(x.abs().max_or(y.abs())), "{x:?} {y:?}");
            }
        }
    }

    fn same(a: f32, b: f32) -> bool {
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (a == 0.0 && b == 0.0 && a == b)
    }

    fn check(name: &str, eight: impl Fn(F32x8, F32x8) -> F32x8, one: impl Fn(f32, f32) -> f32) {
        let v = awkward();
        for (i, chunk) in v.as_chunks::<8>().0.iter().enumerate() {
            let partner: [f32; 8] = std::array::from_fn(|k| v[(i * 8 + k * 37 + 11) % v.len()]);
            let got = eight(F32x8::new(*chunk), F32x8::new(partner)).to_array();
            for k in 0..8 {
                let want = one(chunk[k], partner[k]);
                assert!(same(got[k], want), "{name}({}, {}): {} is not {want}", chunk[k], partner[k], got[k]);
            }
        }
    }

    #[test]
    fn rows_become_columns() {
        let rows = std::array::from_fn(|i| F32x8::from_fn(|k| (10 * i + k) as f32));
        let columns = F32x8::transpose(rows);
        for (k, column) in columns.iter().enumerate() {
            assert_eq!(column.to_array(), std::array::from_fn(|i| (10 * i + k) as f32));
        }
    }

    #[test]
    fn truncation_is_towards_zero() {
        let lanes = F32x8::new([0.0, 0.99, 1.0, -0.5, -1.5, 15.999, 8_388_609.0, -7.0]);
        assert_eq!(lanes.truncated(), [0, 0, 1, 0, -1, 15, 8_388_609, -7]);
    }

    #[test]
    fn lanes_and_scalars_fuse_products_exactly_where_the_build_says_so() {
        let e = f32::EPSILON;
        // (1 + e)(1 - e) - 1 is -e^2, of which two roundings leave nothing.
        let (a, b) = (1.0 + e, 1.0 - e);
        let want = if math::FUSED { -e * e } else { 0.0 };
        assert_eq!(a.fma(b, -1.0), want, "one lane");
        assert_eq!(F32x8::from(a).fma(F32x8::from(b), F32x8::from(-1.0)).to_array(), [want; 8], "eight lanes");
    }

    #[test]
    fn a_fused_sum_that_all_but_cancels_gives_each_lane_the_bits_of_the_scalar() {
        check("fma that cancels", |a, b| a.fma(b, -(a * b)), |a, b| a.fma(b, -(a * b)));
        check("fma of three", |a, b| a.fma(b, a - b), |a, b| a.fma(b, a - b));
        check("fma near cancelling", |a, b| a.fma(b, -(a * b) + a), |a, b| a.fma(b, -(a * b) + a));
    }

    /// Case LN-06 of the catalogue.
    #[test]
    fn every_operation_gives_each_lane_the_bits_of_the_scalar() {
        check("add", |a, b| a + b, |a, b| a + b);
        check("sub", |a, b| a - b, |a, b| a - b);
        check("mul", |a, b| a * b, |a, b| a * b);
        check("div", |a, b| a / b, |a, b| a / b);
        check("neg", |a, _| -a, |a, _| -a);
        check("min", Real::min, f32::min);
        check("max", Real::max, f32::max);
        check("min_or", Real::min_or, |a, b| if a < b { a } else { b });
        check("max_or", Real::max_or, |a, b| if a > b { a } else { b });
        check("abs", |a, _| Real::abs(a), |a, _| f32::abs(a));
        check("sqrt", |a, _| Real::sqrt(a), |a, _| f32::sqrt(a));
        check("fma", |a, b| a.fma(b, a), |a, b| a.fma(b, a));
        check("select", |a, b| Real::select(a.lt(b), a, b), |a, b| if a < b { a } else { b });
        check("power_of_two", |a, _| a.power_of_two().0, |a, _| a.power_of_two().0);
        check("its inverse", |a, _| a.power_of_two().1, |a, _| a.power_of_two().1);
        check("exp", |a, _| Real::exp(a), |a, _| Real::exp(a));
        check("asin", |a, _| Real::asin(a), |a, _| Real::asin(a));
        check("acos", |a, _| Real::acos(a), |a, _| Real::acos(a));
        check("sin", |a, _| Real::sin_cos(a).0, |a, _| Real::sin_cos(a).0);
        check("cos", |a, _| Real::sin_cos(a).1, |a, _| Real::sin_cos(a).1);
        check("pow", |a, b| Real::pow(Real::abs(a), b), |a, b| Real::pow(f32::abs(a), b));
    }
}
