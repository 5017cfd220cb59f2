//! The smaller and the larger of two magnitudes by one instruction, `vrangeps`, for builds that require it.

#![allow(unsafe_code, reason = "intrinsics of the CPU")]

use std::arch::x86_64::_mm256_range_ps;

/// Immediate operands: the smaller or the larger of two magnitudes, with the sign bit cleared.
const LEAST: i32 = 0b1010;
const GREATEST: i32 = 0b1011;

#[inline(always)]
fn range<const WHICH: i32>(x: wide::f32x8, y: wide::f32x8) -> wide::f32x8 {
    // SAFETY: compiled only if the build requires the instruction, and `level` rejects a CPU without it.
    bytemuck::cast(unsafe { _mm256_range_ps::<WHICH>(bytemuck::cast(x), bytemuck::cast(y)) })
}

/// The smaller of the two magnitudes in each lane.
#[inline(always)]
pub fn least(x: wide::f32x8, y: wide::f32x8) -> wide::f32x8 {
    range::<LEAST>(x, y)
}

/// The larger of the two magnitudes in each lane.
#[inline(always)]
pub fn greatest(x: wide::f32x8, y: wide::f32x8) -> wide::f32x8 {
    range::<GREATEST>(x, y)
}
