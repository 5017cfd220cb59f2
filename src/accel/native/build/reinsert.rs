//! A better binary tree by reinsertion: subtrees are taken out and put back where they enlarge the boxes least
//! (Bittner, Hapala, Havran 2013; Meister & Bittner 2018, here one at a time, so that the result depends on nothing
//! but the tree).

use std::collections::BinaryHeap;

use super::super::node::bvh8::MAX_DEPTH;
use super::binary::{Node2, Subtree};
use super::primitive::Bounds;

/// Rounds at most, and what a round must save to be followed by another one.
const ROUNDS: usize = 4;
const WORTH: f64 = 0.002;

/// Of all nodes, those with the largest boxes are tried in a round: one in so many.
const ONE_IN: usize = 2;

/// Bytes of a node while the tree is improved.
pub(super) const NODE_BYTES: usize = size_of::<Node>();

/// No node.
const NONE: u32 = u32::MAX;

/// Binary nodes by number.
struct Arena {
    nodes: Vec<Node>,
    root: u32,
}

struct Node {
    bounds: Bounds,
    area: f32,
    parent: u32,
    /// Both [`NONE`] in a leaf.
    children: [u32; 2],
    /// First primitive and how many, in a leaf.
    prims: (u32, u32),
}

/// The tree with subtrees where they cost least. The tree itself where that would be too deep for the stacks.
pub(super) fn improved(tree: Node2) -> Node2 {
    let mut arena = Arena { nodes: Vec::new(), root: 0 };
    arena.root = arena.add(&tree, NONE);
    let mut cost = arena.cost();
    for _ in 0..ROUNDS {
        arena.round();
        let now = arena.cost();
        if now > cost * (1.0 - WORTH) {
            break;
        }
        cost = now;
    }
    arena.rebuilt(arena.root, 0).unwrap_or(tree)
}

/// A place for a subtree: how much the boxes above it grow, at least; the node.
struct Candidate {
    growth: f32,
    node: u32,
}

impl PartialEq for Candidate {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o).is_eq()
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, o: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(o))
    }
}

impl Ord for Candidate {
    /// The least growth is the greatest.
    fn cmp(&self, o: &Self) -> std::cmp::Ordering {
        o.growth.total_cmp(&self.growth).then(o.node.cmp(&self.node))
    }
}

impl Arena {
    fn add(&mut self, node: &Node2, parent: u32) -> u32 {
        let here = self.nodes.len() as u32;
        let prims = if let Subtree::Leaf { first, count } = node.subtree { (first, count) } else { (0, 0) };
        let bounds = node.bounds();
        let area = bounds.half_area();
        self.nodes.push(Node { bounds, area, parent, children: [NONE; 2], prims });
        if let Subtree::Inner(halves) = &node.subtree {
            let children = [self.add(&halves[0], here), self.add(&halves[1], here)];
            self.nodes[here as usize].children = children;
        }
        here
    }

    /// The surface area heuristic's, without constants: areas of all inner nodes.
    fn cost(&self) -> f64 {
        self.nodes.iter().filter(|n| n.children[0] != NONE).map(|n| f64::from(n.area)).sum()
    }

    /// Tries the nodes with the largest boxes once.
    fn round(&mut self) {
        let mut order: Vec<u32> = (0..self.nodes.len() as u32).collect();
        let area = |i: u32| self.nodes[i as usize].area;
        order.sort_by(|&a, &b| area(b).total_cmp(&area(a)).then(a.cmp(&b)));
        order.truncate(self.nodes.len() / ONE_IN);
        let mut queue = BinaryHeap::new();
        for node in order {
            self.reinsert(node, &mut queue);
        }
    }

    fn node(&mut self, i: u32) -> &mut Node {
        &mut self.nodes[i as usize]
    }

    /// Takes a subtree out, and puts it where it enlarges the boxes least, which may be where it was.
    fn reinsert(&mut self, node: u32, queue: &mut BinaryHeap<Candidate>) {
        let parent = self.node(node).parent;
        if parent == NONE || self.node(parent).parent == NONE {
            return;
        }
        let grandparent = self.node(parent).parent;
        let [a, b] = self.node(parent).children;
        let sibling = if a == node { b } else { a };
        // The sibling takes the parent's place.
        self.replace(grandparent, parent, sibling);
        self.refit(grandparent);
        let best = self.place_for(node, queue);
        // The parent goes between that place and the node above it.
        let above = self.node(best).parent;
        if above == NONE {
            self.root = parent;
            self.node(parent).parent = NONE;
        } else {
            self.replace(above, best, parent);
        }
        // Boxes above that place must grow even where the parent's own comes out as it was elsewhere.
        self.node(parent).bounds = Bounds::EMPTY;
        self.node(parent).children = [best, node];
        self.node(best).parent = parent;
        self.node(node).parent = parent;
        self.refit(parent);
    }

    /// Puts `new` where `old` is a child of `parent`.
    fn replace(&mut self, parent: u32, old: u32, new: u32) {
        let children = &mut self.node(parent).children;
        children[usize::from(children[0] != old)] = new;
        self.node(new).parent = parent;
    }

    /// Boxes from `i` up, until one does not change.
    fn refit(&mut self, mut i: u32) {
        while i != NONE {
            let [a, b] = self.node(i).children;
            let bounds = self.node(a).bounds.union(self.node(b).bounds.0);
            let node = self.node(i);
            let same = (bounds.lo(), bounds.hi()) == (node.bounds.lo(), node.bounds.hi());
            if same {
                return;
            }
            node.bounds = bounds;
            node.area = bounds.half_area();
            i = node.parent;
        }
    }

    /// Branch and bound over the whole tree: beside which node the subtree costs least.
    fn place_for(&self, node: u32, queue: &mut BinaryHeap<Candidate>) -> u32 {
        let (bounds, area) = (self.nodes[node as usize].bounds, self.nodes[node as usize].area);
        let (mut best, mut least) = (self.root, f32::INFINITY);
        queue.clear();
        queue.push(Candidate { growth: 0.0, node: self.root });
        while let Some(Candidate { growth, node: at }) = queue.pop() {
            // Whatever follows needs a new node at least as large as the subtree.
            if growth + area >= least {
                break;
            }
            let here = &self.nodes[at as usize];
            let united = here.bounds.union(bounds.0).half_area();
            if growth + united < least {
                (best, least) = (at, growth + united);
            }
            let growth = growth + (united - here.area);
            if here.children[0] != NONE && growth + area < least {
                queue.extend(here.children.map(|child| Candidate { growth, node: child }));
            }
        }
        best
    }

    /// As the builder makes it; `None` where it is deeper than it may be.
    fn rebuilt(&self, i: u32, depth: usize) -> Option<Node2> {
        let node = &self.nodes[i as usize];
        let [a, b] = node.children;
        if a == NONE {
            return Some(Node2::leaf(node.bounds, node.prims.0, node.prims.1));
        }
        if depth >= MAX_DEPTH {
            return None;
        }
        let halves = [self.rebuilt(a, depth + 1)?, self.rebuilt(b, depth + 1)?];
        Some(Node2::inner(node.bounds, Box::new(halves)))
    }
}
