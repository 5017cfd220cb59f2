//! The binary hierarchy that a build makes first: top-down, by the surface area heuristic over bins (Wald 2007).
//!
//! The same primitives give the same tree for any number of threads: where to split is decided from sums and minima
//! whose order does not matter, and who works on which half is decided by size alone.

use super::split;
use crate::math::Real;
use crate::simd::F32x8;

/// Primitives a leaf can hold.
pub(super) const LEAF_SIZE: usize = 8;

/// Levels of inner nodes that no tree exceeds; it sizes the stacks of every traversal.
pub(super) const MAX_DEPTH: usize = 64;

/// Sets larger than this are split by two tasks.
pub(super) const PARALLEL: usize = 4096;

/// A primitive to sort: the box that stands for it, and who it is.
///
/// Lanes: lower corner, geometry, upper corner negated, primitive; so that one minimum unites two boxes. The two ids
/// are bit patterns, and their lanes of a union mean nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrimRef(pub F32x8);

impl PrimRef {
    /// From a box and ids.
    #[inline(always)]
    pub fn new(lo: [f32; 3], hi: [f32; 3], geometry: u32, primitive: u32) -> Self {
        let (geometry, primitive) = (f32::from_bits(geometry), f32::from_bits(primitive));
        Self(F32x8::new([lo[0], lo[1], lo[2], geometry, -hi[0], -hi[1], -hi[2], primitive]))
    }

    /// Stands for what cannot be hit.
    pub const NONE: Self = Self(F32x8::INFINITY);

    /// Whether it stands for nothing.
    pub fn is_none(&self) -> bool {
        self.0.lane(0) == f32::INFINITY
    }

    /// `(geometry, primitive)`.
    #[inline(always)]
    pub fn id(&self) -> (u32, u32) {
        (self.0.lane(3).to_bits(), self.0.lane(7).to_bits())
    }

    /// Twice the centre of the box by axis; a lane that means nothing; the same negated; another one.
    #[inline(always)]
    pub fn twice_centres(&self) -> F32x8 {
        let [a, b, c, d, e, f, g, h] = self.0.to_array();
        self.0 - F32x8::new([e, f, g, h, a, b, c, d])
    }

    /// Twice the centre of the box, along one axis.
    #[inline(always)]
    pub fn twice_centre(&self, axis: usize) -> f32 {
        self.0.lane(axis) - self.0.lane(axis + 4)
    }
}

/// A box in the lanes of a [`PrimRef`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds(pub F32x8);

impl Bounds {
    /// Holds nothing.
    pub const EMPTY: Self = Self(F32x8::INFINITY);

    /// The smallest box around both.
    #[inline(always)]
    pub fn union(self, other: F32x8) -> Self {
        Self(self.0.min_or(other))
    }

    /// Lower corner.
    #[inline(always)]
    pub fn lo(&self) -> [f32; 3] {
        let [x, y, z, ..] = self.0.to_array();
        [x, y, z]
    }

    /// Upper corner.
    #[inline(always)]
    pub fn hi(&self) -> [f32; 3] {
        let [.., x, y, z, _] = self.0.to_array();
        [-x, -y, -z]
    }

    /// Half the surface area; 0 for an empty box.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        let [a, b, c, _, d, e, f, _] = self.0.to_array();
        let length = |lo: f32, negated_hi: f32| (-negated_hi - lo).max_or(0.0);
        half_area(length(a, d), length(b, e), length(c, f))
    }
}

/// Half the surface of a box with these edges.
#[inline(always)]
pub(super) fn half_area<R: Real>(x: R, y: R, z: R) -> R {
    x * (y + z) + y * z
}

/// What a visit to a node of eight costs, in visits to a leaf.
const WIDE_COST: f32 = 1.0;

/// Children of a node.
const WIDTH: usize = 8;

/// A node of the binary tree, with the box around what it holds.
#[derive(Debug)]
pub(super) struct Node2 {
    pub lo: [f32; 3],
    pub hi: [f32; 3],
    pub kind: Kind,
    /// By `i`, what its best division into at most `i + 1` leaves and nodes of eight costs a ray: surface areas times
    /// costs of a visit.
    cost: [f32; WIDTH],
}

