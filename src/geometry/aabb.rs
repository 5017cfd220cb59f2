//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box; empty where any `lo` exceeds its `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub lo: Vec3,
    /// Upper corner.
    pub hi: Vec3,
}

impl Aabb {
    /// The box that holds nothing and that any union replaces.
    pub const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    /// The smallest box around `points`.
    #[must_use]
    pub fn of(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, &p| b.with(p))
    }

    /// This box, grown to hold `p`.
    #[inline(always)]
    #[must_use]
    pub fn with(self, p: Vec3) -> Self {
        Self { lo: self.lo.min(p), hi: self.hi.max(p) }
    }

    /// The smallest box around both.
    #[inline(always)]
    #[must_use]
    pub fn union(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Whether it holds no point.
    #[inline(always)]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.lo.cmple(self.hi).all()
    }

    /// Whether `o` lies wholly inside (closed boxes).
    #[must_use]
    pub fn contains(&self, o: &Self) -> bool {
        self.lo.cmple(o.lo).all() && self.hi.cmpge(o.hi).all()
    }

    /// Half the surface area, the weight of the surface area heuristic; 0 for an empty box.
    #[inline(always)]
    #[must_use]
    pub fn half_area(&self) -> f32 {
        let e = (self.hi - self.lo).max(Vec3::ZERO);
        e.x * (e.y + e.z) + e.y * e.z
    }

    /// Edge lengths; negative infinity for an empty box.
    #[inline(always)]
    #[must_use]
    pub fn extent(&self) -> Vec3 {
        self.hi - self.lo
    }

    /// The middle, halved before adding so that it cannot overflow.
    #[inline(always)]
    #[must_use]
    pub fn centre(&self) -> Vec3 {
        self.lo * 0.5 + self.hi * 0.5
    }

    /// Length of the space diagonal; 0 for an empty box.
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.extent().length() }
    }
}
