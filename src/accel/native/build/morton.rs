//! The fast build: primitives in the order of a Morton curve (Lauterbach et al. 2009), split where the bits of the curve
//! change.

use rayon::prelude::*;

use super::binary::Node2;
use super::primitive::{Bounds, PrimRef};
use super::sah::{self, PARALLEL};
use super::split::Extent;

/// Sets of at most this many primitives are split by the surface area heuristic, which fills leaves better.
const SMALL: usize = 32;

/// Bits of the curve per axis.
const BITS: u32 = 10;

/// Primitives whose box has more than this share of the surface area of the whole box are kept out of the curve. Anywhere
/// on the curve they would enlarge every box above them.
const LARGE: f32 = 1.0 / 512.0;

/// Builds a tree over `prims`, which are not empty. `prims` is reordered; leaves refer to indices in the new order.
pub(super) fn build(prims: &mut [PrimRef]) -> Node2 {
    let extent = Extent::of(prims);
    let (grid, large) = (extent.grid(1 << BITS), extent.bounds.half_area() * LARGE);
    // Large primitives last, then the order of the curve, then the order of the slice.
    let key = |(i, p): (usize, &PrimRef)| {
        let is_large = u64::from(Bounds(p.0).half_area() > large) << (3 * BITS);
        (is_large | code(grid.cell(p))) << 32 | i as u64
    };
    let mut order: Vec<u64> = prims.par_iter().enumerate().map(key).collect();
    order.par_sort_unstable();
    let sorted: Vec<PrimRef> = order.par_iter().map(|&o| prims[(o & u64::from(u32::MAX)) as usize]).collect();
    prims.copy_from_slice(&sorted);
    let small = order.partition_point(|o| o >> (32 + 3 * BITS) == 0);
    let (low, high) = prims.split_at_mut(small);
    match (low.is_empty(), high.is_empty()) {
        (true, _) => sah::node(high, &extent, 0, 0),
        (_, true) => node(low, &order, 0, 0),
        _ => {
            let large = sah::node(high, &Extent::of(high), small as u32, 1);
            Node2::inner(extent.bounds, Box::new([node(low, &order[..small], 0, 1), large]))
        }
    }
}

/// Interleaves the bits of three numbers below 2^[`BITS`].
fn code(cell: [i32; 3]) -> u64 {
    let spread = |x: i32| {
        let x = (x as u64 | (x as u64) << 16) & 0x0300_00ff;
        let x = (x | x << 8) & 0x0300_f00f;
        let x = (x | x << 4) & 0x030c_30c3;
        (x | x << 2) & 0x0924_9249
    };
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

/// Builds a subtree of primitives in the order of the curve. It has at most 30 levels for the bits of the curve, and one for
/// each halving of the primitives in a single cell.
fn node(prims: &mut [PrimRef], order: &[u64], first: u32, depth: usize) -> Node2 {
    let count = prims.len();
    if count <= SMALL {
        return sah::node(prims, &Extent::of(prims), first, depth);
    }
    let (low, high) = (order[0] >> 32, order[count - 1] >> 32);
    let middle = match (low ^ high).checked_ilog2() {
        Some(bit) => order.partition_point(|o| o >> (32 + bit) & 1 == 0),
        None => count / 2,
    };
    let (low, high) = prims.split_at_mut(middle);
    let mut left = || node(low, &order[..middle], first, depth + 1);
    let mut right = || node(high, &order[middle..], first + middle as u32, depth + 1);
    let halves = if count > PARALLEL { rayon::join(left, right) } else { (left(), right()) };
    let bounds = halves.0.bounds().union(halves.1.bounds().0);
    Node2::inner(bounds, Box::new(halves.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bits_of_a_code_take_turns() {
        assert_eq!(code([1023, 0, 0]), 0x0924_9249);
        assert_eq!(code([1023, 1023, 1023]), (1 << 30) - 1);
        for bit in 0..10 {
            assert_eq!(
                [code([1 << bit, 0, 0]), code([0, 1 << bit, 0]), code([0, 0, 1 << bit])],
                [1, 2, 4].map(|k| k << (3 * bit))
            );
        }
    }
}
