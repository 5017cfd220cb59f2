//! [`Real`] for `f32` and `f64`.

use super::real::{EXPONENT_BITS, FUSED, INVERSE_BITS, Real};
use super::{elementary, trigonometry};

/// The methods that both number types take from the standard library under the same name.
macro_rules! standard_methods {
    ($number:ty) => {
        #[inline(always)]
        fn sqrt(self) -> Self {
            <$number>::sqrt(self)
        }
        #[inline(always)]
        fn abs(self) -> Self {
            <$number>::abs(self)
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            <$number>::min(self, other)
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            <$number>::max(self, other)
        }
        #[inline(always)]
        fn lt(self, other: Self) -> bool {
            self < other
        }
        #[inline(always)]
        fn le(self, other: Self) -> bool {
            self <= other
        }
        #[inline(always)]
        fn eq(self, other: Self) -> bool {
            self == other
        }
        #[inline(always)]
        fn select(mask: bool, yes: Self, no: Self) -> Self {
            if mask { yes } else { no }
        }
    };
}

impl Real for f32 {
    type Mask = bool;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn split(x: f64) -> (Self, Self) {
        let high = x as f32;
        (high, (x - f64::from(high)) as f32)
    }
    #[inline(always)]
    fn power_of_two(self) -> (Self, Self) {
        let bits = self.to_bits() & EXPONENT_BITS;
        (f32::from_bits(bits), f32::from_bits(INVERSE_BITS.wrapping_sub(bits)))
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        // `f32::mul_add` without the CPU feature is a correct but slow library call that `wide` does not make;
        // both sides round twice there, so that they still agree to the bit.
        if FUSED { self.mul_add(b, c) } else { self * b + c }
    }
    standard_methods!(f32);
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    #[inline(always)]
    fn pow(self, exponent: Self) -> Self {
        elementary::pow(self, exponent)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        trigonometry::asin(self)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        trigonometry::acos(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        trigonometry::sin_cos(self)
    }
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn split(x: f64) -> (Self, Self) {
        (x, 0.0)
    }
    #[inline(always)]
    fn power_of_two(self) -> (Self, Self) {
        let bits = self.to_bits() & (0x7ff << 52);
        (f64::from_bits(bits), f64::from_bits((0x7fe_u64 << 52).wrapping_sub(bits)))
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }
    standard_methods!(f64);
    #[inline(always)]
    fn exp(self) -> Self {
        f64::exp(self)
    }
    #[inline(always)]
    fn pow(self, exponent: Self) -> Self {
        self.powf(exponent)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        f64::asin(self)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        f64::acos(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
}
