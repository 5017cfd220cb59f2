//! The smaller and the larger of two magnitudes: one instruction where the CPU has `vrangeps`, three elsewhere.

#![allow(unsafe_code, reason = "intrinsics of the CPU")]

use super::f32x8::F32x8;

/// The form for every CPU.
#[cfg(any(test, not(all(target_feature = "avx512dq", target_feature = "avx512vl"))))]
mod portable {
    use super::F32x8;
    use crate::math::Real;

    #[inline(always)]
    pub fn least(x: F32x8, y: F32x8) -> F32x8 {
        x.abs().min_or(y.abs())
    }

    #[inline(always)]
    pub fn greatest(x: F32x8, y: F32x8) -> F32x8 {
        x.abs().max_or(y.abs())
    }
}

#[cfg(all(target_feature = "avx512dq", target_feature = "avx512vl"))]
mod range {
    use std::arch::x86_64::_mm256_range_ps;

    use super::F32x8;

    /// Immediate operands: the smaller or the larger of two magnitudes, with the sign bit cleared.
    const LEAST: i32 = 0b1010;
    const GREATEST: i32 = 0b1011;

    #[inline(always)]
    fn range<const WHICH: i32>(x: F32x8, y: F32x8) -> F32x8 {
        // SAFETY: compiled only if the build requires the instruction, and `level` rejects a CPU without it.
        bytemuck::cast(unsafe { _mm256_range_ps::<WHICH>(bytemuck::cast(x), bytemuck::cast(y)) })
    }

    #[inline(always)]
    pub fn least(x: F32x8, y: F32x8) -> F32x8 {
        range::<LEAST>(x, y)
    }

    #[inline(always)]
    pub fn greatest(x: F32x8, y: F32x8) -> F32x8 {
        range::<GREATEST>(x, y)
    }
}

#[cfg(not(all(target_feature = "avx512dq", target_feature = "avx512vl")))]
pub(super) use portable::{greatest, least};
#[cfg(all(target_feature = "avx512dq", target_feature = "avx512vl"))]
pub(super) use range::{greatest, least};

#[cfg(test)]
mod tests {
    use super::*;

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
                assert_eq!(bits(least(x, y)), bits(portable::least(x, y)), "{x:?} {y:?}");
                assert_eq!(bits(greatest(x, y)), bits(portable::greatest(x, y)), "{x:?} {y:?}");
            }
        }
    }
}
