//! The hierarchy that rays walk: inner nodes of eight children.

use arrayvec::ArrayVec;

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
#[repr(C, align(64))]
pub(super) struct Node8 {
    /// The boxes.
    pub planes: Planes,
    /// What the boxes hold; those that hold something come first, and of them last what is likeliest to block a ray.
    pub children: [Child; 8],
    /// By octant, the eight slots in the order in which rays of the octant pass the centres of their boxes, last ones
    /// first: three bits a slot, the first lowest.
    order: [u32; 8],
}

const _: () = assert!(size_of::<Node8>() == 256);

impl Default for Node8 {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Node8 {
    /// No children.
    pub const EMPTY: Self = Self {
        planes: [[F32x8::INFINITY, F32x8::new([f32::NEG_INFINITY; 8])]; 3],
        children: [Child::NONE; 8],
        order: [0; 8],
    };

    /// Every bit of it.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let planes = self.planes.iter().flatten().flat_map(|p| p.to_array()).map(f32::to_bits);
        planes.chain(self.children.map(|c| c.0)).chain(self.order)
    }

    /// Moves the boxes, with what is in them, so that they come in the order in which `slots` name where they were; those
    /// that hold something stay before the others.
    pub fn reorder(&mut self, slots: [usize; 8]) {
        self.children = slots.map(|from| self.children[from & 7]);
        for planes in self.planes.iter_mut().flatten() {
            let old = planes.to_array();
            *planes = F32x8::new(slots.map(|from| old[from & 7]));
        }
    }

    /// Puts the boxes in order for every octant; to be called when all of them are there.
    pub fn put_in_order(&mut self) {
        for o in 0..4 {
            let along = |slot: usize| {
                let axis = |k: usize| {
                    let twice_centre = self.planes[k][0].lane(slot) + self.planes[k][1].lane(slot);
                    if o >> k & 1 == 0 { twice_centre } else { -twice_centre }
                };
                axis(0) + axis(1) + axis(2)
            };
            // What is not a number (of absent children, or of boxes beyond all measure) goes anywhere.
            let mut slots: [usize; 8] = std::array::from_fn(|slot| slot);
            let far = slots.map(along);
            slots.sort_unstable_by(|&a, &b| far[b].total_cmp(&far[a]).then(a.cmp(&b)));
            let packed = |order: u32, &slot: &usize| order << 3 | slot as u32;
            self.order[o] = slots.iter().rev().fold(0, packed);
            // Who runs the other way passes them the other way round.
            self.order[7 - o] = slots.iter().fold(0, packed);
        }
    }

    /// Of the slots in `met`, those first whose centres rays of octant `o` pass last.
    #[inline(always)]
    pub fn far_to_near(&self, o: usize, met: u8) -> ArrayVec<u8, 8> {
        let mut order = self.order[o & 7];
        let (mut slots, mut count) = ([0_u8; 8], 0);
        // Each place is written, and kept only where the slot is met: no branch to guess.
        for _ in 0..8 {
            let slot = (order & 7) as u8;
            slots[count & 7] = slot;
            count += usize::from(met >> slot & 1);
            order >>= 3;
        }
        let mut first = ArrayVec::from(slots);
        first.truncate(count);
        first
    }

    /// The planes of the eight boxes in the order in which rays of an octant reach them: near ones, far ones.
    #[inline(always)]
    pub fn sorted(&self, octant: [usize; 3]) -> (Vec3x8, Vec3x8) {
        let near = |axis: usize| self.planes[axis][octant[axis] & 1];
        let far = |axis: usize| self.planes[axis][(octant[axis] & 1) ^ 1];
        (Vec3x8::new(near(0), near(1), near(2)), Vec3x8::new(far(0), far(1), far(2)))
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
