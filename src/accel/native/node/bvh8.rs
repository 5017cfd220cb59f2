//! The eight-wide bounding volume hierarchy that rays traverse.

use arrayvec::ArrayVec;

use super::super::ray::packet8::Packet8;
use crate::geometry::Aabb8;
use crate::math::Real;
use crate::simd::{F32x8, Vec3x8, prefetch};

/// The maximum number of primitives in a leaf.
pub(crate) const LEAF_SIZE: usize = 8;

/// The maximum number of levels of inner nodes in a tree. It sizes the stacks of every traversal.
pub(crate) const MAX_DEPTH: usize = 64;

/// Reference to an inner node or a leaf by index, or to nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct NodeRef(u32);

impl NodeRef {
    /// Reference to nothing.
    pub const NONE: Self = Self(u32::MAX);
    const LEAF: u32 = 1 << 31;

    /// Reference to the inner node with index `i` (below 2^31).
    pub fn node(i: usize) -> Self {
        debug_assert!(i < Self::LEAF as usize);
        Self(i as u32)
    }

    /// Reference to the leaf with index `i` (below 2^31 - 1).
    pub fn leaf(i: usize) -> Self {
        debug_assert!(i < (Self::LEAF - 1) as usize);
        Self(i as u32 | Self::LEAF)
    }

    /// Returns true for a leaf, and for [`NodeRef::NONE`].
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// Index among the inner nodes, or among the leaves.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

/// An inner node: eight child slots, each with a box and a reference, in structure-of-arrays.
///
/// Boxes of empty slots are inside out, so that no ray hits them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node8 {
    /// Boxes of the children.
    pub boxes: Aabb8,
    /// Children. Filled slots come first; the last filled slot holds the likeliest blocker
    /// ([`super::super::build::child_order`]).
    pub children: [NodeRef; 8],
    /// For each octant, the slots from the farthest box centre to the nearest, seen along the octant's diagonal. Three
    /// bits a slot, the first slot in the lowest bits.
    order: [u32; 8],
}

const _: () = assert!(size_of::<Node8>() == 256);

impl Default for Node8 {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Node8 {
    /// A node without children.
    pub const EMPTY: Self = Self { boxes: Aabb8::EMPTY, children: [NodeRef::NONE; 8], order: [0; 8] };

    /// All bits of the node.
    pub fn words(&self) -> impl Iterator<Item = u32> {
        let planes = self.boxes.planes.iter().flatten().flat_map(|p| p.to_array()).map(f32::to_bits);
        planes.chain(self.children.map(|c| c.0)).chain(self.order)
    }

    /// Permutes the slots: slot `i` takes the content of slot `slots[i]`. Filled slots must stay before empty ones.
    pub fn permute(&mut self, slots: [usize; 8]) {
        self.children = slots.map(|from| self.children[from & 7]);
        for planes in self.boxes.planes.iter_mut().flatten() {
            let old = planes.to_array();
            *planes = F32x8::new(slots.map(|from| old[from & 7]));
        }
    }

    /// Computes the order of the slots for every octant. Call it after the last change of the boxes.
    pub fn sort_octants(&mut self) {
        for o in 0..4 {
            let along = |slot: usize| {
                let axis = |k: usize| {
                    let [lo, hi] = &self.boxes.planes[k];
                    let twice_centre = lo.lane(slot) + hi.lane(slot);
                    if o >> k & 1 == 0 { twice_centre } else { -twice_centre }
                };
                axis(0) + axis(1) + axis(2)
            };
            // Empty slots and boxes that overflow give NaN. Their position in the order does not matter.
            let mut slots: [usize; 8] = std::array::from_fn(|slot| slot);
            let far = slots.map(along);
            slots.sort_unstable_by(|&a, &b| far[b].total_cmp(&far[a]).then(a.cmp(&b)));
            let packed = |order: u32, &slot: &usize| order << 3 | slot as u32;
            self.order[o] = slots.iter().rev().fold(0, packed);
            // The opposite octant has the opposite order.
            self.order[7 - o] = slots.iter().fold(0, packed);
        }
    }

    /// Lists the slots in `hit`, those first whose box centres rays of octant `o` (bits, x lowest) pass last.
    #[inline(always)]
    pub fn far_to_near(&self, o: usize, hit: u8) -> ArrayVec<u8, 8> {
        let mut order = self.order[o & 7];
        let (mut slots, mut count) = ([0_u8; 8], 0);
        // Every slot is written and only kept if it is hit: no branch to mispredict.
        for _ in 0..8 {
            let slot = (order & 7) as u8;
            slots[count & 7] = slot;
            count += usize::from(hit >> slot & 1);
            order >>= 3;
        }
        let mut first = ArrayVec::from(slots);
        first.truncate(count);
        first
    }
}

/// An eight-wide hierarchy over leaves of type `L`. Empty if there are no primitives.
#[derive(Clone, Debug)]
pub(crate) struct Bvh8<L> {
    /// Inner nodes, parents before children.
    pub nodes: Vec<Node8>,
    /// Leaves.
    pub leaves: Vec<L>,
    /// The root; [`NodeRef::NONE`] in an empty tree.
    pub root: NodeRef,
    /// Levels of inner nodes, at most [`MAX_DEPTH`].
    pub depth: usize,
}

impl<L> Bvh8<L> {
    /// Size of nodes and leaves in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.leaves.as_slice())
    }

    /// Prefetches a node or leaf into the cache.
    #[inline(always)]
    pub fn prefetch(&self, node: NodeRef) {
        if node.is_leaf() {
            prefetch(&self.leaves[node.index()]);
        } else {
            prefetch(&self.nodes[node.index()]);
        }
    }

    /// Returns the lanes of `lanes` whose ray hits the box of a child of the root; all of them if the root is a leaf.
    #[inline(always)]
    pub fn lanes_reaching(&self, rays: &Packet8, lanes: u8) -> u8 {
        if self.root.is_leaf() {
            return if self.root == NodeRef::NONE { 0 } else { lanes };
        }
        let planes = &self.nodes[self.root.index()].boxes.planes;
        let mut reached = 0;
        for c in 0..8 {
            let corner = |side: usize| {
                let at = |axis: usize| F32x8::from(planes[axis][side].lane(c));
                Vec3x8::new(at(0), at(1), at(2))
            };
            let (enter, leave) = rays.slab.clip(corner(0), corner(1), rays.t_min, rays.t_max);
            reached |= enter.le(leave).bits();
            if reached & lanes == lanes {
                break;
            }
        }
        reached & lanes
    }
}
