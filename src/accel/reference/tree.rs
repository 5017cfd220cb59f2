//! Binary hierarchy of `f64` boxes, split at the median.

use std::ops::ControlFlow;

use glam::DVec3;

use super::primitive::{Form, Primitive};
use super::{Budget, Ray64};

/// Largest number of primitives in a leaf.
const LEAF: usize = 4;

/// Growth of boxes for rays that need exactly the hits of the `f64` tests, in units of `f64::EPSILON` and of the box's
/// farthest coordinate from the ray's origin. The tests of primitives move a corner by at most 3 such units
/// (difference, product, difference), the slab test by 2.
pub(super) const EXACT: f64 = 8.0;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box64 {
    pub lo: DVec3,
    pub hi: DVec3,
}

impl Box64 {
    const EMPTY: Self = Self { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    fn union(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Returns the box of a primitive; `None` for planes.
    fn of(primitive: &Primitive) -> Option<Self> {
        match primitive.form {
            Form::Triangle([a, b, c]) => Some(Self { lo: a.min(b).min(c), hi: a.max(b).max(c) }),
            Form::Sphere { centre, radius } => {
                let outward = |p: DVec3, f: fn(f64) -> f64| DVec3::new(f(p.x), f(p.y), f(p.z));
                Some(Self { lo: outward(centre - radius, f64::next_down), hi: outward(centre + radius, f64::next_up) })
            }
            Form::Plane { .. } => None,
        }
    }

    /// Returns the parameter at which `ray` enters this box, grown by `slack`, if it is at most `far`.
    fn entry(&self, ray: &Ray64, slack: f64, far: f64) -> Option<f64> {
        let (lo, hi) = (self.lo - ray.origin, self.hi - ray.origin);
        let growth = DVec3::splat(slack * f64::EPSILON * lo.abs().max(hi.abs()).max_element());
        let (lo, hi) = (lo - growth, hi + growth);
        let (mut near, mut far) = (ray.t_min, far);
        for axis in 0..3 {
            if ray.dir[axis] == 0.0 {
                if lo[axis] > 0.0 || hi[axis] < 0.0 {
                    return None;
                }
                continue;
            }
            let (s, t) = (lo[axis] / ray.dir[axis], hi[axis] / ray.dir[axis]);
            near = near.max(s.min(t));
            far = far.min(s.max(t));
        }
        (near <= far).then_some(near)
    }
}

#[derive(Clone, Copy, Debug)]
enum Content {
    /// Indices of two nodes.
    Inner([usize; 2]),
    /// A range of `order`.
    Leaf { first: usize, count: usize },
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Box64,
    content: Content,
}

/// Hierarchy over a list of primitives. Planes are in a separate list, since no box holds them.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Indices in the list of primitives.
    order: Vec<usize>,
    unbounded: Vec<usize>,
}

impl Tree {
    /// Largest number of bytes that a build takes for each primitive: its box while it is sorted, its index in `order`
    /// and a node (halving fills leaves at least half). All lists grow by doubling.
    pub const BYTES_EACH: usize = 2 * (size_of::<(usize, Box64)>() + size_of::<usize>() + size_of::<Node>());

    pub fn build(primitives: &[Primitive]) -> Self {
        let mut items = Vec::new();
        let mut tree = Self::default();
        for (i, primitive) in primitives.iter().enumerate() {
            match Box64::of(primitive) {
                Some(bounds) => items.push((i, bounds)),
                None => tree.unbounded.push(i),
            }
        }
        if !items.is_empty() {
            tree.grow(&mut items);
        }
        tree
    }

