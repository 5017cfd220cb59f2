//! Which kernel takes which rays. All kernels give the same bits, so the choice is about speed alone.

use super::bvh8::Bvh8;
use super::leaf::{Best8, Leaf};
use super::rays::Eight;
use super::stack::Scratch;
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

/// Rays that are dealt with in one go.
struct Group {
    lanes: u8,
    together: bool,
}

impl Kernel {
    /// Some of `left`, at least one, to be dealt with next. The caller's word on coherence is checked, since
    /// walking scattered rays together costs more than walking them one by one; it lowers the number that is enough.
    #[inline(always)]
    fn next(self, rays: &Eight, left: u8, coherence: Coherence) -> Group {
        match self {
            Self::Single => Group { lanes: left, together: false },
            Self::Packet => Group { lanes: rays.same_octant(left), together: true },
            Self::Auto => {
                // A ray whose length overflows is not even its own neighbour.
                let lanes = rays.same_way(rays.same_octant(left)) | (left & left.wrapping_neg());
                let coherent = coherence == Coherence::Coherent;
                if lanes.count_ones() >= if coherent { 3 } else { 5 } {
                    Group { lanes, together: true }
                } else {
                    // Scattered rays are not searched any further for a few that agree.
                    Group { lanes: if coherent { lanes } else { left }, together: false }
                }
            }
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
    scratch: &mut Scratch,
) {
    let (mut left, mut alone) = (rays.lanes, 0);
    while left != 0 {
        let Group { lanes, together } = kernel.next(rays, left, coherence);
        left &= !lanes;
        if together {
            traverse_packet::closest(tree, rays, lanes, best, scratch);
        } else {
            alone |= lanes;
        }
    }
    if alone != 0 {
        traverse_single::closest_each(tree, tree.root, rays, alone, best, &mut scratch.single);
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
    scratch: &mut Scratch,
) -> u8 {
    let (mut left, mut alone, mut blocked) = (lanes, 0, 0);
    while left != 0 {
        let Group { lanes, together } = kernel.next(rays, left, coherence);
        left &= !lanes;
        if together {
            blocked |= traverse_packet::occluded(tree, rays, lanes, scratch);
        } else {
            alone |= lanes;
        }
    }
    if alone != 0 {
        blocked |= traverse_single::occluded_each(tree, tree.root, rays, alone, &mut scratch.single);
    }
    blocked
}
