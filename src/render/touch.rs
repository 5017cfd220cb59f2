//! Touching surfaces in eight lanes. Hits at a contact are moved to the layer that counts, and rays between two layers
//! continue there without being traced.

use glam::DVec3;

use super::place::{ContactPoint, Layer, Through, governing};
use super::queue::Chunk;
use super::shading::Shading;
use super::surface::{HitRef, Surface8};
use crate::geometry::contact::{Contacts, Face};
use crate::geometry::{Hit, Hit8};
use crate::math::next_up;
use crate::simd::set_lanes;

/// Flag in a ray's count of passed surfaces; the other bits are then the index of a [`Waiting`].
const RESUMES: u32 = 1 << 31;

/// Ray between two layers of a contact.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    way: Through,
    /// Number of consecutive surfaces passed.
    passes: u32,
}

/// Touching surfaces of a render, and the rays between their layers.
#[derive(Debug)]
pub struct Touching<'a> {
    contacts: &'a Contacts,
    waiting: Vec<Waiting>,
}

/// Arrivals of a chunk's rays at contacts.
#[derive(Debug, Default)]
pub struct Arrivals {
    /// Lanes that are not traced, with the indices of their waiting rays.
    held: Vec<(HitRef, u32)>,
    /// Arrivals, by rising lanes of the chunk.
    met: Vec<(HitRef, Arrived)>,
    /// By surface packet of the current stream and lane: one more than an index into `met`; 0 elsewhere.
    lanes: Vec<[u32; 8]>,
}

/// Arrival of a ray at a layer.
#[derive(Clone, Debug)]
struct Arrived {
    /// Offset at which the next ray starts off all surfaces of the contact.
    reach: f32,
    onward: Option<Through>,
    returning: Option<Through>,
    /// Bodies whose boundaries are crossed together, each with true if it is entered; empty for a single surface.
    crossed: Vec<(u32, bool)>,
}

impl<'a> Touching<'a> {
    /// Creates the state without waiting rays.
    #[must_use]
    pub fn new(contacts: &'a Contacts) -> Self {
        Self { contacts, waiting: Vec::new() }
    }

    /// Removes all waiting rays, once none is queued.
    pub fn clear(&mut self) {
        self.waiting.clear();
    }

    /// Stores a waiting ray and returns its encoded count; 0 without one.
    fn wait(&mut self, way: Option<Through>) -> u32 {
        way.map_or(0, |way| {
            self.waiting.push(Waiting { way, passes: 0 });
            RESUMES | (self.waiting.len() as u32 - 1)
        })
    }

    /// Sets the number of consecutive surfaces passed in a ray's encoded count.
    pub fn count_passes(&mut self, onward: u32, passes: u32) -> u32 {
        if onward & RESUMES == 0 {
            return passes;
        }
        self.waiting[(onward & !RESUMES) as usize].passes = passes;
        onward
    }
}

impl Arrivals {
    /// Returns the surfaces that a lane of the current stream crosses together, or `None` for a single surface.
    #[must_use]
    pub fn crossed(&self, surface: &Surface8, lane: usize) -> Option<&[(u32, bool)]> {
        let number = self.lanes.get(surface.place as usize)?[lane];
        let arrived = &self.met.get((number as usize).checked_sub(1)?)?.1;
        (!arrived.crossed.is_empty()).then_some(&arrived.crossed)
    }

    /// Removes the rays that are between layers from a chunk, before it is traced.
    pub fn hold_back(&mut self, chunk: &mut Chunk) {
        self.held.clear();
        self.met.clear();
        for (packet, (ray, state)) in chunk.rays.iter_mut().zip(&mut chunk.states).enumerate() {
            for lane in set_lanes(ray.active) {
                if state.passes[lane] & RESUMES != 0 {
                    self.held.push(((packet * 8 + lane) as HitRef, state.passes[lane] & !RESUMES));
                    ray.active &= !(1 << lane);
                }
            }
        }
    }