/// What a node of the binary tree holds.
#[derive(Debug)]
pub(super) enum Kind {
    /// Primitives, from the place `first` on; 1 to [`LEAF_SIZE`].
    Leaf { first: u32, count: u32 },
    /// Two halves.
    Inner(Box<[Node2; 2]>),
}

impl Node2 {
    /// Of `count` primitives from `first` on.
    pub fn leaf(bounds: Bounds, first: u32, count: u32) -> Self {
        let kind = Kind::Leaf { first, count };
        Self { lo: bounds.lo(), hi: bounds.hi(), kind, cost: [bounds.half_area(); WIDTH] }
    }

    /// By dynamic programming (Ylitie, Karras, Laine 2017): one that becomes a node of eight shares out eight among its
    /// halves, one that does not shares out what it is given.
    pub fn inner(bounds: Bounds, halves: Box<[Self; 2]>) -> Self {
        let (a, b) = (&halves[0].cost, &halves[1].cost);
        let mut cost = [f32::INFINITY; WIDTH];
        for room in 2..=WIDTH {
            for k in 1..room {
                cost[room - 1] = (a[k - 1] + b[room - k - 1]).min_or(cost[room - 1]);
            }
        }
        cost[0] = bounds.half_area() * WIDE_COST + cost[WIDTH - 1];
        for i in 1..WIDTH {
            cost[i] = cost[i].min_or(cost[i - 1]);
        }
        Self { lo: bounds.lo(), hi: bounds.hi(), kind: Kind::Inner(halves), cost }
    }

    /// The box.
    pub fn bounds(&self) -> Bounds {
        Bounds(PrimRef::new(self.lo, self.hi, 0, 0).0)
    }

    /// Calls `f` with the at most `room` descendants that are to stand for it, in order.
    pub fn divide<'a>(&'a self, room: usize, f: &mut impl FnMut(&'a Self)) {
        match &self.kind {
            Kind::Inner(halves) if room > 1 && self.cost[room - 1] < self.cost[0] => share_out(halves, room, f),
            _ => f(self),
        }
    }

    /// As [`Node2::divide`] with eight, where it becomes a node itself.
    pub fn children<'a>(halves: &'a [Self; 2], f: &mut impl FnMut(&'a Self)) {
        share_out(halves, WIDTH, f);
    }
}

/// How many of `room` the first half is best given, and what that costs.
fn best_share(halves: &[Node2; 2], room: usize) -> (usize, f32) {
    let cost = |k: usize| halves[0].cost[k - 1] + halves[1].cost[room - k - 1];
    (2..room).fold((1, cost(1)), |best, k| if cost(k) < best.1 { (k, cost(k)) } else { best })
}

fn share_out<'a>(halves: &'a [Node2; 2], room: usize, f: &mut impl FnMut(&'a Node2)) {
    let (k, _) = best_share(halves, room);
    halves[0].divide(k, f);
    halves[1].divide(room - k, f);
}

/// Sorts `prims`, which are not empty, into a tree, whose leaves name places in the slice as it is left.
pub(super) fn build(prims: &mut [PrimRef]) -> Node2 {
    node(prims, &split::Extent::of(prims), 0, 0)
}

/// The same below a node at `depth`, for a part that begins at the place `first`.
pub(super) fn node(prims: &mut [PrimRef], extent: &split::Extent, first: u32, depth: usize) -> Node2 {
    let count = prims.len();
    if count <= LEAF_SIZE {
        return Node2::leaf(extent.bounds, first, count as u32);
    }
    // Halving from here on must still fit: then the heuristic has had its way for long enough.
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
    use super::*;

    /// The deepest leaf below a node, which must be no fuller than leaves may be.
    fn deepest(node: &Node2, depth: usize) -> usize {
        match &node.kind {
            Kind::Leaf { count, .. } => {
                assert!((1..=LEAF_SIZE as u32).contains(count));
                depth
            }
            Kind::Inner(halves) => halves.iter().map(|n| deepest(n, depth + 1)).max().unwrap_or(depth),
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
            let extent = split::Extent::of(&prims);
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
