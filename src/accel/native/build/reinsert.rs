//! Improves a binary tree by reinsertion: subtrees are removed and inserted where they enlarge boxes least (Bittner, Hapala,
//! Havran 2013; Meister & Bittner 2018). One subtree is moved at a time, so that the result depends on the tree alone.

use std::collections::BinaryHeap;

use super::super::node::bvh8::MAX_DEPTH;
use super::binary::{Node2, Subtree};
use super::primitive::Bounds;

/// The maximum number of rounds, and the relative cost that a round must save to be followed by another one.
const ROUNDS: usize = 4;
const WORTH: f64 = 0.002;

/// A round tries one node in this many, those with the largest boxes.
const ONE_IN: usize = 2;

/// Size of a node in bytes while the tree is improved.
pub(super) const NODE_BYTES: usize = size_of::<Node>();

/// Index that stands for no node.
const NONE: u32 = u32::MAX;

/// A binary tree with nodes in a list.
struct Arena {
    nodes: Vec<Node>,
    root: u32,
}

/// A node of the [`Arena`].
struct Node {
    bounds: Bounds,
    area: f32,
    parent: u32,
    /// Both [`NONE`] in a leaf.
    children: [u32; 2],
    /// Index of the first primitive and number of primitives, in a leaf.
    prims: (u32, u32),
}

/// Returns the improved tree, or `tree` itself if the improved one is too deep for the traversal stacks.
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

/// A candidate for inserting a subtree beside `node`.
struct Candidate {
    /// Lower bound of the growth of the boxes above the node.
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
    /// Orders candidates so that the heap yields the least growth first.
    fn cmp(&self, o: &Self) -> std::cmp::Ordering {
        o.growth.total_cmp(&self.growth).then(o.node.cmp(&self.node))
    }
}

impl Arena {
    /// Adds a subtree below `parent`. Returns its index.
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

    /// The cost by the surface area heuristic, without constants: the sum of the areas of all inner nodes.
    fn cost(&self) -> f64 {
        self.nodes.iter().filter(|n| n.children[0] != NONE).map(|n| f64::from(n.area)).sum()
    }

    /// Reinserts each of the nodes with the largest boxes once.
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

    /// Removes a subtree and inserts it where it enlarges boxes least, possibly where it was.
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
        let best = self.best_sibling(node, queue);
        // The parent goes between the best node and the node above it.
        let above = self.node(best).parent;
        if above == NONE {
            self.root = parent;
            self.node(parent).parent = NONE;
        } else {
            self.replace(above, best, parent);
        }
        // An empty box makes `refit` continue upwards even if the parent gets the same box as before.
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

    /// Recomputes boxes from node `i` upwards until one does not change.
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

    /// Finds the node beside which the subtree costs least, by branch and bound over the whole tree.
    fn best_sibling(&self, node: u32, queue: &mut BinaryHeap<Candidate>) -> u32 {
        let (bounds, area) = (self.nodes[node as usize].bounds, self.nodes[node as usize].area);
        let (mut best, mut least) = (self.root, f32::INFINITY);
        queue.clear();
        queue.push(Candidate { growth: 0.0, node: self.root });
        while let Some(Candidate { growth, node: at }) = queue.pop() {
            // Every further candidate needs a new node at least as large as the subtree.
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

    /// Converts a subtree to [`Node2`]. Returns `None` if it is deeper than [`MAX_DEPTH`].
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
