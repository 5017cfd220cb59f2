//! Streams of rays that wait to be traced, and what the renderer knows of each beside the ray itself.

use glam::Vec3;

use super::extra::Extra8;
use super::media::StackId;
use crate::geometry::{GeometryMask, Ray8};
use crate::simd::{F32x8, Vec3x8, set_lanes};

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
    /// Surfaces in a row that it has passed and that were not there; or, on its way through touching surfaces, what
    /// [`super::touch`] makes of it.
    pub passes: [u32; 8],
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

/// Rays in full packets (but for one), with their states.
#[derive(Debug, Default)]
pub struct Queue {
    /// Packets; all but one at most have eight active lanes.
    pub rays: Vec<Ray8>,
    /// One for each packet.
    pub states: Vec<State8>,
    /// One for each packet, where `carries`; else none.
    pub extras: Vec<Extra8>,
    /// Whether rays carry extras.
    carries: bool,
    /// The packet that is being filled, while it has free lanes.
    filling: usize,
    /// How many it has.
    free: usize,
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
    pub passes: &'a [u32; 8],
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
        self.rays.len() * 8 - self.free
    }

    /// Whether none wait.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Appends the lanes in `lanes`. Eight rays are a packet as they come, whatever is being filled meanwhile; but extras
    /// are found by counting rays, and need their order.
    #[inline]
    pub fn push8(&mut self, lanes: u8, new: &Spawn8) {
        if lanes != u8::MAX || self.carries {
            return self.push_in_order(lanes, new);
        }
        let &Spawn8 { origin, dir, t_max, admits, weight, lead, .. } = new;
        self.rays.push(Ray8 { origin, dir, t_max, active: lanes, admits, ..Ray8::default() });
        self.states.push(State8 { weight, pixel: *new.pixel, stack: *new.stack, lead, passes: *new.passes });
    }

    /// Appends the lanes in `lanes`, lowest first, filling packets without gaps: where nothing else appends, rays lie in
    /// the order they came in.
    pub fn push_in_order(&mut self, lanes: u8, new: &Spawn8) {
        if self.carries {
            self.push_extras(lanes, new);
        }
        for lane in set_lanes(lanes) {
            if self.free == 0 {
                (self.filling, self.free) = (self.rays.len(), 8);
                self.rays.push(Ray8::default());
                self.states.push(State8::default());
            }
            let slot = 8 - self.free;
            self.free -= 1;
            let ray = &mut self.rays[self.filling];
            ray.origin.x.set_lane(slot, new.origin.x.lane(lane));
            ray.origin.y.set_lane(slot, new.origin.y.lane(lane));
            ray.origin.z.set_lane(slot, new.origin.z.lane(lane));
            ray.dir.x.set_lane(slot, new.dir.x.lane(lane));
            ray.dir.y.set_lane(slot, new.dir.y.lane(lane));
            ray.dir.z.set_lane(slot, new.dir.z.lane(lane));
            ray.t_max.set_lane(slot, new.t_max.lane(lane));
            ray.active |= 1 << slot;
            ray.admits = new.admits;
            let state = &mut self.states[self.filling];
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
        for (slot, lane) in (self.len()..).zip(set_lanes(lanes)) {
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
        if self.filling >= keep {
            self.free = 0;
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Pushes rays each of which bears its pixel's number as a coordinate, counted on from `first`.
    fn push(queue: &mut Queue, lanes: u8, first: u32) {
        let pixel: [u32; 8] = std::array::from_fn(|k| first + k as u32);
        queue.push8(
            lanes,
            &Spawn8 {
                origin: Vec3x8::all(F32x8::from_fn(|k| pixel[k] as f32)),
                dir: Vec3x8::splat(Vec3::Z),
                t_max: F32x8::ONE,
                admits: GeometryMask::OPAQUE,
                weight: Vec3x8::splat(Vec3::ONE),
                pixel: &pixel,
                stack: &[StackId::default(); 8],
                lead: F32x8::from_fn(|k| pixel[k] as f32),
                passes: &pixel,
                place: 0,
                extra: None,
            },
        );
    }

    /// The pixels of a queue's last packets, packet by packet, once everything else about their rays is found to fit.
    fn taken(queue: &mut Queue, packets: usize) -> Vec<Vec<u32>> {
        let mut chunk = Chunk::default();
        queue.take(packets, &mut chunk);
        let pixels = |(ray, state): (&Ray8, &State8)| {
            assert!(ray.admits == GeometryMask::OPAQUE && ray.t_min == F32x8::ZERO);
            let lanes = set_lanes(ray.active).map(|lane| {
                let pixel = state.pixel[lane];
                assert_eq!(ray.origin.lane(lane), Vec3::splat(pixel as f32));
                assert_eq!((ray.dir.lane(lane), ray.t_max.lane(lane)), (Vec3::Z, 1.0));
                assert_eq!((state.weight.lane(lane), state.lead.lane(lane)), (Vec3::ONE, pixel as f32));
                assert_eq!(state.passes[lane], pixel);
                pixel
            });
            lanes.collect()
        };
        chunk.rays.iter().zip(&chunk.states).map(pixels).collect()
    }

    #[test]
    fn eight_rays_stay_together_and_fewer_leave_no_gaps() {
        let mut queue = Queue::new(false);
        push(&mut queue, 0b101, 0);
        push(&mut queue, 0xff, 10);
        push(&mut queue, 0b111, 20);
        push(&mut queue, 0xff, 30);
        push(&mut queue, 0, 40);
        push(&mut queue, 0b1111_0000, 50);
        assert_eq!(queue.len(), 25);
        let eight = |first: u32| -> Vec<u32> { (first..first + 8).collect() };
        assert_eq!(taken(&mut queue, 2), [eight(30), vec![57]]);
        assert_eq!(queue.len(), 16);
        // The packet that was being filled is gone.
        push(&mut queue, 0b10, 60);
        assert_eq!(queue.len(), 17);
        assert_eq!(taken(&mut queue, usize::MAX), [vec![0, 2, 20, 21, 22, 54, 55, 56], eight(10), vec![61]]);
        assert!(queue.is_empty());
        assert_eq!(queue.len(), 0);
    }

    #[test]
    fn a_packet_that_is_being_filled_stays_behind() {
        let mut queue = Queue::new(false);
        push(&mut queue, 0b1, 0);
        push(&mut queue, 0xff, 10);
        assert_eq!(taken(&mut queue, 1), [(10..18).collect::<Vec<u32>>()]);
        assert_eq!(queue.len(), 1);
        push(&mut queue, 0b10, 20);
        assert_eq!(taken(&mut queue, 1), [[0, 21]]);
    }

    #[test]
    fn rays_that_carry_extras_keep_their_order() {
        let mut queue = Queue::new(true);
        push(&mut queue, 0b1, 0);
        push(&mut queue, 0xff, 10);
        assert_eq!((queue.len(), queue.extras.len()), (9, 2));
        assert_eq!(taken(&mut queue, usize::MAX), [vec![0, 10, 11, 12, 13, 14, 15, 16], vec![17]]);
    }
}
