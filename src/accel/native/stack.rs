//! What is still to be visited.

use super::bvh8::Child;
use super::traverse_batch::Batch;
use super::traverse_stream::Tile;

/// Entries that the deepest tree a builder may make can fill: seven a level, and one.
pub(super) const STACK_SIZE: usize = 512;

/// Something to visit, unless a hit nearer than its box has been found meanwhile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Where the box is entered; of many rays, no later than by the first of them.
    pub enter: f32,
    /// What is in it.
    pub child: Child,
    /// Of eight groups of rays, those that meet the box.
    pub lanes: u8,
}

/// A stack of fixed size.
pub(super) type Stack = [Entry; STACK_SIZE];

/// What is kept between rays so that tracing allocates nothing.
#[derive(Debug)]
pub struct Scratch {
    /// For one ray.
    pub(super) single: Box<Stack>,
    /// For a tile.
    pub(super) stack: Box<Stack>,
    /// Packets that go together.
    pub(super) tile: Tile,
    /// What scattered rays are gathered in.
    pub(super) batch: Batch,
}

impl Default for Scratch {
    fn default() -> Self {
        let empty = [Entry { enter: 0.0, child: Child::NONE, lanes: 0 }; STACK_SIZE];
        Self { single: Box::new(empty), stack: Box::new(empty), tile: Tile::default(), batch: Batch::default() }
    }
}

/// Sorts what a node has just pushed so that the nearest comes off first. Only speed rests on the order.
#[inline(always)]
pub(super) fn nearest_last(pushed: &mut [Entry]) {
    for i in 1..pushed.len() {
        let entry = pushed[i];
        let mut k = i;
        while k > 0 && pushed[k - 1].enter < entry.enter {
            pushed[k] = pushed[k - 1];
            k -= 1;
        }
        pushed[k] = entry;
    }
}
