//! What becomes of the rays of one pixel, written down: for looking into a picture, not for making one.
//!
//! A renderer takes its [`Recorder`] as a type. [`Off`], every picture's, has nothing to call, so that nothing is paid
//! for; [`Tree`] keeps every ray with what it met, how it was split, what it added to the pixel and what was cut off.

mod event;
mod follow;

pub use event::{Cut, Event, Met, Share, Source, Split};

use super::RayKind;
pub(super) use follow::record;
use glam::DVec3;

/// A ray's place in [`Tree::events`].
pub type Node = u32;

/// Events that are kept, at most: a depth of 16 through nested glass has some 2^17.
const MOST_EVENTS: usize = 1 << 20;

/// Something that may keep what a renderer does.
pub trait Recorder: Default + Send {
    /// Whether it does. What only a recorder needs is worked out under this.
    const ON: bool;

    /// Writes something down; [`Off`] never calls `what`.
    fn note<T: Default>(&mut self, what: impl FnOnce(&mut Tree) -> T) -> T;
}

/// Keeps nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Off;

impl Recorder for Off {
    const ON: bool = false;

    #[inline(always)]
    fn note<T: Default>(&mut self, _what: impl FnOnce(&mut Tree) -> T) -> T {
        T::default()
    }
}

/// The rays of a pixel, each after the one that sent it. Numbers of an `f32` renderer are widened, which loses nothing.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Every ray, camera rays among them: those with no parent, in the order of the samples.
    pub events: Vec<Event>,
    /// Rays that were too many to be kept.
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
    /// Adds a ray that was sent; what there is no room for is counted, and gets no number of its own.
    pub fn sent(&mut self, ray: Event) -> Node {
        if self.events.len() >= MOST_EVENTS {
            self.left_out += 1;
            return Node::MAX;
        }
        self.events.push(ray);
        (self.events.len() - 1) as Node
    }

    /// Changes what is known of a ray, where it was kept.
    pub fn at(&mut self, node: Node, change: impl FnOnce(&mut Event)) {
        if let Some(event) = self.events.get_mut(node as usize) {
            change(event);
        }
    }

    /// The rays that `node` sent, in the order in which they were sent.
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

    /// Camera rays, in the order of the samples.
    #[must_use]
    pub fn roots(&self) -> Vec<Node> {
        let is_root = |i: &usize| self.events[*i].parent.is_none();
        (0..self.events.len()).filter(is_root).map(|i| i as Node).collect()
    }

    /// Everything that was added to the pixel by itself, in no order that matters.
    pub fn shares(&self) -> impl Iterator<Item = &Share> {
        self.events.iter().flat_map(|event| &event.shares)
    }

    /// For each ray, what it and all that follows from it added to the pixel: radiance, and weight cut off.
    #[must_use]
    pub fn totals(&self) -> Vec<(DVec3, DVec3)> {
        let own = |event: &Event| {
            let added: DVec3 = event.shares.iter().map(|share| share.radiance).sum();
            let cut: DVec3 = event.cut.iter().map(|cut| cut.weight).sum();
            (added, cut)
        };
        let mut totals: Vec<_> = self.events.iter().map(own).collect();
        // A ray comes after the one that sent it.
        for i in (0..totals.len()).rev() {
            if let Some(parent) = self.events[i].parent {
                let (added, cut) = totals[i];
                totals[parent as usize].0 += added;
                totals[parent as usize].1 += cut;
            }
        }
        totals
    }

    /// How many rays of a kind there are.
    #[must_use]
    pub fn count(&self, kind: RayKind) -> usize {
        self.events.iter().filter(|event| event.kind == kind).count()
    }
}
