//! Which kernel takes which rays. All kernels give the same bits, so the choice is about speed alone.

use super::bvh8::Bvh8;
use super::leaf::{Best8, Leaf};
use super::rays::{Eight, One};
use super::stack::Stack;
use super::{traverse_packet, traverse_single};
use crate::accel::Coherence;

/// How rays are walked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Each ray alone.
    Single,
    /// Together with those of its packet that run into the same octant, however few.
    Packet,
    /// As the stream's coherence and the packet's occupancy suggest.
    Auto,
}

/// Fewer rays than this are walked one by one.
const WORTH_A_PACKET: u32 = 4;

impl Kernel {
    /// Whether `lanes`, which run into one octant, are walked together.
    #[inline(always)]
    fn together(self, coherence: Coherence, lanes: u8) -> bool {
        match self {
            Self::Single => false,
            Self::Packet => true,
            Self::Auto => coherence == Coherence::Coherent && lanes.count_ones() >= WORTH_A_PACKET,
        }
    }
}

/// The nearest hits of one packet, taken into `best`.
#[inline(always)]
pub(super) fn closest<L: Leaf>(
    tree: &Bvh8<L>,
    rays: &Eight,
    kernel: Kernel,
    coherence: Coherence,
    best: &mut Best8,
    stack: &mut Stack,
) {
    let mut left = rays.lanes;
    while left != 0 {
        let group = rays.same_octant(left);
        left &= !group;
        if kernel.together(coherence, group) {
            traverse_packet::closest(tree, rays, group, best, stack);
            continue;
        }
        each(group, |i| {
            let mut one = best.lane(i);
            traverse_single::closest(tree, tree.root, &One::new(rays, i), &mut one, stack);
            best.set_lane(i, &one);
        });
    }
}

/// Which rays of `lanes` meet anything.
#[inline(always)]
pub(super) fn occluded<L: Leaf>(
    tree: &Bvh8<L>,
    rays: &Eight,
    lanes: u8,
    kernel: Kernel,
    coherence: Coherence,
    stack: &mut Stack,
) -> u8 {
    let mut blocked = 0;
    let mut left = lanes;
    while left != 0 {
        let group = rays.same_octant(left);
        left &= !group;
        if kernel.together(coherence, group) {
            blocked |= traverse_packet::occluded(tree, rays, group, rays.t_max, stack);
            continue;
        }
        each(group, |i| {
            let met = traverse_single::occluded(tree, tree.root, &One::new(rays, i), rays.t_max.lane(i), stack);
            blocked |= u8::from(met) << i;
        });
    }
    blocked
}

/// Calls `f` with each lane.
#[inline(always)]
fn each(mut lanes: u8, mut f: impl FnMut(usize)) {
    while lanes != 0 {
        f(lanes.trailing_zeros() as usize & 7);
        lanes &= lanes - 1;
    }
}
