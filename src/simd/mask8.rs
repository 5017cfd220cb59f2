//! Masks of eight lanes, as comparisons return them.

use std::ops::{BitAnd, BitAndAssign, BitOr, BitOrAssign, Not};

use crate::math::LaneMask;

/// Eight truth values, one a lane: all bits of the lane set, or none.
///
/// Only comparisons and [`Mask8::from_bits`] create masks, so that the sign bit of a NaN is never taken for `true`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Mask8(pub(super) wide::f32x8);

/// One lane bit per 32-bit lane, to test a bit pattern against.
const LANE_BITS: [i32; 8] = [1, 2, 4, 8, 16, 32, 64, 128];

impl Mask8 {
    /// No lane.
    pub const NONE: Self = Self(wide::f32x8::new([0.0; 8]));
    /// Every lane.
    pub const ALL: Self = Self(wide::f32x8::new([f32::from_bits(u32::MAX); 8]));

    /// Lanes whose bit is set, lane 0 lowest.
    #[inline(always)]
    #[must_use]
    pub fn from_bits(bits: u8) -> Self {
        let lane_bits = wide::i32x8::new(LANE_BITS);
        let here = wide::i32x8::splat(i32::from(bits)) & lane_bits;
        Self(bytemuck::cast(here.simd_eq(lane_bits)))
    }

    /// The lanes `0..n`, all of them for `n >= 8`.
    #[inline(always)]
    #[must_use]
    pub fn first(n: usize) -> Self {
        Self::from_bits(first_bits(n))
    }

    /// The mask as bits, lane 0 lowest.
    #[inline(always)]
    #[must_use]
    pub fn bits(self) -> u8 {
        self.0.to_bitmask() as u8
    }

    /// Number of true lanes.
    #[inline(always)]
    #[must_use]
    pub fn count(self) -> u32 {
        self.bits().count_ones()
    }

    /// Returns true if lane `i` (0..8) is true.
    #[inline(always)]
    #[must_use]
    pub fn lane(self, i: usize) -> bool {
        self.bits() >> i & 1 != 0
    }

    /// Returns true if no lane is true.
    #[inline(always)]
    #[must_use]
    pub fn none(self) -> bool {
        self.bits() == 0
    }
}

/// Bits of the lanes `0..n`.
#[inline(always)]
fn first_bits(n: usize) -> u8 {
    if n >= 8 { u8::MAX } else { (1_u8 << n) - 1 }
}

impl Default for Mask8 {
    fn default() -> Self {
        Self::NONE
    }
}

impl PartialEq for Mask8 {
    fn eq(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }
}

impl Eq for Mask8 {}

impl LaneMask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        if value { Self::ALL } else { Self::NONE }
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == u8::MAX
    }
}

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(self.0 & o.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(self.0 | o.0)
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl BitAndAssign for Mask8 {
    #[inline(always)]
    fn bitand_assign(&mut self, o: Self) {
        *self = *self & o;
    }
}

impl BitOrAssign for Mask8 {
    #[inline(always)]
    fn bitor_assign(&mut self, o: Self) {
        *self = *self | o;
    }
}

#[cfg(test)]
mod tests {
    use super::super::f32x8::F32x8;
    use super::*;

    /// Case LN-07 of the catalogue.
    #[test]
    fn bits_go_in_and_come_out_for_every_pattern() {
        for bits in 0..=u8::MAX {
            let m = Mask8::from_bits(bits);
            assert_eq!(m.bits(), bits);
            assert_eq!((!m).bits(), !bits);
            assert_eq!(m.count(), bits.count_ones());
            assert_eq!(m.any(), bits != 0);
            assert_eq!(m.all(), bits == 255);
            let s = m.select(F32x8::ONE, F32x8::ZERO).to_array();
            for (i, x) in s.into_iter().enumerate() {
                assert_eq!(x == 1.0, bits >> i & 1 != 0);
            }
        }
        assert_eq!(Mask8::first(3).bits(), 0b111);
        assert_eq!(Mask8::first(8).bits(), 255);
    }
}
