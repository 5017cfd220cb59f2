//! Three ways to compute a reciprocal, each a type.

use super::F32x8;
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
    /// The name in tables and on the command line.
    const NAME: &'static str;

    /// `1 / x`.
    fn of<R: Estimate>(x: R) -> R;

    /// `a / b`, as `a` times the reciprocal.
    #[inline(always)]
    fn quotient<R: Estimate>(a: R, b: R) -> R {
        a * Self::of(b)
    }
}

/// A way to compute `1 / x`, selected at run time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ReciprocalModel {
    /// [`Division`].
    #[default]
    Exact,
    /// [`NewtonStep`].
    Newton,
    /// [`Guess`].
    Estimate,
}

impl ReciprocalModel {
    /// All ways, the least accurate first.
    pub const ALL: [Self; 3] = [Self::Estimate, Self::Newton, Self::Exact];

    /// The name in tables and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => Division::NAME,
            Self::Newton => NewtonStep::NAME,
            Self::Estimate => Guess::NAME,
        }
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
    const NAME: &'static str = "exact";

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
    const NAME: &'static str = "estimate";

    #[inline(always)]
    fn of<R: Estimate>(x: R) -> R {
        x.reciprocal_estimate()
    }
}

impl Reciprocal for NewtonStep {
    const NAME: &'static str = "newton";

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
