//! Queues of rays that wait to be traced, with the state of each ray.

use glam::Vec3;

use super::extra::Extra8;
use super::media::StackId;
use crate::geometry::{GeometryMask, Ray8};
use crate::simd::{F32x8, Vec3x8, set_lanes};

/// Eight linear colours.
pub type Rgb8 = Vec3x8;

/// State of the eight rays of a `Ray8`.
#[derive(Clone, Copy, Debug)]
pub struct State8 {
    /// Throughput: factor per channel between the ray's radiance and its contribution to the pixel.
    pub weight: Rgb8,
    /// Index of the pixel within the tile.
    pub pixel: [u32; 8],
    /// Media around the ray.
    pub stack: [StackId; 8],
    /// Distance, along the ray, from the surface it leaves to its origin. Absorption counts from the surface.
    pub lead: F32x8,
    /// Number of consecutive surfaces that the ray has passed; or, on its way through touching surfaces, a value
    /// encoded by [`super::touch`].
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

/// Queue of rays and their states, in packets that are full except for at most one.
#[derive(Debug, Default)]
pub struct Queue {
    /// Packets. At most one has fewer than eight active lanes.
    pub rays: Vec<Ray8>,
    /// States, one per packet.
    pub states: Vec<State8>,
    /// Extras, one per packet if `carries`; else empty.
    pub extras: Vec<Extra8>,
    /// True if rays carry extras.
    carries: bool,
    /// Index of the packet that is being filled, valid while it has free lanes.
    filling: usize,
    /// Number of free lanes in that packet.
    free: usize,
}

/// Eight rays to be queued.
#[derive(Clone, Copy, Debug)]
pub struct Spawn8<'a> {
    /// Origins.
    pub origin: Vec3x8,
    /// Unit directions.
    pub dir: Vec3x8,
    /// Ends of the rays' intervals.
    pub t_max: F32x8,
    /// Classes of geometry that the rays can hit.
    pub admits: GeometryMask,
    /// Throughputs.
    pub weight: Rgb8,
    /// Indices of the pixels within the tile.
    pub pixel: &'a [u32; 8],
    /// Media around the rays.
    pub stack: &'a [StackId; 8],
    /// Distances along the rays from the surfaces they leave to their origins.
    pub lead: F32x8,
    /// Numbers of consecutive surfaces passed.
    pub passes: &'a [u32; 8],
    /// Index, in the current stream, of the packet of surfaces that they leave; see [`super::surface::Surface8`].
    pub place: u32,
    /// Extras, if rays carry extras and these do not start afresh.
    pub extra: Option<&'a Extra8>,
}

impl Queue {
    /// Creates an empty queue. `carries` says whether its rays carry extras.
    #[must_use]
    pub fn new(carries: bool) -> Self {
        Self { carries, ..Self::default() }
    }

    /// Returns the number of rays in the queue.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rays.len() * 8 - self.free
    }

    /// Returns true if the queue holds no packet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Appends the rays in `lanes`. Eight rays become a packet at once, even while another packet is being filled.
    /// Queues with extras keep the order instead, because extras are found by counting rays.
    #[inline]
    pub fn push8(&mut self, lanes: u8, new: &Spawn8) {
        if lanes != u8::MAX || self.carries {
            return self.push_in_order(lanes, new);
        }
        let &Spawn8 { origin, dir, t_max, admits, weight, lead, .. } = new;
        self.rays.push(Ray8 { origin, dir, t_max, active: lanes, admits, ..Ray8::default() });
        self.states.push(State8 { weight, pixel: *new.pixel, stack: *new.stack, lead, passes: *new.passes });
    }

    /// Appends the rays in `lanes`, lowest first, filling packets without gaps. If all rays are appended this way, they
    /// keep their order.
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

    /// Appends the extras of rays that are about to be pushed.
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

    /// Moves the last packets, at most `packets` of them, to the end of `chunk`.
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

/// Packets that are being traced and shaded.
#[derive(Debug, Default)]
pub struct Chunk {
    /// Rays.
    pub rays: Vec<Ray8>,
    /// States, one per packet.
    pub states: Vec<State8>,
    /// Extras, one per packet if rays carry extras; else empty.
    pub extras: Vec<Extra8>,
}

impl Chunk {
    /// Removes all packets and keeps the memory.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.states.clear();
        self.extras.clear();
    }

    /// Returns the number of active rays.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.rays.iter().map(|r| u64::from(r.active.count_ones())).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pushes rays whose coordinates encode their pixel's index, counted from `first`.
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

    /// Takes a queue's last packets, checks the states of their rays, and returns their pixels by packet.
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
        // The packet that was being filled has been taken.
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
