//! The order of children for any-hit rays: those first that block a ray with the highest probability per cost of a visit
//! (Ize and Hansen 2011, "RTSAH Traversal Order for Occlusion Rays"). The order is that of the slots, so that it costs a
//! traversal nothing.

use super::super::node::bvh8::{Node8, NodeRef};
use super::primitive::half_area;
use crate::math::Real;
use crate::simd::F32x8;

/// Estimates for a subtree and a ray that hits its box.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Occlusion {
    /// Probability that the subtree blocks the ray.
    blocked: f32,
    /// Expected number of visits to nodes and leaves until the ray is blocked or leaves the subtree.
    visits: f32,
}

/// Sorts the children of each node, those to visit first in the last slots, since stacks are popped from their ends.
/// Parents come before children in `nodes`. `shadow_areas` has [`Leaf::shadow_area`] of every leaf.
///
/// [`Leaf::shadow_area`]: super::super::node::leaf::Leaf::shadow_area
pub(super) fn sort(nodes: &mut [Node8], shadow_areas: &[f32]) {
    let mut known = vec![Occlusion { blocked: 0.0, visits: 0.0 }; nodes.len()];
    for here in (0..nodes.len()).rev() {
        let node = &nodes[here];
        let areas = half_areas(node).to_array();
        let mut estimates = [Occlusion { blocked: 0.0, visits: 1.0 }; 8];
        // Sort keys: probability per cost, with the slot in the lowest bits. Empty slots stay last.
        let mut order = [u64::MAX; 8];
        let mut count = 0;
        while count < 8 && node.children[count] != NodeRef::NONE {
            let child = node.children[count];
            estimates[count] = if child.is_leaf() {
                // The shadow of a convex body has a quarter of its surface area, averaged over all directions.
                Occlusion { blocked: (shadow_areas[child.index()] / areas[count]).min_or(1.0), visits: 1.0 }
            } else {
                known[child.index()]
            };
            // Non-negative numbers have the order of their bits.
            let worth = (estimates[count].blocked / estimates[count].visits).to_bits();
            order[count] = u64::from(worth) << 3 | count as u64;
            count += 1;
        }
        order.sort_unstable();
        let slots = order.map(|o| (o & 7) as usize);

        let own = whole_half_area(node);
        let (mut open, mut visits) = (1.0, 1.0);
        for &slot in slots[..count].iter().rev() {
            let hit = (areas[slot] / own).min_or(1.0);
            visits += open * hit * estimates[slot].visits;
            open *= 1.0 - hit * estimates[slot].blocked;
        }
        known[here] = Occlusion { blocked: 1.0 - open, visits };
        nodes[here].permute(slots);
    }
}

/// Half the surface area of each box.
fn half_areas(node: &Node8) -> F32x8 {
    let span = |axis: usize| node.boxes.planes[axis][1] - node.boxes.planes[axis][0];
    half_area(span(0), span(1), span(2))
}

/// Half the surface area of the box around all eight.
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
    fn the_leaf_that_covers_most_of_its_box_is_visited_first() {
        let leaves = [0, 1, 2].map(NodeRef::leaf);
        let mut nodes = [cubes(&leaves)];
        sort(&mut nodes, &[0.9, 3.0, 0.0]);
        assert_eq!(nodes[0].children[..4], [leaves[2], leaves[0], leaves[1], NodeRef::NONE]);
        // Boxes move with their children, and empty slots stay last.
        assert_eq!(nodes[0].boxes.planes[0][0].to_array()[..3], [2.0, 0.0, 1.0]);
        assert_eq!(nodes[0].boxes.planes[0][1].to_array()[..3], [3.0, 1.0, 2.0]);
        assert_eq!(nodes[0].boxes.planes[2][0].lane(3), f32::INFINITY);
    }

    #[test]
    fn a_node_ranks_by_the_blockers_below_it_per_cost_of_finding_them() {
        // Below: two cubes of half area 3 in a box of half area 5, each hit with probability 3/5. One is solid, one empty.
        // Blocked: 3/5. Visits: the node, 3/5 for the solid cube, 2/5 of 3/5 for the empty one.
        let below = cubes(&[NodeRef::leaf(0), NodeRef::leaf(1)]);
        let visits = 1.0 + 0.6 + 0.4 * 0.6;
        for (cover, node_first) in [(3.0 * 0.99 * 0.6 / visits, true), (3.0 * 1.01 * 0.6 / visits, false)] {
            let mut nodes = [cubes(&[NodeRef::node(1), NodeRef::leaf(2)]), below];
            sort(&mut nodes, &[0.0, 3.0, cover]);
            let last = nodes[0].children[1];
            assert_eq!(last == NodeRef::node(1), node_first, "{cover}");
        }
    }
}
