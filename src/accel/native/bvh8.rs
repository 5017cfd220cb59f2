//! The hierarchy that rays walk: inner nodes of eight children.

use super::rays::One;
use super::stack::STACK_SIZE;
use crate::geometry::slab::widened;
use crate::math::Real;
use crate::simd::{F32x8, Vec3x8};

/// An inner node, a leaf, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct Child(u32);

impl Child {
    /// No child.
    pub const NONE: Self = Self(u32::MAX);
    const LEAF: u32 = 1 << 31;

    /// The inner node in place `i` (below 2^31).
    pub fn node(i: usize) -> Self {
        debug_assert!(i < Self::LEAF as usize);
        Self(i as u32)
    }

    /// The leaf in place `i` (below 2^31 - 1).
    pub fn leaf(i: usize) -> Self {
        debug_assert!(i < (Self::LEAF - 1) as usize);
        Self(i as u32 | Self::LEAF)
    }

    /// Whether it is a leaf (or nothing).
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// Its place among the nodes, or among the leaves.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

/// Eight boxes: planes by axis, lower ones first, so that a ray's octant indexes its near planes.
pub(super) type Planes = [[F32x8; 2]; 3];

/// An inner node: eight boxes in structure-of-arrays, and what is in them.
///
/// Boxes of absent children are inside out, which no ray meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Node8 {
    /// The boxes.
    pub planes: Planes,
    /// What the boxes hold; those that hold something come first.
    pub children: [Child; 8],
}

const _: () = assert!(size_of::<Node8>() == 224);

impl Node8 {
    /// No children.
    pub const EMPTY: Self =
        Self { planes: [[F32x8::INFINITY, F32x8::new([f32::NEG_INFINITY; 8])]; 3], children: [Child::NONE; 8] };

    /// Every bit of it.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let planes = self.planes.iter().flatten().flat_map(|p| p.to_array()).map(f32::to_bits);
        planes.chain(self.children.map(|c| c.0))
    }

    /// One ray against the eight boxes, for `t` up to `t_max`: which are met, and where they are entered.
    #[inline(always)]
    pub fn meet_one(&self, ray: &One, t_max: F32x8) -> (u8, F32x8) {
        let near = |axis: usize| self.planes[axis][ray.octant[axis] & 1];
        let far = |axis: usize| self.planes[axis][(ray.octant[axis] & 1) ^ 1];
        let near = Vec3x8::new(near(0), near(1), near(2));
        let far = Vec3x8::new(far(0), far(1), far(2));
        let (enter, leave) = ray.slab.clip_sorted(near, far, ray.t_min, t_max);
        (enter.le(leave).bits(), enter)
    }
}

/// Inner nodes, leaves and where to begin. Empty where there are no primitives.
#[derive(Clone, Debug)]
pub(super) struct Bvh8<L> {
    /// Inner nodes, parents before children.
    pub nodes: Vec<Node8>,
    /// Leaves.
    pub leaves: Vec<L>,
    /// Where to begin; [`Child::NONE`] where there is nothing.
    pub root: Child,
    /// Levels of inner nodes; at most [`super::bvh2::MAX_DEPTH`].
    pub depth: usize,
}

impl<L> Bvh8<L> {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.leaves.as_slice())
    }
}

// A visit takes one entry away and adds at most eight.
const _: () = assert!(STACK_SIZE > 7 * super::bvh2::MAX_DEPTH);

/// The end of the slab interval of each lane, as [`crate::geometry::slab`] means it.
#[inline(always)]
pub(super) fn leave_of(far: Vec3x8, t_max: F32x8) -> F32x8 {
    widened(far.x.min_or(far.y.min_or(far.z.min_or(t_max))))
}
