//! Axis-aligned boxes.

use glam::Vec3;

use crate::simd::{F32x8, Vec3x8};

/// An axis-aligned box; empty where any `lo` exceeds its `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub lo: Vec3,
    /// Upper corner.
    pub hi: Vec3,
}

impl Aabb {
    /// The empty box, the neutral element of [`Aabb::union`].
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

    /// The smallest box around both boxes.
    #[inline(always)]
    #[must_use]
    pub fn union(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Returns true if the box contains no point.
    #[inline(always)]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.lo.cmple(self.hi).all()
    }

    /// Returns true if `o` lies inside this box. Both boxes are closed.
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

    /// The centre. Corners are halved before they are added, so that the sum cannot overflow.
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

/// The octant of a direction: for each axis, 1 where the ray runs towards lower coordinates, else 0. It is the index of
/// the near planes in [`Aabb8::planes`].
pub type Octant = [usize; 3];

/// Eight boxes in structure-of-arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Aabb8 {
    /// Planes by axis: lower coordinates first, then upper ones.
    pub planes: [[F32x8; 2]; 3],
}

impl Aabb8 {
    /// Eight inside-out boxes, which no ray meets.
    pub const EMPTY: Self = Self { planes: [[F32x8::INFINITY, F32x8::new([f32::NEG_INFINITY; 8])]; 3] };

    /// The boxes between lower corners `lo` and upper corners `hi`.
    #[inline(always)]
    #[must_use]
    pub fn new(lo: Vec3x8, hi: Vec3x8) -> Self {
        Self { planes: [[lo.x, hi.x], [lo.y, hi.y], [lo.z, hi.z]] }
    }

    /// Puts the box between `lo` and `hi` into lane `i` (0..8).
    pub fn set_lane(&mut self, i: usize, lo: [f32; 3], hi: [f32; 3]) {
        for (planes, ends) in self.planes.iter_mut().zip(lo.into_iter().zip(hi)) {
            planes[0].set_lane(i, ends.0);
            planes[1].set_lane(i, ends.1);
        }
    }

    /// The plane of each box that rays of `octant` reach first along `axis`.
    #[inline(always)]
    #[must_use]
    pub fn near(&self, axis: usize, octant: Octant) -> F32x8 {
        self.planes[axis][octant[axis] & 1]
    }

    /// The plane of each box that rays of `octant` reach last along `axis`.
    #[inline(always)]
    #[must_use]
    pub fn far(&self, axis: usize, octant: Octant) -> F32x8 {
        self.planes[axis][(octant[axis] & 1) ^ 1]
    }

    /// The near planes of the eight boxes for rays of `octant`, and the far planes.
    #[inline(always)]
    #[must_use]
    pub fn sorted(&self, octant: Octant) -> (Vec3x8, Vec3x8) {
        let (near, far) = (|axis| self.near(axis, octant), |axis| self.far(axis, octant));
        (Vec3x8::new(near(0), near(1), near(2)), Vec3x8::new(far(0), far(1), far(2)))
    }

    /// As [`Aabb8::sorted`] for the box in lane `i` alone, in all lanes of the result.
    #[inline(always)]
    #[must_use]
    pub fn sorted_lane(&self, octant: Octant, i: usize) -> (Vec3x8, Vec3x8) {
        // Lanes are read in place: a plane returned by value goes through the stack.
        let near = |axis: usize| F32x8::from(self.planes[axis][octant[axis] & 1].lane(i));
        let far = |axis: usize| F32x8::from(self.planes[axis][(octant[axis] & 1) ^ 1].lane(i));
        (Vec3x8::new(near(0), near(1), near(2)), Vec3x8::new(far(0), far(1), far(2)))
    }
}
