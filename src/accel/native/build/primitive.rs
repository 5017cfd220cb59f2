//! References to primitives and their boxes, as builders sort them.

use crate::math::Real;
use crate::simd::F32x8;

/// A reference to a primitive: its box and its ids.
///
/// Lanes: lower corner, geometry id, negated upper corner, primitive id. So one minimum unites two boxes. The ids are bit
/// patterns; in a union of boxes their lanes are undefined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrimRef(pub F32x8);

impl PrimRef {
    /// A reference to a primitive in the box between `lo` and `hi`.
    #[inline(always)]
    pub fn new(lo: [f32; 3], hi: [f32; 3], geometry: u32, primitive: u32) -> Self {
        let (geometry, primitive) = (f32::from_bits(geometry), f32::from_bits(primitive));
        Self(F32x8::new([lo[0], lo[1], lo[2], geometry, -hi[0], -hi[1], -hi[2], primitive]))
    }

    /// The reference of a primitive that cannot be hit.
    pub const NONE: Self = Self(F32x8::INFINITY);

    /// Returns true for [`PrimRef::NONE`].
    pub fn is_none(&self) -> bool {
        self.0.lane(0) == f32::INFINITY
    }

    /// Ids, as `(geometry, primitive)`.
    #[inline(always)]
    pub fn id(&self) -> (u32, u32) {
        (self.0.lane(3).to_bits(), self.0.lane(7).to_bits())
    }

    /// Twice the centre of the box in lanes 0..3, and its negative in lanes 4..7. Lanes 3 and 7 are undefined.
    #[inline(always)]
    pub fn twice_centres(&self) -> F32x8 {
        let [a, b, c, d, e, f, g, h] = self.0.to_array();
        self.0 - F32x8::new([e, f, g, h, a, b, c, d])
    }

    /// Twice the centre of the box, along one axis.
    #[inline(always)]
    pub fn twice_centre(&self, axis: usize) -> f32 {
        self.0.lane(axis) - self.0.lane(axis + 4)
    }
}

/// A box in the lanes of a [`PrimRef`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds(pub F32x8);

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self(F32x8::INFINITY);

    /// The smallest box around both.
    #[inline(always)]
    pub fn union(self, other: F32x8) -> Self {
        Self(self.0.min_or(other))
    }

    /// Lower corner.
    #[inline(always)]
    pub fn lo(&self) -> [f32; 3] {
        let [x, y, z, ..] = self.0.to_array();
        [x, y, z]
    }

    /// Upper corner.
    #[inline(always)]
    pub fn hi(&self) -> [f32; 3] {
        let [.., x, y, z, _] = self.0.to_array();
        [-x, -y, -z]
    }

    /// Half the surface area; 0 for an empty box.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        let [a, b, c, _, d, e, f, _] = self.0.to_array();
        let length = |lo: f32, negated_hi: f32| (-negated_hi - lo).max_or(0.0);
        half_area(length(a, d), length(b, e), length(c, f))
    }
}

/// Half the surface area of a box with these edge lengths.
#[inline(always)]
pub(crate) fn half_area<R: Real>(x: R, y: R, z: R) -> R {
    x * (y + z) + y * z
}
