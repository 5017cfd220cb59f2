//! Which children a ray that asks for any hit looks at first: those that are likeliest to block it, for what looking
//! costs (Ize and Hansen 2011, "RTSAH Traversal Order for Occlusion Rays"). The order is that of the slots, so that it
//! costs a traversal nothing.

use arrayvec::ArrayVec;

use super::bvh8::{Child, Node8};
use crate::math::Real;
use crate::simd::F32x8;

/// What is known of a subtree, for a ray that meets its box.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Odds {
    /// How likely the ray is blocked in it.
    blocked: f32,
    /// Visits to nodes and leaves until it is, or until that is denied.
    visits: f32,
}

/// Puts the children of each node in order, those to be looked at first last, since stacks are emptied from their ends.
/// Parents come before children in `nodes`; `covers` has [`super::leaf::Leaf::cover`] of every leaf.
pub(super) fn put_last(nodes: &mut [Node8], covers: &[f32]) {
    let mut known = vec![Odds { blocked: 0.0, visits: 0.0 }; nodes.len()];
    for here in (0..nodes.len()).rev() {
        let areas = half_areas(&nodes[here]).to_array();
        let odds = |child: Child, area: f32| match child {
            // A convex body throws a shadow of a quarter of its surface, averaged over all directions.
            _ if child.is_leaf() => Odds { blocked: (covers[child.index()] / area).min(1.0), visits: 1.0 },
            _ => known[child.index()],
        };
        let children = nodes[here].children;
        let mut order: ArrayVec<(Odds, usize), 8> = children
            .iter()
            .zip(areas)
            .take_while(|(child, _)| **child != Child::NONE)
            .enumerate()
            .map(|(slot, (&child, area))| (odds(child, area), slot))
            .collect();
        let worth = |o: &Odds| o.blocked / o.visits;
        order.sort_unstable_by(|(a, i), (b, j)| worth(a).total_cmp(&worth(b)).then(i.cmp(j)));

        let own = whole_half_area(&nodes[here]);
        let (mut open, mut visits) = (1.0, 1.0);
        for (odds, slot) in order.iter().rev() {
            let met = (areas[*slot] / own).min(1.0);
            visits += open * met * odds.visits;
            open *= 1.0 - met * odds.blocked;
        }
        known[here] = Odds { blocked: 1.0 - open, visits };
        nodes[here].reorder(order.iter().map(|(_, slot)| *slot));
    }
}

fn half(x: F32x8, y: F32x8, z: F32x8) -> F32x8 {
    x * (y + z) + y * z
}

/// Half the surface of each box.
fn half_areas(node: &Node8) -> F32x8 {
    let [x, y, z] = node.planes;
    half(x[1] - x[0], y[1] - y[0], z[1] - z[0])
}

/// Half the surface of the box around all of them.
fn whole_half_area(node: &Node8) -> f32 {
    let [x, y, z] = node.planes.map(|[lo, hi]| {
        let (lo, hi) = (lo.to_array(), hi.to_array());
        let lowest = lo.into_iter().fold(f32::INFINITY, |a, b| a.min_or(b));
        F32x8::from(hi.into_iter().fold(f32::NEG_INFINITY, |a, b| a.max_or(b)) - lowest)
    });
    half(x, y, z).lane(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A node of unit cubes side by side along x.
    fn cubes(children: &[Child]) -> Node8 {
        let mut node = Node8::EMPTY;
        for (i, &child) in children.iter().enumerate() {
            node.children[i] = child;
            for axis in 0..3 {
                let lo = if axis == 0 { i as f32 } else { 0.0 };
                node.planes[axis][0].set_lane(i, lo);
                node.planes[axis][1].set_lane(i, lo + 1.0);
            }
        }
        node
    }

    #[test]
    fn the_leaf_that_covers_most_of_its_box_is_looked_at_first() {
        let leaves = [0, 1, 2].map(Child::leaf);
        let mut nodes = [cubes(&leaves)];
        put_last(&mut nodes, &[0.9, 3.0, 0.0]);
        assert_eq!(nodes[0].children[..4], [leaves[2], leaves[0], leaves[1], Child::NONE]);
        // Boxes move with what is in them, and what is absent stays out of reach.
        assert_eq!(nodes[0].planes[0][0].to_array()[..3], [2.0, 0.0, 1.0]);
        assert_eq!(nodes[0].planes[0][1].to_array()[..3], [3.0, 1.0, 2.0]);
        assert_eq!(nodes[0].planes[2][0].lane(3), f32::INFINITY);
    }

    #[test]
    fn a_node_counts_by_what_is_below_it_for_what_that_costs() {
        // Below: two cubes of half surface 3, each met by a ray into the box around them (half surface 5) with odds of
        // 3 in 5; one is solid, one empty. Blocked: 3/5. Visits: itself, 3/5 for the solid one, 2/5 of 3/5 for the other.
        let below = cubes(&[Child::leaf(0), Child::leaf(1)]);
        let visits = 1.0 + 0.6 + 0.4 * 0.6;
        for (cover, node_first) in [(3.0 * 0.99 * 0.6 / visits, true), (3.0 * 1.01 * 0.6 / visits, false)] {
            let mut nodes = [cubes(&[Child::node(1), Child::leaf(2)]), below];
            put_last(&mut nodes, &[0.0, 3.0, cover]);
            let last = nodes[0].children[1];
            assert_eq!(last == Child::node(1), node_first, "{cover}");
        }
    }
}
