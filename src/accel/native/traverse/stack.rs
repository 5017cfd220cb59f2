//! Traversal stacks of fixed size.

use super::super::node::bvh8::{MAX_DEPTH, NodeRef};

/// The number of entries that the deepest tree can fill.
pub(crate) const STACK_SIZE: usize = 512;

// A visit pops one entry and pushes at most eight: seven more a level, and the root.
const _: () = assert!(STACK_SIZE > 7 * MAX_DEPTH);

/// A node or leaf to visit. It is skipped if a closer hit than `enter` has been found by then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Lower bound of the ray parameter at which any of the rays enters the box.
    pub enter: f32,
    /// The node or leaf.
    pub node: NodeRef,
    /// The ray groups of a tile that hit the box, one bit each; unused for single rays.
    pub groups: u8,
}

impl Entry {
    /// An entry that any ray visits, for filling a stack.
    const EMPTY: Self = Self { enter: 0.0, node: NodeRef::NONE, groups: 0 };
}

/// A traversal stack.
pub(super) type Stack = [Entry; STACK_SIZE];

/// A stack with unspecified content.
pub(super) fn new_stack() -> Box<Stack> {
    Box::new([Entry::EMPTY; STACK_SIZE])
}

/// Sorts the entries that a node has pushed, the nearest last. The order affects speed only.
#[inline(always)]
pub(super) fn sort_nearest_last(pushed: &mut [Entry]) {
    for i in 1..pushed.len() {
        let entry = pushed[i];
        let mut k = i;
        while k > 0 && pushed[k - 1].enter < entry.enter {
            pushed[k] = pushed[k - 1];
            k -= 1;
        }
        pushed[k] = entry;
    }
}
