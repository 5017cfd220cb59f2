//! Ids and geometry masks of the primitives in a leaf.

use crate::geometry::NO_GEOMETRY;

/// Ids and masks of the primitives in a leaf.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Tags {
    /// Geometry ids.
    pub geometry: [u32; 8],
    /// Primitive ids.
    pub primitive: [u32; 8],
    /// Geometry masks, one byte a slot; 0 in empty slots, which no ray admits.
    masks: u64,
    /// Number of filled slots. Filled slots come first.
    count: u64,
}

impl Tags {
    /// Tags of at most eight primitives, given as `(geometry, primitive, mask)`.
    pub fn new(of: impl Iterator<Item = (u32, u32, u8)>) -> Self {
        let mut tags = Self { geometry: [NO_GEOMETRY; 8], primitive: [0; 8], masks: 0, count: 0 };
        for (i, (geometry, primitive, mask)) in of.enumerate() {
            tags.geometry[i] = geometry;
            tags.primitive[i] = primitive;
            tags.masks |= u64::from(mask) << (8 * i);
            tags.count += 1;
        }
        tags
    }

    /// All bits of the tags.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let (masks, count) = (self.masks, self.count);
        let rest = [masks as u32, (masks >> 32) as u32, count as u32];
        self.geometry.into_iter().chain(self.primitive).chain(rest)
    }

    /// Number of filled slots.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// Returns the slots whose geometry mask shares a bit with `admits`.
    #[inline(always)]
    pub fn admitted(&self, admits: u8) -> u8 {
        const LOW7: u64 = 0x7f7f_7f7f_7f7f_7f7f;
        let shared = self.masks & (u64::from(admits) * 0x0101_0101_0101_0101);
        // Sets the top bit of each byte that is not zero, then packs the eight top bits into one byte.
        let top = (((shared & LOW7) + LOW7) | shared) & !LOW7;
        ((top >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_is_admitted_where_it_shares_a_kind() {
        let masks = [0_u8, 1, 2, 3, 4, 128, 255, 0];
        for filled in 0..=8 {
            let tags = Tags::new(masks[..filled].iter().map(|&m| (7, 9, m)));
            assert_eq!(tags.count(), filled);
            for admits in 0..=u8::MAX {
                let want = masks[..filled].iter().enumerate().fold(0, |b, (i, m)| b | u8::from(m & admits != 0) << i);
                assert_eq!(tags.admitted(admits), want, "{admits:08b}");
            }
        }
    }
}
