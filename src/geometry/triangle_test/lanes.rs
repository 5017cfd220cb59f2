//! Numbers with access to single lanes.

use crate::math::Real;
use crate::simd::{Estimate, F32x8, Mask8};

/// Numbers with access to single lanes, which `f64` settles one by one.
pub trait Lanes: Real + Estimate {
    /// Number of lanes.
    const COUNT: usize;
    /// Half the distance from 1 to the next larger number.
    const ROUNDOFF: f64;
    /// The smallest normal number.
    const TINY: f64;

    /// The number in lane `i`, as `f64`.
    fn lane(self, i: usize) -> f64;
    /// Rounds `x` into lane `i`.
    fn set_lane(&mut self, i: usize, x: f64);
    /// The mask as bits, lane 0 lowest.
    fn bits(mask: Self::Mask) -> u8;
    /// The mask with the lanes whose bit is set.
    fn mask(bits: u8) -> Self::Mask;
}

/// [`Lanes`] for a number type of one lane.
macro_rules! one_lane {
    ($number:ty) => {
        impl Lanes for $number {
            const COUNT: usize = 1;
            const ROUNDOFF: f64 = <$number>::EPSILON as f64 / 2.0;
            const TINY: f64 = <$number>::MIN_POSITIVE as f64;

            #[inline(always)]
            fn lane(self, _i: usize) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn set_lane(&mut self, _i: usize, x: f64) {
                *self = x as Self;
            }
            #[inline(always)]
            fn bits(mask: bool) -> u8 {
                u8::from(mask)
            }
            #[inline(always)]
            fn mask(bits: u8) -> bool {
                bits & 1 != 0
            }
        }
    };
}

one_lane!(f32);
one_lane!(f64);

impl Lanes for F32x8 {
    const COUNT: usize = 8;
    const ROUNDOFF: f64 = <f32 as Lanes>::ROUNDOFF;
    const TINY: f64 = <f32 as Lanes>::TINY;

    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        f64::from(Self::lane(&self, i))
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, x: f64) {
        Self::set_lane(self, i, x as f32);
    }
    #[inline(always)]
    fn bits(mask: Mask8) -> u8 {
        mask.bits()
    }
    #[inline(always)]
    fn mask(bits: u8) -> Mask8 {
        Mask8::from_bits(bits)
    }
}
