//! Pairs of boxes that overlap, among many: a tree of boxes, joined with itself.

use rayon::prelude::*;

use crate::math::{next_down, next_up};

/// Dimensions of a box.
const AXES: usize = 8;

/// Items of a leaf, at most.
const LEAF: usize = 8;

/// Items from which the halves of a node are worked on side by side.
const MANY: usize = 2048;

/// Cuts of the grid along whose cells items are sorted.
const CUTS: usize = 64;

/// The group of a node whose items belong to several.
const MIXED: u32 = u32::MAX;

/// A box: bounds on each axis. An axis on which all boxes agree tells nothing and costs next to nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    lo: [f32; AXES],
    hi: [f32; AXES],
}

/// A box with the number of its owner. Boxes of one group are not held against each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub extent: Extent,
    pub group: u32,
    pub id: u32,
}

impl Extent {
    const EMPTY: Self = Self { lo: [f32::INFINITY; AXES], hi: [f32::NEG_INFINITY; AXES] };

    /// The bounds, rounded outwards. Bounds that are no numbers are none.
    pub fn new(bounds: [(f64, f64); AXES]) -> Self {
        let number = |x: f64, otherwise: f32| if x.is_nan() { otherwise } else { x as f32 };
        Self {
            lo: bounds.map(|(lo, _)| next_down(number(lo, f32::MIN))),
            hi: bounds.map(|(_, hi)| next_up(number(hi, f32::MAX))),
        }
    }

    #[inline]
    fn overlaps(&self, o: &Self) -> bool {
        (0..AXES).fold(true, |all, i| all & (self.lo[i] <= o.hi[i]) & (o.lo[i] <= self.hi[i]))
    }

    #[inline]
    fn with(&self, o: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|i| self.lo[i].min(o.lo[i])),
            hi: std::array::from_fn(|i| self.hi[i].max(o.hi[i])),
        }
    }

    #[inline]
    fn middle(&self, axis: usize) -> f32 {
        self.lo[axis] * 0.5 + self.hi[axis] * 0.5
    }

    #[inline]
    fn middles(&self) -> [f32; AXES] {
        std::array::from_fn(|axis| self.middle(axis))
    }
}

/// A node over a range of items.
struct Node {
    extent: Extent,
    group: u32,
    first: usize,
    count: usize,
    halves: Option<Box<[Node; 2]>>,
}

/// The pairs of items of different groups whose boxes overlap and that `meet` admits, in no particular order. `meet` is
/// asked once for each pair.
pub(super) fn pairs(mut items: Vec<Item>, meet: &(dyn Fn(u32, u32) -> bool + Sync)) -> Vec<[u32; 2]> {
    let Some(first) = items.first() else { return Vec::new() };
    if items.iter().all(|item| item.group == first.group) {
        return Vec::new();
    }
    sort(&mut items);
    let root = build(&items, 0);
    Join { items: &items, meet }.within(&root)
}

/// Sorts items along a curve through the cells of a grid, as Morton codes do, so that items in a row lie near each other.
/// The grid is halved along the axis on which its cells are longest; lengths count in mean sizes of the boxes.
fn sort(items: &mut Vec<Item>) {
    let sizes: [f64; AXES] = std::array::from_fn(|axis| {
        let size = |item: &Item| f64::from(item.extent.hi[axis]) - f64::from(item.extent.lo[axis]);
        items.par_iter().map(size).sum::<f64>() / items.len() as f64
    });
    let middle = |item: &Item| Extent { lo: item.extent.middles(), hi: item.extent.middles() };
    let middles = items.par_iter().map(middle).reduce(|| Extent::EMPTY, |a, b| a.with(&b));
    let spread: [f32; AXES] = std::array::from_fn(|axis| middles.hi[axis] - middles.lo[axis]);
    let counts = |axis: usize| sizes[axis] > 0.0 && spread[axis] > 0.0 && spread[axis].is_finite();
    let mut lengths: [f64; AXES] =
        std::array::from_fn(|axis| if counts(axis) { f64::from(spread[axis]) / sizes[axis] } else { 0.0 });
    let cuts: Vec<usize> = std::iter::repeat_with(|| {
        let longest = (1..AXES).fold(0, |best, axis| if lengths[axis] > lengths[best] { axis } else { best });
        lengths[longest] *= 0.5;
        longest
    })
    .take(CUTS)
    .collect();
    let key = |item: &Item| {
        let mut cell: [u32; AXES] = std::array::from_fn(|axis| {
            let part = (item.extent.middle(axis) - middles.lo[axis]) / spread[axis];
            if counts(axis) { (part * u32::MAX as f32) as u32 } else { 0 }
        });
        cuts.iter().fold(0_u64, |key, &axis| {
            let bit = cell[axis] >> 31;
            cell[axis] <<= 1;
            key << 1 | u64::from(bit)
        })
    };
    let mut order: Vec<(u64, u32)> =
        items.par_iter().zip(0..items.len() as u32).map(|(item, i)| (key(item), i)).collect();
    order.par_sort_unstable();
    *items = order.into_par_iter().map(|(_, i)| items[i as usize]).collect();
}