    /// Builds the subtree over `items` and returns its node. Halving bounds the depth by log2 of their number.
    fn grow(&mut self, items: &mut [(usize, Box64)]) -> usize {
        let bounds = items.iter().fold(Box64::EMPTY, |b, item| b.union(item.1));
        let node = self.nodes.len();
        if items.len() <= LEAF {
            let content = Content::Leaf { first: self.order.len(), count: items.len() };
            self.order.extend(items.iter().map(|item| item.0));
            self.nodes.push(Node { bounds, content });
            return node;
        }
        let centre = |b: &Box64| b.lo + b.hi;
        let (lo, hi) = items.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), item| {
            (lo.min(centre(&item.1)), hi.max(centre(&item.1)))
        });
        let axis = (hi - lo).max_position();
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |a, b| {
            centre(&a.1)[axis].total_cmp(&centre(&b.1)[axis]).then(a.0.cmp(&b.0))
        });
        self.nodes.push(Node { bounds, content: Content::Inner([0; 2]) });
        let (left, right) = items.split_at_mut(middle);
        let children = [self.grow(left), self.grow(right)];
        self.nodes[node].content = Content::Inner(children);
        node
    }

    /// Calls `visit` with the index of every primitive whose box, grown by `slack`, the ray enters, nearer boxes first.
    /// `visit` returns the parameter beyond which it needs no primitives, or breaks off. The traversal also ends if
    /// `budget` is spent.
    pub fn walk(
        &self,
        ray: &Ray64,
        slack: f64,
        budget: &mut Budget,
        mut visit: impl FnMut(usize, &mut Budget) -> ControlFlow<(), f64>,
    ) {
        let mut far = ray.t_max;
        let mut show = |i: usize, far: &mut f64, budget: &mut Budget| {
            budget.spend(Budget::TEST);
            match visit(i, budget) {
                ControlFlow::Continue(limit) => {
                    *far = limit;
                    !budget.is_spent()
                }
                ControlFlow::Break(()) => false,
            }
        };
        if !self.unbounded.iter().all(|&i| show(i, &mut far, budget)) {
            return;
        }
        let enter = |node: usize, far: f64| self.nodes[node].bounds.entry(ray, slack, far).map(|t| (t, node));
        let mut pending: Vec<(f64, usize)> = Vec::new();
        if !self.nodes.is_empty() {
            pending.extend(enter(0, far));
        }
        while let Some((t, node)) = pending.pop() {
            if t > far {
                continue;
            }
            budget.spend(Budget::BOX);
            match self.nodes[node].content {
                Content::Leaf { first, count } => {
                    if !self.order[first..first + count].iter().all(|&i| show(i, &mut far, budget)) {
                        return;
                    }
                }
                Content::Inner([left, right]) => match (enter(left, far), enter(right, far)) {
                    (Some(l), Some(r)) if l.0 <= r.0 => pending.extend([r, l]),
                    (l, r) => pending.extend(l.into_iter().chain(r)),
                },
            }
        }
    }

    /// Numbers of inner nodes, leaves, and levels of inner nodes.
    pub fn shape(&self) -> (usize, usize, usize) {
        let leaves = self.nodes.iter().filter(|n| matches!(n.content, Content::Leaf { .. })).count();
        (self.nodes.len() - leaves, leaves, if self.nodes.is_empty() { 0 } else { self.levels(0) })
    }

    fn levels(&self, node: usize) -> usize {
        match self.nodes[node].content {
            Content::Leaf { .. } => 0,
            Content::Inner([l, r]) => 1 + self.levels(l).max(self.levels(r)),
        }
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + (self.order.len() + self.unbounded.len()) * size_of::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_grows_by_its_slack_and_no_more() {
        let unit = Box64 { lo: DVec3::ZERO, hi: DVec3::ONE };
        let beside = |ulps: f64| Ray64::new(DVec3::new(-5.0, 1.0 + ulps * f64::EPSILON, 0.5), DVec3::X);
        // Its farthest coordinate is 6 away: 48 ulp.
        assert!(unit.entry(&beside(40.0), EXACT, f64::INFINITY).is_some());
        assert!(unit.entry(&beside(60.0), EXACT, f64::INFINITY).is_none());
    }

    /// Case RB-03 of the catalogue.
    #[test]
    fn flat_boxes_and_rays_along_their_faces_are_entered_whatever_the_sign_of_zero() {
        let flat = Box64 { lo: DVec3::ZERO, hi: DVec3::new(1.0, 1.0, 0.0) };
        for zero in [0.0, -0.0] {
            let along = Ray64::new(DVec3::new(-1.0, 1.0, 0.0), DVec3::new(1.0, zero, zero));
            assert!(flat.entry(&along, EXACT, f64::INFINITY).is_some());
            let above = Ray64::new(DVec3::new(-1.0, 1.0, 0.1), DVec3::new(1.0, zero, zero));
            assert!(flat.entry(&above, EXACT, f64::INFINITY).is_none());
        }
        let back = Ray64::new(DVec3::new(-1.0, 0.5, 0.0), -DVec3::X);
        assert!(flat.entry(&back, EXACT, f64::INFINITY).is_none());
    }
}
