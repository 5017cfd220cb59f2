//! The default build: top-down, by the surface area heuristic over bins (Wald 2007).
//!
//! The same primitives give the same tree for any number of threads. Splits depend on sums and minima whose order does not
//! matter. The size of a set alone decides if two tasks work on its halves.

use super::super::node::bvh8::{LEAF_SIZE, MAX_DEPTH};
use super::binary::Node2;
use super::primitive::PrimRef;
use super::split::{self, Extent};

/// Sets larger than this are built by two tasks.
pub(super) const PARALLEL: usize = 4096;

/// Builds a tree over `prims`, which are not empty. `prims` is reordered; leaves refer to indices in the new order.
pub(crate) fn build(prims: &mut [PrimRef]) -> Node2 {
    node(prims, &Extent::of(prims), 0, 0)
}

/// Builds the subtree over `prims`, a part of all references that begins at index `first`. Its root is at level `depth`.
pub(crate) fn node(prims: &mut [PrimRef], extent: &Extent, first: u32, depth: usize) -> Node2 {
    let count = prims.len();
    if count <= LEAF_SIZE {
        return Node2::leaf(extent.bounds, first, count as u32);
    }
    // From the last level at which halving still respects the maximum depth, sets are halved.
    let levels_to_halve = count.div_ceil(LEAF_SIZE).next_power_of_two().trailing_zeros() as usize;
    let balanced = depth + levels_to_halve + 1 >= MAX_DEPTH;
    let best = if balanced { None } else { split::best(prims, extent) };
    let (middle, extents) = match best {
        Some(split) => split::partition(prims, &split),
        None => split::halve(prims, extent),
    };
    let (low, high) = prims.split_at_mut(middle);
    let mut left = || node(low, &extents[0], first, depth + 1);
    let mut right = || node(high, &extents[1], first + middle as u32, depth + 1);
    let halves = if count > PARALLEL { rayon::join(left, right) } else { (left(), right()) };
    Node2::inner(extent.bounds, Box::new(halves.into()))
}

#[cfg(test)]
mod tests {
    use super::super::binary::Subtree;
    use super::*;

    /// The deepest leaf below a node, which must be no fuller than leaves may be.
    fn deepest(node: &Node2, depth: usize) -> usize {
        match &node.subtree {
            Subtree::Leaf { count, .. } => {
                assert!((1..=LEAF_SIZE as u32).contains(count));
                depth
            }
            Subtree::Inner(halves) => halves.iter().map(|n| deepest(n, depth + 1)).max().unwrap_or(depth),
        }
    }

    /// Cases BB-05, TR-01 of the catalogue.
    #[test]
    fn no_tree_is_deeper_than_the_stacks_allow_however_late_it_is_noticed() {
        // Each box twice as far away and twice as large as the last: the heuristic cuts off a few at a time.
        let series = |i: usize| 2_f32.powi(i as i32 % 120 - 60);
        for start in 0..=57 {
            let mut prims: Vec<_> =
                (0..500).map(|i| PrimRef::new([series(i); 3], [series(i) * 1.5; 3], 0, i as u32)).collect();
            let extent = Extent::of(&prims);
            let depth = deepest(&node(&mut prims, &extent, 0, start), start);
            assert!(depth <= MAX_DEPTH, "{depth} from {start}");
        }
    }

    #[test]
    fn a_thousand_boxes_in_one_place_are_halved() {
        let mut prims: Vec<_> = (0..1000).map(|i| PrimRef::new([0.0; 3], [1.0; 3], 0, i)).collect();
        let root = build(&mut prims);
        assert_eq!(deepest(&root, 0), 7);
    }
}
