//! Eight-lane numbers, masks and three-vectors over `wide`, and operations that `wide` lacks, each with a portable form.

mod bits;
mod f32x8;
pub mod level;
#[cfg(all(target_feature = "avx512dq", target_feature = "avx512vl"))]
mod magnitude;
mod mask8;
mod memory;
mod reciprocal;

pub use bits::{compress, set_lanes, transpose_bits};
pub use f32x8::F32x8;
pub use mask8::Mask8;
pub use memory::{prefetch, room_for};
pub use reciprocal::{Division, Estimate, Guess, NewtonStep, Reciprocal, ReciprocalModel, ReciprocalVisitor};

/// Eight three-vectors in structure-of-arrays.
pub type Vec3x8 = crate::math::Vector3<F32x8>;

impl Vec3x8 {
    /// The vector in lane `i` (0..8).
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, i: usize) -> glam::Vec3 {
        glam::Vec3::new(self.x.lane(i), self.y.lane(i), self.z.lane(i))
    }

    /// Puts `v` into lane `i` (0..8).
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, v: glam::Vec3) {
        self.x.set_lane(i, v.x);
        self.y.set_lane(i, v.y);
        self.z.set_lane(i, v.z);
    }

    /// The same vector in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(v: glam::Vec3) -> Self {
        Self::new(F32x8::from(v.x), F32x8::from(v.y), F32x8::from(v.z))
    }
}
