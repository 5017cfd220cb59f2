//! Validation of a built hierarchy: the invariants that every traversal relies on.

use super::build::primitive::Bounds;
use super::node::bvh8::{Bvh8, MAX_DEPTH, NodeRef};
use super::node::leaf::Leaf;
use super::node::sphere8::Sphere8;
use super::node::tri8::Tri8;
use super::{Native, triangle_ref};
use crate::geometry::{Geometry, Shape, sphere};

/// Lower and upper corner of a box.
type Box3 = ([f32; 3], [f32; 3]);

/// Leaves that compute the boxes of their primitives anew.
trait Boxed: Leaf {
    /// The grown box of the primitive in slot `i`.
    fn bounds(&self, i: usize) -> Box3;
}

impl Boxed for Tri8 {
    fn bounds(&self, i: usize) -> Box3 {
        let bounds = Bounds(triangle_ref(self.triangle(i), 0, 0).0);
        (bounds.lo(), bounds.hi())
    }
}

impl Boxed for Sphere8 {
    fn bounds(&self, i: usize) -> Box3 {
        let s = self.sphere(i);
        let (lo, hi) = sphere::grown_bounds::<f32>(s.centre.into(), s.radius);
        ([lo.x, lo.y, lo.z], [hi.x, hi.y, hi.z])
    }
}

impl Native {
    /// Checks the invariants of the trees against the geometry they were built from:
    /// - each box contains the boxes below it;
    /// - every usable primitive is in exactly one leaf, and no other primitive is in any;
    /// - empty child slots come last, and no ray hits them;
    /// - every node and leaf is reached exactly once;
    /// - no path is longer than the traversal stacks allow.
    ///
    /// # Errors
    /// A description of the first violation.
    pub fn validate(&self, geometry: &[Geometry]) -> Result<(), String> {
        let mut triangles = Vec::new();
        let mut spheres = Vec::new();
        for (g, id) in geometry.iter().zip(0_u32..) {
            match &g.shape {
                Shape::Mesh(m) => {
                    triangles.extend((0..m.triangles.len()).filter(|&i| m.is_usable(i)).map(|i| (id, i as u32)));
                }
                Shape::Sphere(s) if s.is_usable() => spheres.push((id, 0)),
                _ => {}
            }
        }
        check(&self.triangles, &triangles).map_err(|e| format!("triangles: {e}"))?;
        check(&self.spheres, &spheres).map_err(|e| format!("spheres: {e}"))?;
        let (t, s) = (&self.triangles, &self.spheres);
        let counts = [
            (self.stats.triangles, triangles.len()),
            (self.stats.spheres, spheres.len()),
            (self.stats.nodes, t.nodes.len() + s.nodes.len()),
            (self.stats.leaves, t.leaves.len() + s.leaves.len()),
            (self.stats.depth, t.depth.max(s.depth)),
        ];
        if let Some((said, is)) = counts.iter().find(|(said, is)| said != is) {
            return Err(format!("statistics say {said} where there are {is}"));
        }
        Ok(())
    }
}

/// Checks one tree, which must hold the primitives `expected`.
fn check<L: Boxed>(tree: &Bvh8<L>, expected: &[(u32, u32)]) -> Result<(), String> {
    let mut seen = Seen { node: vec![false; tree.nodes.len()], leaf: vec![false; tree.leaves.len()], depth: 0 };
    if tree.root != NodeRef::NONE {
        let everywhere = ([f32::NEG_INFINITY; 3], [f32::INFINITY; 3]);
        visit(tree, tree.root, &everywhere, 0, &mut seen)?;
    }
    if let Some(i) = seen.node.iter().position(|s| !s) {
        return Err(format!("node {i} is not reached"));
    }
    if let Some(i) = seen.leaf.iter().position(|s| !s) {
        return Err(format!("leaf {i} is not reached"));
    }
    if seen.depth != tree.depth || tree.depth > MAX_DEPTH {
        return Err(format!("depth is {}, said to be {}, at most {MAX_DEPTH}", seen.depth, tree.depth));
    }
    let mut ids: Vec<_> = tree.leaves.iter().flat_map(Leaf::ids).collect();
    ids.sort_unstable();
    if ids != expected {
        return Err(format!("{} primitives are held, {} can be hit", ids.len(), expected.len()));
    }
    Ok(())
}

/// Nodes and leaves reached so far, and the number of levels.
struct Seen {
    node: Vec<bool>,
    leaf: Vec<bool>,
    depth: usize,
}

/// Checks the subtree at `at`, whose box is `room`.
fn visit<L: Boxed>(tree: &Bvh8<L>, at: NodeRef, room: &Box3, depth: usize, seen: &mut Seen) -> Result<(), String> {
    let i = at.index();
    if at.is_leaf() {
        let leaf = tree.leaves.get(i).ok_or_else(|| format!("leaf {i} does not exist"))?;
        if std::mem::replace(&mut seen.leaf[i], true) {
            return Err(format!("leaf {i} is reached twice"));
        }
        seen.depth = seen.depth.max(depth);
        let filled = leaf.ids().count();
        if filled == 0 {
            return Err(format!("leaf {i} is empty"));
        }
        return match (0..filled).find(|&k| !holds(room, &leaf.bounds(k))) {
            Some(k) => Err(format!("slot {k} of leaf {i} sticks out of its box")),
            None => Ok(()),
        };
    }
    let node = tree.nodes.get(i).ok_or_else(|| format!("node {i} does not exist"))?;
    if std::mem::replace(&mut seen.node[i], true) {
        return Err(format!("node {i} is reached twice"));
    }
    let present = node.children.iter().take_while(|&&c| c != NodeRef::NONE).count();
    if present < 2 {
        return Err(format!("node {i} has {present} children"));
    }
    for (k, &child) in node.children.iter().enumerate() {
        let corner = |side: usize| [0, 1, 2].map(|axis| node.boxes.planes[axis][side].lane(k));
        let (lo, hi) = (corner(0), corner(1));
        if k >= present {
            if child != NodeRef::NONE || lo != [f32::INFINITY; 3] || hi != [f32::NEG_INFINITY; 3] {
                return Err(format!("absent child {k} of node {i} can be met"));
            }
            continue;
        }
        if !holds(room, &(lo, hi)) {
            return Err(format!("child {k} of node {i} sticks out of its parent"));
        }
        visit(tree, child, &(lo, hi), depth + 1, seen)?;
    }
    Ok(())
}

/// Returns true if the first box contains the second.
fn holds(outer: &Box3, inner: &Box3) -> bool {
    (0..3).all(|k| outer.0[k] <= inner.0[k] && inner.1[k] <= outer.1[k])
}
