//! Turns the binary tree into the eight-wide hierarchy: each node takes those descendants as children that cost least by
//! the surface area heuristic.

use rayon::prelude::*;

use super::super::node::bvh8::{Bvh8, Node8, NodeRef};
use super::super::node::leaf::Leaf;
use super::binary::{Node2, Subtree};
use super::primitive::PrimRef;
use super::{child_order, morton, reinsert, sah};
use crate::Result;
use crate::accel::BuildQuality;
use crate::simd::room_for;
use crate::system::memory;

/// Memory for building over `prims` primitives, in bytes: references and binary tree. It assumes leaves that are at least
/// three eighths full. Leaves of meshes are half full or better.
pub(crate) fn build_bytes(prims: usize, quality: BuildQuality) -> u64 {
    let leaves = prims / 3 + 1;
    // One inner node for each leaf, with the header of its memory block.
    let tree = leaves * (2 * size_of::<Node2>() + 16);
    let more = match quality {
        // The order on the curve, and a copy of the references in that order.
        BuildQuality::Fast => prims * (8 + size_of::<PrimRef>()),
        BuildQuality::Default => 0,
        // Nodes in a list that grows by doubling, their order, and a copy of the tree.
        BuildQuality::High => 2 * leaves * (2 * reinsert::NODE_BYTES + 8) + tree,
    };
    (prims * size_of::<PrimRef>() + tree + more) as u64
}

/// Builds the hierarchy over `prims`. `leaf` makes a leaf of at most eight references. `named` has the name of the hierarchy
/// in error messages, and the cure that they give.
///
/// # Errors
/// [`Error::Limit`](crate::Error::Limit) if there is not enough memory for nodes and leaves.
pub(crate) fn bvh8<L: Leaf + Send>(
    prims: &mut [PrimRef],
    quality: BuildQuality,
    named: (&str, &'static str),
    leaf: impl Fn(&[PrimRef]) -> L + Sync,
) -> Result<Bvh8<L>> {
    if prims.is_empty() {
        return Ok(Bvh8 { nodes: Vec::new(), leaves: Vec::new(), root: NodeRef::NONE, depth: 0 });
    }
    let tree = match quality {
        BuildQuality::Fast => morton::build(prims),
        BuildQuality::Default => sah::build(prims),
        BuildQuality::High => reinsert::improved(sah::build(prims)),
    };
    let mut flat = Flat { named, ..Flat::default() };
    let root = flat.push(&tree, 0)?;
    let leaf_bytes = flat.leaves.len() * (size_of::<L>() + size_of::<f32>());
    memory::need(named.0, (flat.nodes.len() * size_of::<Node8>() + leaf_bytes) as u64, named.1)?;
    let mut nodes = room_for(flat.nodes.len());
    nodes.append(&mut flat.nodes);
    let mut leaves = room_for(flat.leaves.len());
    let mut areas = Vec::new();
    let of = |&(first, count): &(u32, u32)| {
        let leaf = leaf(&prims[first as usize..][..count as usize]);
        let area = leaf.shadow_area();
        (leaf, area)
    };
    // The binary tree is freed meanwhile: half a million small blocks take a while.
    rayon::join(|| flat.leaves.par_iter().map(of).unzip_into_vecs(&mut leaves, &mut areas), || drop(tree));
    child_order::sort(&mut nodes, &areas);
    nodes.par_iter_mut().for_each(Node8::sort_octants);
    Ok(Bvh8 { nodes, leaves, root, depth: flat.depth })
}

/// The eight-wide tree in lists.
#[derive(Default)]
struct Flat<'a> {
    /// As in [`bvh8`].
    named: (&'a str, &'static str),
    nodes: Vec<Node8>,
    /// For each leaf, index of the first primitive and number of primitives.
    leaves: Vec<(u32, u32)>,
    depth: usize,
}

impl Flat<'_> {
    /// Appends a subtree whose root is at level `depth`. Depth first, so that related nodes are near in memory.
    fn push(&mut self, node: &Node2, depth: usize) -> Result<NodeRef> {
        let halves = match &node.subtree {
            Subtree::Leaf { first, count } => {
                self.depth = self.depth.max(depth);
                memory::push(&mut self.leaves, (*first, *count), self.named.0, self.named.1)?;
                return Ok(NodeRef::leaf(self.leaves.len() - 1));
            }
            Subtree::Inner(halves) => halves,
        };
        let mut children = arrayvec::ArrayVec::<&Node2, 8>::new();
        Node2::wide_children(halves, &mut |child| children.push(child));
        let here = self.nodes.len();
        memory::push(&mut self.nodes, Node8::EMPTY, self.named.0, self.named.1)?;
        for (i, child) in children.iter().enumerate() {
            let to = self.push(child, depth + 1)?;
            let node = &mut self.nodes[here];
            node.children[i] = to;
            node.boxes.set_lane(i, child.lo, child.hi);
        }
        Ok(NodeRef::node(here))
    }
}