    /// Restores the held rays, and moves every hit at a contact to the layer that counts.
    pub fn arrive(&mut self, shading: &mut Shading, chunk: &mut Chunk, hits: &mut [Hit8]) {
        let contacts = shading.touching.contacts;
        for (packet, hit8) in hits.iter_mut().enumerate() {
            let traced = set_lanes(chunk.rays[packet].active);
            for lane in traced {
                let object = hit8.geometry[lane];
                if contacts.touches(object, hit8.primitive[lane]) {
                    self.arrive_at(shading, chunk, hit8, packet, lane);
                }
            }
        }
        let traced = self.met.len();
        for i in 0..self.held.len() {
            let (at, number) = self.held[i];
            let (packet, lane) = (at as usize / 8, at as usize % 8);
            self.resume(shading, chunk, &mut hits[packet], at, number);
            chunk.rays[packet].active |= 1 << lane;
        }
        if self.met.len() != traced {
            self.met.sort_by_key(|&(at, _)| at);
        }
    }

    fn arrive_at(&mut self, shading: &mut Shading, chunk: &Chunk, hits: &mut Hit8, packet: usize, lane: usize) {
        let ray = chunk.rays[packet].lane(lane);
        let hit = hits.lane(lane);
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let face = Face::of(&shading.scene.geometry, hit.geometry, hit.primitive);
        let near = origin + dir * f64::from(hit.t);
        let point = near - face.outward(near) * face.height(near);
        let id = (hit.geometry, hit.primitive);
        let Some(place) = ContactPoint::met(shading.scene, shading.touching.contacts, id, [origin, dir], point) else {
            return;
        };
        let new = self.take(shading, chunk, &place, (packet * 8 + lane) as HitRef, dir, hit.t);
        hits.set_lane(lane, &new);
    }

    fn resume(&mut self, shading: &mut Shading, chunk: &mut Chunk, hits: &mut Hit8, at: HitRef, number: u32) {
        let (packet, lane) = (at as usize / 8, at as usize % 8);
        let Waiting { way, passes } = shading.touching.waiting[number as usize];
        chunk.states[packet].passes[lane] = passes;
        // The ray is still at the last layer it left, from which absorption counts.
        let t = -chunk.states[packet].lead.lane(lane);
        let dir = chunk.rays[packet].dir.lane(lane).as_dvec3();
        let place = ContactPoint::resumed(shading.scene, shading.touching.contacts, way);
        debug_assert!(place.is_some(), "a ray goes on through layers that are there");
        let hit = place.map_or(Hit::MISS, |place| self.take(shading, chunk, &place, at, dir, t));
        hits.set_lane(lane, &hit);
    }

    /// Records the arrival at the current layer of a contact, and returns the hit that represents it.
    fn take(
        &mut self,
        shading: &mut Shading,
        chunk: &Chunk,
        place: &ContactPoint,
        at: HitRef,
        dir: DVec3,
        t: f32,
    ) -> Hit {
        let point = place.point();
        let outside = |face: &Face| place.is_outside(face, dir);
        let (face, crossed) = match place.layer() {
            Layer::Alone(face) => (*face, Vec::new()),
            Layer::Media(faces) if faces.len() == 1 => (faces[0], Vec::new()),
            Layer::Media(faces) => {
                let crossed = place.crossed(faces, dir, |object| shading.media.body_of(object));
                let stack = chunk.states[at as usize / 8].stack[at as usize % 8];
                let sides = shading.media.cross_all(stack, &crossed).media;
                (*governing(shading.scene, faces, sides, outside), crossed)
            }
        };
        let (apart, reach) = place.spread(&face);
        let reach = next_up((face.reach(point) + reach + apart) as f32);
        self.met.push((at, Arrived { reach, onward: place.onward(), returning: place.returning(), crossed }));
        let (u, v) = face.barycentrics(point);
        Hit { t, u: u as f32, v: v as f32, instance: 0, geometry: face.object, primitive: face.primitive }
    }

    /// Numbers the surface packets of a stream, and sets the data of surfaces at contacts.
    pub fn mark(&mut self, touching: &mut Touching, refs: &[HitRef], surfaces: &mut [Surface8]) {
        self.lanes.clear();
        for (number, (surface, refs)) in surfaces.iter_mut().zip(refs.chunks(8)).enumerate() {
            surface.place = number as u32;
            let mut lanes = [0; 8];
            for (k, r) in refs.iter().enumerate() {
                let Ok(place) = self.met.binary_search_by_key(r, |&(at, _)| at) else { continue };
                let arrived = &self.met[place].1;
                lanes[k] = place as u32 + 1;
                surface.reach.set_lane(k, arrived.reach);
                surface.onward[k] = touching.wait(arrived.onward);
                surface.returning[k] = touching.wait(arrived.returning);
            }
            self.lanes.push(lanes);
        }
    }
}
