//! Three ways to compute a reciprocal, each a type.

use super::f32x8::F32x8;
use crate::math::Real;

/// Numbers with a hardware estimate of the reciprocal.
pub trait Estimate: Real {
    /// Approximately `1 / self`, with a relative error of at most 3.0e-4 on x86-64 (`rcpps`). The bits depend on the CPU vendor.
    /// It is a true quotient on targets without such an instruction, and in `f64`.
    #[must_use]
    fn reciprocal_estimate(self) -> Self;
}

impl Estimate for F32x8 {
    #[inline(always)]
    fn reciprocal_estimate(self) -> Self {
        Self(self.0.recip())
    }
}

impl Estimate for f32 {
    #[inline(always)]
    fn reciprocal_estimate(self) -> Self {
        F32x8::from(self).reciprocal_estimate().lane(0)
    }
}

impl Estimate for f64 {
    #[inline(always)]
    fn reciprocal_estimate(self) -> Self {
        1.0 / self
    }
}

/// A way to compute `1 / x`.
pub trait Reciprocal: Copy + Send + Sync + 'static {
    /// `1 / x`.
    fn of<R: Estimate>(x: R) -> R;

    /// `a / b`, as `a` times the reciprocal.
    #[inline(always)]
    fn quotient<R: Estimate>(a: R, b: R) -> R {
        a * Self::of(b)
    }
}

crate::choice! {
    /// Reciprocals of the walk with one ray at a time.
    pub enum ReciprocalModel("reciprocal", derive(Eq, Hash), default(Exact), visitor(ReciprocalVisitor, Reciprocal)) {
        /// Estimate of the hardware; its bits differ between makers of CPUs.
        "estimate" => Estimate by Guess,
        /// Estimate of the hardware and one Newton step.
        "newton" => Newton by NewtonStep,
        /// True division.
        "exact" => Exact by Division,
    }
}

/// True division: the nearest number, the same on every CPU.
#[derive(Clone, Copy, Debug, Default)]
pub struct Division;

/// The hardware estimate. Never a default, since its bits depend on the CPU.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guess;

/// The hardware estimate with one Newton step, `e + e (1 - x e)`: a relative error of at most 2e-7 if products are fused. NaN
/// for zero and infinity, and for denormal numbers, whose estimate is infinite.
#[derive(Clone, Copy, Debug, Default)]
pub struct NewtonStep;

impl Reciprocal for Division {
    #[inline(always)]
    fn of<R: Estimate>(x: R) -> R {
        R::one() / x
    }

    /// A quotient has one rounding; a product with the reciprocal has two.
    #[inline(always)]
    fn quotient<R: Estimate>(a: R, b: R) -> R {
        a / b
    }
}

impl Reciprocal for Guess {
    #[inline(always)]
    fn of<R: Estimate>(x: R) -> R {
        x.reciprocal_estimate()
    }
}

impl Reciprocal for NewtonStep {
    #[inline(always)]
    fn of<R: Estimate>(x: R) -> R {
        let e = x.reciprocal_estimate();
        let missed = (-x).fma(e, R::one());
        e.fma(missed, e)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_as_near_as_it_says_and_one_lane_agrees_with_eight() {
        let mut state = 9_u32;
        for _ in 0..20_000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let x = 2_f32.powi((state >> 24) as i32 % 120 - 60) * (1.0 + (state >> 9 & 0x7fff) as f32 / 32768.0);
            let off = |got: f32| (f64::from(got) * f64::from(x) - 1.0).abs();
            assert!(off(Guess::of(x)) <= 3.2e-4, "{x}");
            assert!(off(NewtonStep::of(x)) <= 2e-7, "{x}: {:e}", off(NewtonStep::of(x)));
            assert!(off(Division::of(x)) <= 6e-8, "{x}");
            assert_eq!(NewtonStep::of(F32x8::from(x)).lane(3).to_bits(), NewtonStep::of(x).to_bits());
        }
    }
}
