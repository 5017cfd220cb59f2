//! Touching surfaces in eight lanes: hits at a place where surfaces touch are taken to the layer that counts, and rays
//! that are on their way through such a place go on there without being traced.

use glam::DVec3;

use super::place::{Layer, Place, Through, governing};
use super::queue::Chunk;
use super::shading::Shading;
use super::surface::{HitRef, Surface8};
use crate::geometry::contact::{Contacts, Face};
use crate::geometry::{Hit, Hit8};
use crate::math::next_up;
use crate::simd::set_lanes;

/// Set in a ray's count of surfaces passed where the rest is the number of a [`Waiting`].
const RESUMES: u32 = 1 << 31;

/// A ray between two layers of a place.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    way: Through,
    /// Surfaces in a row that were not there.
    passes: u32,
}

/// The touching surfaces of a render, and the rays that are on their way through them.
#[derive(Debug)]
pub struct Touching<'a> {
    contacts: &'a Contacts,
    waiting: Vec<Waiting>,
}

/// Arrivals of the rays of a chunk at places where surfaces touch.
#[derive(Debug, Default)]
pub struct Arrivals {
    /// Lanes that are not traced, with the numbers of their waiting rays.
    held: Vec<(HitRef, u32)>,
    /// By rising lanes of the chunk.
    met: Vec<(HitRef, Arrived)>,
    /// By place of a surface in the stream at hand and lane: one more than a place in `met`; 0 elsewhere.
    lanes: Vec<[u32; 8]>,
}

/// A ray's arrival at a layer.
#[derive(Clone, Debug)]
struct Arrived {
    /// Distance beyond which the next ray starts off everything that lies there.
    reach: f32,
    onward: Option<Through>,
    returning: Option<Through>,
    /// Bodies whose boundaries are crossed at once and whether they are entered; empty where one surface counts.
    crossed: Vec<(u32, bool)>,
}

impl<'a> Touching<'a> {
    /// No ray is on its way.
    #[must_use]
    pub fn new(contacts: &'a Contacts) -> Self {
        Self { contacts, waiting: Vec::new() }
    }

    /// Forgets all rays, once none is queued.
    pub fn clear(&mut self) {
        self.waiting.clear();
    }

    /// The count that stands for a ray on its way.
    fn wait(&mut self, way: Option<Through>) -> u32 {
        way.map_or(0, |way| {
            self.waiting.push(Waiting { way, passes: 0 });
            RESUMES | (self.waiting.len() as u32 - 1)
        })
    }

    /// Adds surfaces passed in a row to what a lane's ray goes on with.
    pub fn count_passes(&mut self, onward: u32, passes: u32) -> u32 {
        if onward & RESUMES == 0 {
            return passes;
        }
        self.waiting[(onward & !RESUMES) as usize].passes = passes;
        onward
    }
}

impl Arrivals {
    /// The surfaces that a lane of the stream at hand crosses at once; none where one surface counts.
    #[must_use]
    pub fn crossed(&self, surface: &Surface8, lane: usize) -> Option<&[(u32, bool)]> {
        let number = self.lanes.get(surface.place as usize)?[lane];
        let arrived = &self.met.get((number as usize).checked_sub(1)?)?.1;
        (!arrived.crossed.is_empty()).then_some(&arrived.crossed)
    }

    /// Takes the rays that are on their way through a place out of a chunk, before it is traced.
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

    /// Puts back what was held, and takes every hit at a place where surfaces touch to the layer that counts.
    pub fn arrive(&mut self, shading: &mut Shading, chunk: &mut Chunk, hits: &mut [Hit8]) {
        let contacts = shading.touching.contacts;
        for (packet, hit8) in hits.iter_mut().enumerate() {
            let traced = set_lanes(chunk.rays[packet].active);
            for lane in traced {
                let object = hit8.geometry[lane];
                if contacts.touches(object, hit8.primitive[lane]) {
                    self.meet(shading, chunk, hit8, packet, lane);
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

    fn meet(&mut self, shading: &mut Shading, chunk: &Chunk, hits: &mut Hit8, packet: usize, lane: usize) {
        let ray = chunk.rays[packet].lane(lane);
        let hit = hits.lane(lane);
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let face = Face::of(&shading.scene.geometry, hit.geometry, hit.primitive);
        let near = origin + dir * f64::from(hit.t);
        let point = near - face.outward(near) * face.height(near);
        let id = (hit.geometry, hit.primitive);
        let Some(place) = Place::met(shading.scene, shading.touching.contacts, id, [origin, dir], point) else {
            return;
        };
        let new = self.take(shading, chunk, &place, (packet * 8 + lane) as HitRef, dir, hit.t);
        hits.set_lane(lane, &new);
    }

    fn resume(&mut self, shading: &mut Shading, chunk: &mut Chunk, hits: &mut Hit8, at: HitRef, number: u32) {
        let (packet, lane) = (at as usize / 8, at as usize % 8);
        let Waiting { way, passes } = shading.touching.waiting[number as usize];
        chunk.states[packet].passes[lane] = passes;
        // The ray is still where it left the last layer: absorption counts from there.
        let t = -chunk.states[packet].lead.lane(lane);
        let dir = chunk.rays[packet].dir.lane(lane).as_dvec3();
        let place = Place::resumed(shading.scene, shading.touching.contacts, way);
        debug_assert!(place.is_some(), "a ray goes on through layers that are there");
        let hit = place.map_or(Hit::MISS, |place| self.take(shading, chunk, &place, at, dir, t));
        hits.set_lane(lane, &hit);
    }

    /// Writes down the arrival at the present layer of a place, and gives the hit that stands for it.
    fn take(&mut self, shading: &mut Shading, chunk: &Chunk, place: &Place, at: HitRef, dir: DVec3, t: f32) -> Hit {
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

    /// Numbers the surfaces of a stream and gives those at touching places what they need.
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
