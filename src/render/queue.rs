//! Streams of rays that wait to be traced, and what the renderer knows of each beside the ray itself.

use glam::Vec3;

use super::accumulate::set_lanes;
use super::extra::Extra8;
use super::media::StackId;
use crate::geometry::{GeometryMask, Ray8};
use crate::simd::{F32x8, Vec3x8};

/// Eight linear colours.
pub type Rgb8 = Vec3x8;

/// What travels beside a `Ray8`.
#[derive(Clone, Copy, Debug)]
pub struct State8 {
    /// How much of what the ray brings reaches the pixel, per channel.
    pub weight: Rgb8,
    /// The pixel, counted within the tile.
    pub pixel: [u32; 8],
    /// The media around the ray.
    pub stack: [StackId; 8],
    /// How far the ray's start lies from the surface it leaves, along the ray: absorption counts from the surface.
    pub lead: F32x8,
    /// How many surfaces in a row it has passed that were not there.
    pub passes: [u16; 8],
}

impl Default for State8 {
    fn default() -> Self {
        Self {
            weight: Vec3x8::splat(Vec3::ZERO),
            pixel: [0; 8],
            stack: [StackId::default(); 8],
            lead: F32x8::ZERO,
            passes: [0; 8],
        }
    }
}

/// Rays in full packets (but for the last), with their states.
#[derive(Debug, Default)]
pub struct Queue {
    /// Packets; all but the last have eight active lanes.
    pub rays: Vec<Ray8>,
    /// One for each packet.
    pub states: Vec<State8>,
    /// One for each packet, where `carries`; else none.
    pub extras: Vec<Extra8>,
    /// Whether rays carry extras.
    carries: bool,
    /// Rays in all.
    len: usize,
}

/// Rays about to be queued: eight lanes of everything.
#[derive(Clone, Copy, Debug)]
pub struct Spawn8<'a> {
    /// Where they start.
    pub origin: Vec3x8,
    /// Where they go, of unit length.
    pub dir: Vec3x8,
    /// Where they end.
    pub t_max: F32x8,
    /// The kinds of geometry they look for.
    pub admits: GeometryMask,
    /// Their weights.
    pub weight: Rgb8,
    /// Their pixels.
    pub pixel: &'a [u32; 8],
    /// The media around them.
    pub stack: &'a [StackId; 8],
    /// Distances along the rays from the surfaces they leave to their starts.
    pub lead: F32x8,
    /// Surfaces passed that were not there.
    pub passes: &'a [u16; 8],
    /// Place of the surface they leave in the stream at hand, as [`super::surface::Surface8`] has it.
    pub place: u32,
    /// What they carry, where extras are carried and they do not start afresh.
    pub extra: Option<&'a Extra8>,
}

impl Queue {
    /// An empty one, whose rays carry extras or not.
    #[must_use]
    pub fn new(carries: bool) -> Self {
        Self { carries, ..Self::default() }
    }

    /// How many rays wait.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether none wait.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Appends the lanes in `lanes`, lowest first, filling packets without gaps.
    #[inline]
    pub fn push8(&mut self, lanes: u8, new: &Spawn8) {
        if self.carries {
            self.push_extras(lanes, new);
        }
        for lane in set_lanes(lanes) {
            let slot = self.len % 8;
            if slot == 0 {
                self.rays.push(Ray8::default());
                self.states.push(State8::default());
            }
            self.len += 1;
            // The last packet exists: it was pushed above, or holds slot - 1.
            let last = self.rays.len() - 1;
            let ray = &mut self.rays[last];
            ray.origin.x.set_lane(slot, new.origin.x.lane(lane));
            ray.origin.y.set_lane(slot, new.origin.y.lane(lane));
            ray.origin.z.set_lane(slot, new.origin.z.lane(lane));
            ray.dir.x.set_lane(slot, new.dir.x.lane(lane));
            ray.dir.y.set_lane(slot, new.dir.y.lane(lane));
            ray.dir.z.set_lane(slot, new.dir.z.lane(lane));
            ray.t_max.set_lane(slot, new.t_max.lane(lane));
            ray.active |= 1 << slot;
            ray.admits = new.admits;
            let state = &mut self.states[last];
            state.weight.x.set_lane(slot, new.weight.x.lane(lane));
            state.weight.y.set_lane(slot, new.weight.y.lane(lane));
            state.weight.z.set_lane(slot, new.weight.z.lane(lane));
            state.pixel[slot] = new.pixel[lane];
            state.stack[slot] = new.stack[lane];
            state.lead.set_lane(slot, new.lead.lane(lane));
            state.passes[slot] = new.passes[lane];
        }
    }

    /// The extras of rays that are about to be pushed.
    #[cold]
    fn push_extras(&mut self, lanes: u8, new: &Spawn8) {
        let extra = new.extra.copied().unwrap_or_else(|| Extra8::fresh(new.dir));
        for (slot, lane) in (self.len..).zip(set_lanes(lanes)) {
            if slot / 8 == self.extras.len() {
                self.extras.push(Extra8::default());
            }
            self.extras[slot / 8].put(slot % 8, &extra, lane);
        }
    }

    /// Moves the last packets, `packets` of them at most, to the end of `chunk`.
    pub fn take(&mut self, packets: usize, chunk: &mut Chunk) {
        let keep = self.rays.len().saturating_sub(packets);
        chunk.rays.extend(self.rays.drain(keep..));
        chunk.states.extend(self.states.drain(keep..));
        if self.carries {
            chunk.extras.extend(self.extras.drain(keep..));
        }
        // What stays is full packets only.
        self.len = keep * 8;
    }
}

/// Packets being traced and shaded now.
#[derive(Debug, Default)]
pub struct Chunk {
    /// Rays.
    pub rays: Vec<Ray8>,
    /// One for each packet of rays.
    pub states: Vec<State8>,
    /// One for each packet of rays, where extras are carried; else none.
    pub extras: Vec<Extra8>,
}

impl Chunk {
    /// Forgets its packets, keeps its memory.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.states.clear();
        self.extras.clear();
    }

    /// Active rays.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.rays.iter().map(|r| u64::from(r.active.count_ones())).sum()
    }
}
