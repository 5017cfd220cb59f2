//! From the binary tree to nodes of eight: each takes in descendants as suits the surface area heuristic best.

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

/// Bytes that the binary tree over `prims` primitives takes, with their references: those of trees whose leaves are at
/// least three eighths full. Leaves of meshes are half full or better.
pub(crate) fn bytes_first(prims: usize, quality: BuildQuality) -> u64 {
    let leaves = prims / 3 + 1;
    // An inner node for each leaf, with the header of its block.
    let tree = leaves * (2 * size_of::<Node2>() + 16);
    let more = match quality {
        // The order of the curve, and the references once more in that order.
        BuildQuality::Fast => prims * (8 + size_of::<PrimRef>()),
        BuildQuality::Default => 0,
        // Nodes in a list that grows by doubling, their order, and the tree once more.
        BuildQuality::High => 2 * leaves * (2 * reinsert::NODE_BYTES + 8) + tree,
    };
    (prims * size_of::<PrimRef>() + tree + more) as u64
}

/// Builds the hierarchy over `prims`; `leaf` makes a leaf of at most eight of them. `named` is what a message calls the
/// hierarchy, and its cure.
///
/// # Errors
/// [`Error::Limit`](crate::Error::Limit), where there is no memory for nodes and leaves.
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
    let root = flat.place(&tree, 0)?;
    let leaf_bytes = flat.leaves.len() * (size_of::<L>() + size_of::<f32>());
    memory::need(named.0, (flat.nodes.len() * size_of::<Node8>() + leaf_bytes) as u64, named.1)?;
    let mut nodes = room_for(flat.nodes.len());
    nodes.append(&mut flat.nodes);
    let mut leaves = room_for(flat.leaves.len());
    let mut covers = Vec::new();
    let of = |&(first, count): &(u32, u32)| {
        let leaf = leaf(&prims[first as usize..][..count as usize]);
        let cover = leaf.shadow_area();
        (leaf, cover)
    };
    // Giving back half a million small boxes takes a while, too.
    rayon::join(|| flat.leaves.par_iter().map(of).unzip_into_vecs(&mut leaves, &mut covers), || drop(tree));
    child_order::put_last(&mut nodes, &covers);
    nodes.par_iter_mut().for_each(Node8::sort_octants);
    Ok(Bvh8 { nodes, leaves, root, depth: flat.depth })
}

#[derive(Default)]
struct Flat<'a> {
    /// As in [`bvh8`].
    named: (&'a str, &'static str),
    nodes: Vec<Node8>,
    /// First primitive and how many.
    leaves: Vec<(u32, u32)>,
    depth: usize,
}

impl Flat<'_> {
    /// Places a subtree whose root is at `depth`; depth first, so that near relatives are near in memory.
    fn place(&mut self, node: &Node2, depth: usize) -> Result<NodeRef> {
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
            let to = self.place(child, depth + 1)?;
            let node = &mut self.nodes[here];
            node.children[i] = to;
            node.boxes.set_lane(i, child.lo, child.hi);
        }
        Ok(NodeRef::node(here))
    }
}