/// Builds the tree over sorted items, of which the first has the number `first`.
fn build(items: &[Item], first: usize) -> Node {
    let count = items.len();
    if count <= LEAF {
        let extent = items.iter().fold(Extent::EMPTY, |all, item| all.with(&item.extent));
        let group = if items.iter().all(|item| item.group == items[0].group) { items[0].group } else { MIXED };
        return Node { extent, group, first, count, halves: None };
    }
    let half = count / 2;
    let (left, right) = items.split_at(half);
    let (left, right) = if count >= MANY {
        rayon::join(|| build(left, first), || build(right, first + half))
    } else {
        (build(left, first), build(right, first + half))
    };
    let group = if left.group == right.group { left.group } else { MIXED };
    let extent = left.extent.with(&right.extent);
    let whole = group != MIXED && count <= 4 * LEAF;
    Node { extent, group, first, count, halves: (!whole).then(|| Box::new([left, right])) }
}

struct Join<'a> {
    items: &'a [Item],
    meet: &'a (dyn Fn(u32, u32) -> bool + Sync),
}

impl Join<'_> {
    /// Pairs within a node.
    fn within(&self, node: &Node) -> Vec<[u32; 2]> {
        if node.group != MIXED {
            return Vec::new();
        }
        let Some(halves) = &node.halves else {
            let mut found = Vec::new();
            let items = self.of(node);
            for (k, a) in items.iter().enumerate() {
                items[k + 1..].iter().for_each(|b| self.hold(a, b, &mut found));
            }
            return found;
        };
        let [left, right] = &**halves;
        if node.count < MANY {
            let mut found = self.within(left);
            found.extend(self.within(right));
            self.across(left, right, &mut found);
            return found;
        }
        let (mut found, (right, across)) =
            rayon::join(|| self.within(left), || rayon::join(|| self.within(right), || self.across_many(left, right)));
        found.extend(right);
        found.extend(across);
        found
    }

    /// Pairs of an item of one node with one of another.
    fn across(&self, a: &Node, b: &Node, found: &mut Vec<[u32; 2]>) {
        if !a.extent.overlaps(&b.extent) || (a.group != MIXED && a.group == b.group) {
            return;
        }
        let (large, small) = if a.count >= b.count { (a, b) } else { (b, a) };
        match (&large.halves, &small.halves) {
            (Some(halves), _) => halves.iter().for_each(|half| self.across(half, small, found)),
            (None, Some(halves)) => halves.iter().for_each(|half| self.across(large, half, found)),
            (None, None) => {
                for x in self.of(large).iter().filter(|x| x.extent.overlaps(&small.extent)) {
                    self.of(small).iter().for_each(|y| self.hold(x, y, found));
                }
            }
        }
    }

    /// The same, side by side where there are many.
    fn across_many(&self, a: &Node, b: &Node) -> Vec<[u32; 2]> {
        let mut found = Vec::new();
        if !a.extent.overlaps(&b.extent) || (a.group != MIXED && a.group == b.group) {
            return found;
        }
        let (large, small) = if a.count >= b.count { (a, b) } else { (b, a) };
        match &large.halves {
            Some(halves) if large.count >= MANY => {
                let (mut left, right) =
                    rayon::join(|| self.across_many(&halves[0], small), || self.across_many(&halves[1], small));
                left.extend(right);
                left
            }
            _ => {
                self.across(a, b, &mut found);
                found
            }
        }
    }

    fn of(&self, node: &Node) -> &[Item] {
        &self.items[node.first..node.first + node.count]
    }

    #[inline]
    fn hold(&self, a: &Item, b: &Item, found: &mut Vec<[u32; 2]>) {
        if a.group != b.group && a.extent.overlaps(&b.extent) && (self.meet)(a.id, b.id) {
            found.push([a.id.min(b.id), a.id.max(b.id)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_overlapping_boxes_of_different_groups_is_found_once() {
        let mut state = 7_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        for (count, groups) in [(3, 2), (300, 5), (5000, 2), (5000, 300)] {
            let items: Vec<Item> = (0..count)
                .map(|id| {
                    let size = if id % 50 == 0 { 2.0 } else { 0.05 };
                    let bounds = std::array::from_fn(|axis| {
                        let lo = draw() * [1.0, 20.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0][axis];
                        (lo, lo + size * draw())
                    });
                    Item { extent: Extent::new(bounds), group: (draw() * f64::from(groups)) as u32, id }
                })
                .collect();
            let mut right = Vec::new();
            for (k, a) in items.iter().enumerate() {
                for b in &items[k + 1..] {
                    if a.group != b.group && a.extent.overlaps(&b.extent) && (a.id + b.id) % 3 > 0 {
                        right.push([a.id, b.id]);
                    }
                }
            }
            let mut found = pairs(items, &|a, b| (a + b) % 3 > 0);
            found.sort_unstable();
            assert_eq!(found, right);
        }
    }
}
