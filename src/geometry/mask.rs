//! Classes of geometry.

/// A set of geometry classes: those a shape belongs to, or those a ray can hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct GeometryMask(pub u8);

impl GeometryMask {
    /// Opaque surfaces.
    pub const OPAQUE: Self = Self(1);
    /// Surfaces that transmit light.
    pub const TRANSMISSIVE: Self = Self(2);
    /// All surfaces.
    pub const ALL: Self = Self(3);

    /// Returns true if the two sets share a class.
    #[inline(always)]
    #[must_use]
    pub const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

impl Default for GeometryMask {
    fn default() -> Self {
        Self::ALL
    }
}
