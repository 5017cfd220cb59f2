//! Maps of the surroundings of bodies that bend light, and their back sides, in `f64`.

use glam::{DVec2, DVec3};

use super::split::Lobe;
use super::trace::{Arrival, Tracer};
use crate::accel::reference::{Ray64, Reference};
use crate::geometry::Shape;
use crate::optics::{Boundary, RefractionModel, transmittance};
use crate::render::maps::Taken;
use crate::render::record::{Recorder, Source};
use crate::render::{Limit, MapsReport};
use crate::scene::Scene;
use crate::systems::bent::{Back, Entry, outward};

/// Maps of bodies and, for a second interface, a hierarchy of each body's own.
#[derive(Debug)]
pub(super) struct Bodies64 {
    taken: Taken,
    backs: Vec<Option<Body>>,
}

/// Hierarchy of a body's own.
#[derive(Debug)]
struct Body {
    accel: Reference,
    /// Distance from each place on the body beyond which none of it lies.
    far: f64,
}

impl Bodies64 {
    /// Makes the hierarchies that `refraction` needs for bodies with a map.
    pub fn new(scene: &Scene, refraction: RefractionModel, taken: Taken) -> Self {
        let back = |object: usize| {
            let needed = refraction == RefractionModel::MapTwo && taken.maps.of(object as u32).is_some();
            let own = &scene.geometry[object];
            let accel = || Reference::build(std::slice::from_ref(own));
            needed.then(|| Body { accel: accel(), far: 2.0 * f64::from(own.shape.bounds().diagonal()) })
        };
        let backs = (0..scene.objects.len()).map(back).collect();
        Self { taken, backs }
    }

    /// Returns the report on the maps. `traced` is the number of rays that entered a body without a map.
    pub fn report(&self, traced: u64) -> MapsReport {
        self.taken.report(traced)
    }
}

impl<L: Recorder> Tracer<'_, '_, L> {
    /// Looks up what light sees that enters a body from outside. Returns false if it is to be traced.
    pub(super) fn looked_up(&mut self, at: &Arrival, boundary: &Boundary<f64>, inside: DVec3, lobe: &Lobe) -> bool {
        let prepared = self.prepared;
        let Some(bodies) = &prepared.refracting else { return false };
        let front = at.geometric.dot(at.surface.outward) > 0.0;
        let Some(map) = bodies.taken.maps.of(at.id.0).filter(|_| front) else {
            self.tally.without_body_map += 1;
            return false;
        };
        let (maps, object) = (&bodies.taken.maps, at.id.0 as usize);
        let weight = at.ray.weight * lobe.share;
        let Some(body) = &bodies.backs[object] else {
            let seen = maps.look_up(map, prepared.proxy, at.surface.point.as_vec3(), inside.normalize().as_vec3());
            self.add(at.ray.node, Source::Environment, weight * seen.as_dvec3());
            return true;
        };
        let entry = Entry {
            point: at.surface.point,
            normal: at.shading,
            incident: at.ray.dir,
            inside: inside.normalize(),
            eta: boundary.eta,
        };
        let shape = &prepared.scene.geometry[object].shape;
        let behind = |place: DVec3, dir: DVec3| back_side(body, shape, place, dir);
        let along = behind(entry.point, entry.incident);
        let end = entry.end(along, behind(entry.point, -entry.normal));
        let back = behind(end, entry.incident).or(along);
        let left = entry.leave(end, back.unwrap_or(Back { point: entry.point, normal: -entry.normal }));
        let medium = prepared.scene.medium_of(object);
        let absorption = medium.map_or(DVec3::ZERO, |m| prepared.scene.media[m as usize].absorption.as_dvec3());
        let arriving = weight * DVec3::from(transmittance(absorption.into(), left.thickness));
        let seen = maps.look_up(map, prepared.proxy, left.point.as_vec3(), left.dir.as_vec3());
        self.add(at.ray.node, Source::Environment, arriving * left.share * seen.as_dvec3());
        self.tally.end(Limit::Asked, arriving * (1.0 - left.share));
        true
    }
}

/// Returns the last surface of a body on a line.
fn back_side(body: &Body, shape: &Shape, place: DVec3, dir: DVec3) -> Option<Back> {
    let hit = body.accel.closest(&Ray64::new(place + dir * body.far, -dir));
    hit.is_hit().then(|| {
        let point = place + dir * (body.far - hit.t);
        Back { point, normal: outward(shape, hit.primitive, DVec2::new(hit.u, hit.v), point) }
    })
}
