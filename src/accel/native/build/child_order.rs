//! Which children a ray that asks for any hit looks at first: those that are likeliest to block it, for what looking
//! costs (Ize and Hansen 2011, "RTSAH Traversal Order for Occlusion Rays"). The order is that of the slots, so that it
//! costs a traversal nothing.

use super::super::node::bvh8::{Node8, NodeRef};
use super::primitive::half_area;
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
        let node = &nodes[here];
        let areas = half_areas(node).to_array();
        let mut odds = [Odds { blocked: 0.0, visits: 1.0 }; 8];
        // What a child is worth, with its slot in the lowest bits; absent ones stay last.
        let mut order = [u64::MAX; 8];
        let mut count = 0;
        while count < 8 && node.children[count] != NodeRef::NONE {
            let child = node.children[count];
            odds[count] = if child.is_leaf() {
                // A convex body throws a shadow of a quarter of its surface, averaged over all directions.
                Odds { blocked: (covers[child.index()] / areas[count]).min_or(1.0), visits: 1.0 }
            } else {
                known[child.index()]
            };
            // Numbers that are not negative are in the order of their bits.
            let worth = (odds[count].blocked / odds[count].visits).to_bits();
            order[count] = u64::from(worth) << 3 | count as u64;
            count += 1;
        }
        order.sort_unstable();
        let slots = order.map(|o| (o & 7) as usize);

        let own = whole_half_area(node);
        let (mut open, mut visits) = (1.0, 1.0);
        for &slot in slots[..count].iter().rev() {
            let met = (areas[slot] / own).min_or(1.0);
            visits += open * met * odds[slot].visits;
            open *= 1.0 - met * odds[slot].blocked;
        }
        known[here] = Odds { blocked: 1.0 - open, visits };
        nodes[here].permute(slots);
    }
}

/// Half the surface of each box.
fn half_areas(node: &Node8) -> F32x8 {
    let span = |axis: usize| node.boxes.planes[axis][1] - node.boxes.planes[axis][0];
    half_area(span(0), span(1), span(2))
}

/// Half the surface of the box around all of them.
fn whole_half_area(node: &Node8) -> f32 {
    let span = |axis: usize| node.boxes.planes[axis][1].reduce_max() + (-node.boxes.planes[axis][0]).reduce_max();
    half_area(span(0), span(1), span(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A node of unit cubes side by side along x.
    fn cubes(children: &[NodeRef]) -> Node8 {
        let mut node = Node8::EMPTY;
        for (i, &child) in children.iter().enumerate() {
            node.children[i] = child;
            node.boxes.set_lane(i, [i as f32, 0.0, 0.0], [i as f32 + 1.0, 1.0, 1.0]);
        }
        node
    }

    #[test]
    fn the_leaf_that_covers_most_of_its_box_is_looked_at_first() {
        let leaves = [0, 1, 2].map(NodeRef::leaf);
        let mut nodes = [cubes(&leaves)];
        put_last(&mut nodes, &[0.9, 3.0, 0.0]);
        assert_eq!(nodes[0].children[..4], [leaves[2], leaves[0], leaves[1], NodeRef::NONE]);
        // Boxes move with what is in them, and what is absent stays out of reach.
        assert_eq!(nodes[0].boxes.planes[0][0].to_array()[..3], [2.0, 0.0, 1.0]);
        assert_eq!(nodes[0].boxes.planes[0][1].to_array()[..3], [3.0, 1.0, 2.0]);
        assert_eq!(nodes[0].boxes.planes[2][0].lane(3), f32::INFINITY);
    }

    #[test]
    fn a_node_counts_by_what_is_below_it_for_what_that_costs() {
        // Below: two cubes of half surface 3, each met by a ray into the box around them (half surface 5) with odds of
        // 3 in 5; one is solid, one empty. Blocked: 3/5. Visits: itself, 3/5 for the solid one, 2/5 of 3/5 for the other.
        let below = cubes(&[NodeRef::leaf(0), NodeRef::leaf(1)]);
        let visits = 1.0 + 0.6 + 0.4 * 0.6;
        for (cover, node_first) in [(3.0 * 0.99 * 0.6 / visits, true), (3.0 * 1.01 * 0.6 / visits, false)] {
            let mut nodes = [cubes(&[NodeRef::node(1), NodeRef::leaf(2)]), below];
            put_last(&mut nodes, &[0.0, 3.0, cover]);
            let last = nodes[0].children[1];
            assert_eq!(last == NodeRef::node(1), node_first, "{cover}");
        }
    }
}
