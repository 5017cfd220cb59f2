//! The number trait: one text of optics and geometry serves `f32`, `f64` and eight lanes.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// True if this build fuses multiply and add in [`Real::fma`]. Decided at compile time, because `wide` decides so: on
/// x86-64 by the feature `fma`, on 64-bit ARM always (NEON has no other). Elsewhere an `f32` `fma` rounds twice, on one
/// lane and on eight alike, and the bounds that rest on it are weaker.
pub const FUSED: bool = cfg!(any(target_feature = "fma", all(target_arch = "aarch64", target_feature = "neon")));

/// The bits of an `f32` that hold its exponent.
pub(crate) const EXPONENT_BITS: u32 = 0x7f80_0000;

/// The bits of a power of two and those of its inverse add up to this.
pub(crate) const INVERSE_BITS: u32 = 254 << 23;

/// The result of a comparison: one truth value for a scalar, eight for eight lanes.
pub trait LaneMask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// The same truth value in every lane.
    fn splat(value: bool) -> Self;
    /// Returns true if at least one lane is true.
    fn any(self) -> bool;
    /// Returns true if every lane is true.
    fn all(self) -> bool;
}

impl LaneMask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

/// A number, or eight of them, with IEEE 754 arithmetic.
///
/// Scalar `f32` and each lane of eight give the same bits for every operation here. Therefore `fma`, `exp`, `pow` and the
/// trigonometric functions are implemented here, not taken from the standard library.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// Result type of comparisons.
    type Mask: LaneMask;

    /// The nearest representable number to `x`, in every lane.
    fn splat(x: f64) -> Self;
    /// `x` as the sum of the nearest number and the remainder, which keeps twice the digits of `f32`.
    fn split(x: f64) -> (Self, Self);
    /// The largest power of two that is not above `self`, and one over it, for normal numbers of at most 2^126. A product
    /// with either is exact as long as it stays in range.
    fn power_of_two(self) -> (Self, Self);
    /// `self * b + c`; rounded once where [`FUSED`] says so (in `f64` always).
    fn fma(self, b: Self, c: Self) -> Self;
    /// Correctly rounded square root; NaN below zero.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The smaller of the two; the other one where one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of the two; the other one where one is NaN.
    fn max(self, other: Self) -> Self;
    /// `self < other`; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self == other`; false where either is NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// `yes` where `mask` is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// e to the power `self`; 0 at -inf, never NaN but for NaN. At most 2 ulp off in `f32`.
    fn exp(self) -> Self;
    /// `self` to the power `exponent`, for `self >= 0`; 1 where the exponent is 0.
    fn pow(self, exponent: Self) -> Self;
    /// Arc sine in radians; NaN outside `-1..=1`. At most 2 ulp off in `f32`.
    fn asin(self) -> Self;
    /// Arc cosine in radians; NaN outside `-1..=1`. At most 2 ulp off in `f32`.
    fn acos(self) -> Self;
    /// Sine and cosine of an angle in radians, `|self| <= 3 pi / 4`. At most 2 ulp off in `f32`, but see
    /// [`super::sin_cos`].
    fn sin_cos(self) -> (Self, Self);

    /// `self > other`; false where either is NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`; false where either is NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// Zero in every lane.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// One in every lane.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    /// Square root of `max(self, 0)`, for radicands that only rounding makes negative.
    #[inline(always)]
    fn safe_sqrt(self) -> Self {
        self.max(Self::zero()).sqrt()
    }
    /// `self` where it is the smaller, else `other`; where either is NaN, `other`. One instruction on eight lanes.
    #[inline(always)]
    fn min_or(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// `self` where it is the larger, else `other`; where either is NaN, `other`. One instruction on eight lanes.
    #[inline(always)]
    fn max_or(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// The smaller of the two magnitudes; where one is NaN, either of them.
    #[inline(always)]
    fn least_magnitude(self, other: Self) -> Self {
        self.abs().min_or(other.abs())
    }
    /// The larger of the two magnitudes; where one is NaN, either of them.
    #[inline(always)]
    fn greatest_magnitude(self, other: Self) -> Self {
        self.abs().max_or(other.abs())
    }
    /// `self * self`.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
}
