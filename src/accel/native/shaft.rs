//! Shaft queries: the occluders between a point and a lamp.

use arrayvec::ArrayVec;

use super::Native;
use super::node::bvh8::{Bvh8, NodeRef};
use super::node::leaf::Leaf;
use super::traverse::stack::STACK_SIZE;
use crate::geometry::{Content, GeometryMask, Shaft};
use crate::simd::set_lanes;

/// The number of nodes and leaves that are visited before a shaft counts as mixed.
const MOST_VISITS: usize = 256;

/// The number of visits that search for a covering primitive after another one has been found in the shaft.
const COVER_VISITS: usize = 12;

impl Native {
    /// Classifies the triangles and spheres in a shaft. Those whose mask shares a bit with `blocks` are opaque.
    #[must_use]
    pub fn content(&self, shaft: &Shaft, blocks: GeometryMask) -> Content {
        let spheres = classify(&self.spheres, shaft, |leaf| {
            let tags = leaf.tags();
            shaft.spheres(leaf.centre, leaf.radius, tags.admitted(GeometryMask::ALL.0), tags.admitted(blocks.0))
        });
        if spheres == Content::Covered {
            return spheres;
        }
        let triangles = classify(&self.triangles, shaft, |leaf| {
            let tags = leaf.tags();
            shaft.triangles(&leaf.corners(), tags.admitted(GeometryMask::ALL.0), tags.admitted(blocks.0))
        });
        if triangles == Content::Empty { spheres } else { triangles }
    }
}

/// Classifies the primitives of one tree; `content` does so for one leaf.
fn classify<L>(tree: &Bvh8<L>, shaft: &Shaft, content: impl Fn(&L) -> Content) -> Content {
    let mut stack = ArrayVec::<NodeRef, STACK_SIZE>::new();
    if tree.root != NodeRef::NONE {
        stack.push(tree.root);
    }
    let mut found = Content::Empty;
    let mut left = MOST_VISITS;
    while let Some(here) = stack.pop() {
        if left == 0 {
            return Content::Mixed;
        }
        left -= 1;
        if here.is_leaf() {
            match content(&tree.leaves[here.index()]) {
                Content::Covered => return Content::Covered,
                Content::Mixed => {
                    found = Content::Mixed;
                    left = left.min(COVER_VISITS);
                }
                Content::Empty => {}
            }
            continue;
        }
        let node = &tree.nodes[here.index()];
        let hit = shaft.boxes(&node.boxes);
        // The likeliest blockers are pushed last and popped first.
        stack.extend(set_lanes(hit).map(|slot| node.children[slot]).filter(|&child| child != NodeRef::NONE));
    }
    found
}
