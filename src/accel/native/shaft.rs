//! The hierarchy asked about shafts: is there anything between a place and a lamp?

use arrayvec::ArrayVec;

use super::Native;
use super::node::bvh8::{Bvh8, NodeRef};
use super::node::leaf::Leaf;
use super::traverse::stack::STACK_SIZE;
use crate::geometry::{Content, GeometryMask, Shaft};

/// Nodes and leaves that are looked at before a shaft counts as mixed.
const LOOKED_AT: usize = 256;

/// Those that are looked at for a cover once something is known to be there.
const LOOKED_AT_FOR_A_COVER: usize = 12;

impl Native {
    /// The part of its triangles and spheres that is in a shaft; those that `blocks` meets stop light.
    #[must_use]
    pub fn content(&self, shaft: &Shaft, blocks: GeometryMask) -> Content {
        let spheres = look(&self.spheres, shaft, |leaf| {
            let tags = leaf.tags();
            shaft.spheres(leaf.centre, leaf.radius, tags.admitted(GeometryMask::ALL.0), tags.admitted(blocks.0))
        });
        if spheres == Content::Covered {
            return spheres;
        }
        let triangles = look(&self.triangles, shaft, |leaf| {
            let tags = leaf.tags();
            shaft.triangles(&leaf.corners(), tags.admitted(GeometryMask::ALL.0), tags.admitted(blocks.0))
        });
        if triangles == Content::Empty { spheres } else { triangles }
    }
}

fn look<L>(tree: &Bvh8<L>, shaft: &Shaft, content: impl Fn(&L) -> Content) -> Content {
    let mut stack = ArrayVec::<NodeRef, STACK_SIZE>::new();
    if tree.root != NodeRef::NONE {
        stack.push(tree.root);
    }
    let mut found = Content::Empty;
    let mut left = LOOKED_AT;
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
                    left = left.min(LOOKED_AT_FOR_A_COVER);
                }
                Content::Empty => {}
            }
            continue;
        }
        let node = &tree.nodes[here.index()];
        let met = shaft.boxes(&node.boxes);
        // The likeliest blockers are last, and come off first.
        for (slot, &child) in node.children.iter().enumerate() {
            if met >> slot & 1 != 0 && child != NodeRef::NONE {
                stack.push(child);
            }
        }
    }
    found
}
