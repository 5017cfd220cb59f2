//! From the binary tree to nodes of eight: each takes in descendants as suits the surface area heuristic best.

use rayon::prelude::*;

use super::bvh2::{self, Kind, Node2, PrimRef};
use super::bvh8::{Bvh8, Child, Node8};
use super::leaf::Leaf;
use super::{blockers, morton, reinsert};
use crate::accel::BuildQuality;
use crate::simd::room_for;

/// Builds the hierarchy over `prims`; `leaf` makes a leaf of at most eight of them.
pub(super) fn bvh8<L: Leaf + Send>(
    prims: &mut [PrimRef],
    quality: BuildQuality,
    leaf: impl Fn(&[PrimRef]) -> L + Sync,
) -> Bvh8<L> {
    if prims.is_empty() {
        return Bvh8 { nodes: Vec::new(), leaves: Vec::new(), root: Child::NONE, depth: 0 };
    }
    let tree = match quality {
        BuildQuality::Fast => morton::build(prims),
        BuildQuality::Default => bvh2::build(prims),
        BuildQuality::High => reinsert::improved(bvh2::build(prims)),
    };
    let mut flat = Flat::default();
    let root = flat.place(&tree, 0);
    let mut nodes = room_for(flat.nodes.len());
    nodes.append(&mut flat.nodes);
    let mut leaves = room_for(flat.leaves.len());
    let mut covers = Vec::new();
    let of = |&(first, count): &(u32, u32)| {
        let leaf = leaf(&prims[first as usize..][..count as usize]);
        let cover = leaf.cover();
        (leaf, cover)
    };
    // Giving back half a million small boxes takes a while, too.
    rayon::join(|| flat.leaves.par_iter().map(of).unzip_into_vecs(&mut leaves, &mut covers), || drop(tree));
    blockers::put_last(&mut nodes, &covers);
    nodes.par_iter_mut().for_each(Node8::put_in_order);
    Bvh8 { nodes, leaves, root, depth: flat.depth }
}

#[derive(Default)]
struct Flat {
    nodes: Vec<Node8>,
    /// First primitive and how many.
    leaves: Vec<(u32, u32)>,
    depth: usize,
}

impl Flat {
    /// Places a subtree whose root is at `depth`; depth first, so that near relatives are near in memory.
    fn place(&mut self, node: &Node2, depth: usize) -> Child {
        let halves = match &node.kind {
            Kind::Leaf { first, count } => {
                self.depth = self.depth.max(depth);
                self.leaves.push((*first, *count));
                return Child::leaf(self.leaves.len() - 1);
            }
            Kind::Inner(halves) => halves,
        };
        let mut children = arrayvec::ArrayVec::<&Node2, 8>::new();
        Node2::children(halves, &mut |child| children.push(child));
        let here = self.nodes.len();
        self.nodes.push(Node8::EMPTY);
        for (i, child) in children.iter().enumerate() {
            let to = self.place(child, depth + 1);
            let node = &mut self.nodes[here];
            node.children[i] = to;
            let (lo, hi) = (child.lo, child.hi);
            for axis in 0..3 {
                node.planes[axis][0].set_lane(i, lo[axis]);
                node.planes[axis][1].set_lane(i, hi[axis]);
            }
        }
        Child::node(here)
    }
}
