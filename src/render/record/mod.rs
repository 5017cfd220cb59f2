//! Records of all rays of one pixel, for inspecting a picture.
//!
//! A renderer takes its [`Recorder`] as a type. [`Off`], used for every picture, does nothing and costs nothing.
//! [`Tree`] keeps every ray with its hit, its division of light, its contributions and the rays that were cut.

mod event;
mod follow;

pub use event::{Cut, Event, Met, Share, Source, Split};

use super::RayKind;
pub(super) use follow::record;
use glam::DVec3;

/// Index of a ray in [`Tree::events`].
pub type Node = u32;

/// Largest number of rays kept. A depth of 16 through nested glass has some 2^17.
const MOST_EVENTS: usize = 1 << 20;

/// Recorder of a renderer's work.
pub trait Recorder: Default + Send {
    /// True if the recorder keeps anything. Guards computations that only a recorder needs.
    const ON: bool;

    /// Records something by `what`; [`Off`] never calls it.
    fn note<T: Default>(&mut self, what: impl FnOnce(&mut Tree) -> T) -> T;
}

/// Recorder that keeps nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Off;

impl Recorder for Off {
    const ON: bool = false;

    #[inline(always)]
    fn note<T: Default>(&mut self, _what: impl FnOnce(&mut Tree) -> T) -> T {
        T::default()
    }
}

/// Tree of a pixel's rays, each after the one that sent it. Numbers of an `f32` renderer are widened without loss.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// All rays. Camera rays are those without a parent, in the order of the samples.
    pub events: Vec<Event>,
    /// Number of rays left out because there were too many.
    pub left_out: u64,
}

impl Recorder for Tree {
    const ON: bool = true;

    #[inline(always)]
    fn note<T: Default>(&mut self, what: impl FnOnce(&mut Self) -> T) -> T {
        what(self)
    }
}

impl Tree {
    /// Adds a ray that was sent, and returns its index. If the tree is full, counts the ray and returns `Node::MAX`.
    pub fn sent(&mut self, ray: Event) -> Node {
        if self.events.len() >= MOST_EVENTS {
            self.left_out += 1;
            return Node::MAX;
        }
        self.events.push(ray);
        (self.events.len() - 1) as Node
    }

    /// Changes the record of a ray, if it was kept.
    pub fn at(&mut self, node: Node, change: impl FnOnce(&mut Event)) {
        if let Some(event) = self.events.get_mut(node as usize) {
            change(event);
        }
    }

    /// Returns, for each ray, the rays that it sent, in order.
    #[must_use]
    pub fn children(&self) -> Vec<Vec<Node>> {
        let mut children = vec![Vec::new(); self.events.len()];
        for (i, event) in self.events.iter().enumerate() {
            if let Some(parent) = event.parent {
                children[parent as usize].push(i as Node);
            }
        }
        children
    }

    /// Returns the camera rays, in the order of the samples.
    #[must_use]
    pub fn roots(&self) -> Vec<Node> {
        let is_root = |i: &usize| self.events[*i].parent.is_none();
        (0..self.events.len()).filter(is_root).map(|i| i as Node).collect()
    }

    /// Iterates over all contributions to the pixel, in no particular order.
    pub fn shares(&self) -> impl Iterator<Item = &Share> {
        self.events.iter().flat_map(|event| &event.shares)
    }

    /// Returns, for each ray, the radiance and the truncated weight of its subtree.
    #[must_use]
    pub fn totals(&self) -> Vec<(DVec3, DVec3)> {
        let own = |event: &Event| {
            let added: DVec3 = event.shares.iter().map(|share| share.radiance).sum();
            let cut: DVec3 = event.cut.iter().map(|cut| cut.weight).sum();
            (added, cut)
        };
        let mut totals: Vec<_> = self.events.iter().map(own).collect();
        // A ray follows the one that sent it.
        for i in (0..totals.len()).rev() {
            if let Some(parent) = self.events[i].parent {
                let (added, cut) = totals[i];
                totals[parent as usize].0 += added;
                totals[parent as usize].1 += cut;
            }
        }
        totals
    }

    /// Returns the number of rays of a kind.
    #[must_use]
    pub fn count(&self, kind: RayKind) -> usize {
        self.events.iter().filter(|event| event.kind == kind).count()
    }
}
