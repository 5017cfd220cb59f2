//! The binary tree that a build makes first, with the cost of turning its subtrees into eight-wide nodes.

use super::primitive::{Bounds, PrimRef};
use crate::math::Real;

/// Cost of visiting an eight-wide node, relative to a leaf.
const WIDE_COST: f32 = 1.0;

/// Child slots of an eight-wide node.
const WIDTH: usize = 8;

/// A node of the binary tree.
#[derive(Debug)]
pub(crate) struct Node2 {
    /// Lower corner of the box.
    pub lo: [f32; 3],
    /// Upper corner of the box.
    pub hi: [f32; 3],
    /// Primitives or children.
    pub subtree: Subtree,
    /// `cost[i]` is the least cost of dividing the subtree into at most `i + 1` eight-wide nodes and leaves: surface areas
    /// times costs of a visit.
    cost: [f32; WIDTH],
}

/// The content of a binary node.
#[derive(Debug)]
pub(crate) enum Subtree {
    /// `count` primitives (1 to 8) from index `first` on.
    Leaf { first: u32, count: u32 },
    /// Two children.
    Inner(Box<[Node2; 2]>),
}

impl Node2 {
    /// A leaf of `count` primitives from index `first` on.
    pub fn leaf(bounds: Bounds, first: u32, count: u32) -> Self {
        let subtree = Subtree::Leaf { first, count };
        Self { lo: bounds.lo(), hi: bounds.hi(), subtree, cost: [bounds.half_area(); WIDTH] }
    }

    /// An inner node. Its costs come from those of its children by dynamic programming (Ylitie, Karras, Laine 2017): a node
    /// that becomes eight-wide divides eight slots between its children, any other divides the slots it is given.
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
        Self { lo: bounds.lo(), hi: bounds.hi(), subtree: Subtree::Inner(halves), cost }
    }

    /// The box of the node.
    pub fn bounds(&self) -> Bounds {
        Bounds(PrimRef::new(self.lo, self.hi, 0, 0).0)
    }

    /// Calls `f` with at most `room` descendants that replace this node in an eight-wide node, in order.
    fn divide<'a>(&'a self, room: usize, f: &mut impl FnMut(&'a Self)) {
        match &self.subtree {
            Subtree::Inner(halves) if room > 1 && self.cost[room - 1] < self.cost[0] => divide_between(halves, room, f),
            _ => f(self),
        }
    }

    /// Calls `f` with at most eight descendants that become the children of the eight-wide node over `halves`, in order.
    pub fn wide_children<'a>(halves: &'a [Self; 2], f: &mut impl FnMut(&'a Self)) {
        divide_between(halves, WIDTH, f);
    }
}

/// Returns the best number of slots, out of `room`, for the first child, and the cost.
fn best_division(halves: &[Node2; 2], room: usize) -> (usize, f32) {
    let cost = |k: usize| halves[0].cost[k - 1] + halves[1].cost[room - k - 1];
    (2..room).fold((1, cost(1)), |best, k| if cost(k) < best.1 { (k, cost(k)) } else { best })
}

/// Divides `room` slots between two children.
fn divide_between<'a>(halves: &'a [Node2; 2], room: usize, f: &mut impl FnMut(&'a Node2)) {
    let (k, _) = best_division(halves, room);
    halves[0].divide(k, f);
    halves[1].divide(room - k, f);
}
