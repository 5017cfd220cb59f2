//! Bounding boxes in world coordinates, and tests of their precision in `f32`.

use glam::DVec3;

/// Distance from 0, in units of an object's size, above which it counts as far. Nearer objects lose at most 4e-6 of
/// their size in `f32`.
pub(super) const FAR: f64 = 64.0;
/// Largest coordinate of a single model, whose unit may be changed; its square is finite in `f64`.
pub(super) const WIDEST: f64 = 1e150;

/// Bounding box in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub lo: DVec3,
    pub hi: DVec3,
}

impl Extent {
    /// Box around nothing.
    pub(super) const EMPTY: Self = Self { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    /// Returns the box around the finite positions.
    pub(super) fn around(places: impl Iterator<Item = DVec3>) -> Self {
        places.filter(|&p| within(p, WIDEST)).fold(Self::EMPTY, |b, p| Self { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    /// Returns the box around this one and a finite position.
    #[inline]
    pub(super) fn with(self, p: DVec3) -> Self {
        Self { lo: self.lo.min(p), hi: self.hi.max(p) }
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lo.x > self.hi.x
    }

    /// Returns the longest side.
    pub(super) fn size(&self) -> f64 {
        (self.hi - self.lo).max_element()
    }

    pub(super) fn centre(&self) -> DVec3 {
        (self.lo + self.hi) * 0.5
    }

    /// Returns the largest coordinate of the box relative to `origin`, by magnitude.
    pub(super) fn reach(&self, origin: DVec3) -> f64 {
        (self.lo - origin).abs().max((self.hi - origin).abs()).max_element()
    }

    /// Returns true if a coordinate exceeds 64 times the size.
    pub(super) fn is_far(&self) -> bool {
        !self.is_empty() && self.reach(DVec3::ZERO) > FAR * self.size()
    }

    /// Returns true if `f32` represents the box's points to within 4e-6 of its size: it is neither far nor tiny.
    pub(super) fn suits_f32(&self) -> bool {
        !self.is_far() && self.size() > f64::from(f32::MIN_POSITIVE) * f64::from(1 << 24)
    }
}

/// Returns true if no coordinate exceeds `limit`.
pub(super) fn within(p: DVec3, limit: f64) -> bool {
    p.abs().cmple(DVec3::splat(limit)).all()
}
