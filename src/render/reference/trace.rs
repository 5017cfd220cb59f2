//! Tracing of a camera ray and all its secondary rays.

use glam::DVec3;

use super::media::{Filled, MediumStack, Transition};
use super::mirrored::{Image, Start};
use super::polarisation::Polarisation;
use super::surface::Surface;
use super::{Prepared, Tally, colour};
use crate::accel::reference::{Hit64, Ray64};
use crate::geometry::contact::Face;
use crate::math::Vector3;
use crate::optics::{Bands, FresnelModel, consistent_normal, reflect, transmittance};
use crate::render::budget;
use crate::render::place::{ContactPoint, Layer, Through, governing};
use crate::render::record::{Cut, Event, Met, Node, Recorder, Share, Source};
use crate::render::{FilmRay, Limit, RayKind};
use crate::scene::{MOST_PASSES, Material};

/// Ray that waits to be traced.
#[derive(Clone, Debug)]
pub(super) struct Pending {
    pub origin: DVec3,
    /// Unit length.
    pub dir: DVec3,
    pub weight: DVec3,
    pub depth: u32,
    pub kind: RayKind,
    /// Wavelength in nanometres; `None` for white.
    pub nm: Option<f64>,
    pub stack: MediumStack,
    /// Number of consecutive surfaces passed.
    pub passed: u32,
    /// Position between touching surfaces, if the ray is between two of them.
    pub through: Option<Through>,
    /// Polarisation of its path, if polarisation is computed.
    pub polarisation: Option<Polarisation>,
    /// Budget for cutting it and its descendants; see [`budget`].
    pub budget: DVec3,
    /// Mirror image of the camera that sent the ray, if cameras are mirrored and it is a camera ray.
    pub image: Option<Image>,
    /// Hit that the ray ends at, if it is not to be looked for.
    pub shown: Option<Hit64>,
    /// Index in the record, if one is kept.
    pub node: Node,
}

/// Hit of a ray on a surface.
pub(super) struct Arrival<'a> {
    pub ray: &'a Pending,
    /// Object and primitive.
    pub id: (u32, u32),
    pub surface: Surface,
    pub material: &'a Material,
    /// Unit normals on the side of arrival.
    pub geometric: DVec3,
    pub shading: DVec3,
    pub cos_i: f64,
    /// Positions between touching surfaces for rays that continue behind the surface, and for rays that leave on the
    /// side of arrival.
    pub onward: Option<Through>,
    pub returning: Option<Through>,
    /// Polarisation of the ray in the frame of the plane of incidence.
    pub before: Option<Polarisation>,
}

/// Other layers where surfaces touch, beside the surface that is shaded.
#[derive(Default)]
struct Reached {
    /// Combined effect of all coinciding boundaries.
    transition: Option<Transition>,
    onward: Option<Through>,
    returning: Option<Through>,
}
/// Secondary ray that a surface would send.
pub(super) struct Branch {
    pub kind: RayKind,
    pub dir: DVec3,
    pub weight: DVec3,
    pub nm: Option<f64>,
    pub stack: MediumStack,
    pub polarisation: Option<Polarisation>,
    /// Start of the ray, if it is not on the surface.
    pub start: Option<Start>,
    /// Hit that it ends at, if it is not to be looked for.
    pub shown: Option<Hit64>,
}

/// Depth-first tracer of one camera ray. Secondary rays wait on a list rather than on the call stack, which deep scenes
/// could exhaust.
pub(super) struct Tracer<'a, 'r, L: Recorder> {
    pub prepared: &'a Prepared<'a>,
    /// Camera ray that is traced.
    pub film: FilmRay,
    /// Vector added to the unit direction of every shadow ray; zero except in tests of a pixel's condition.
    pub shadows_turned: DVec3,
    /// Wavelengths that white light divides into.
    pub bands: &'a Bands,
    pub tally: Tally,
    pending: Vec<Pending>,
    /// Secondary rays of the current surface.
    pub branches: Vec<Branch>,
    record: &'r mut L,
}

impl<'a, 'r, L: Recorder> Tracer<'a, 'r, L> {
    /// Traces a camera ray and all its secondary rays, sampled as the film's ray `film`. `shadows_turned` is added to
    /// the unit direction of every shadow ray.
    pub fn trace(
        prepared: &'a Prepared<'a>,
        film: FilmRay,
        (origin, dir): (DVec3, DVec3),
        shadows_turned: DVec3,
        record: &'r mut L,
    ) -> Tally {
        let mut camera_ray = Pending {
            origin,
            dir,
            weight: DVec3::ONE,
            depth: 0,
            kind: RayKind::Camera,
            nm: None,
            stack: prepared.stack.clone(),
            passed: 0,
            through: None,
            polarisation: (prepared.fresnel == FresnelModel::Polarised).then(|| Polarisation::none(dir)),
            budget: DVec3::splat(budget::WHOLE),
            image: prepared.mirrors.is_some().then(Image::default),
            shown: None,
            node: 0,
        };
        camera_ray.node = record.note(|tree| tree.sent(camera_ray.event(prepared.filled(), None)));
        let bands = &prepared.spectrum.sets()[prepared.spectrum.set_of(film.sample)];
        let (tally, pending) = (Tally::default(), vec![camera_ray]);
        let branches = Vec::new();
        let mut tracer = Self { prepared, film, shadows_turned, bands, tally, pending, branches, record };
        while let Some(ray) = tracer.pending.pop() {
            tracer.follow(ray);
        }
        tracer.tally
    }

    fn follow(&mut self, mut ray: Pending) {
        let scene = self.prepared.scene;
        self.tally.rays.add(ray.kind, ray.depth as usize, 1);
        let filled = self.prepared.filled();
        let Image { clip, t_min, .. } = ray.image.unwrap_or_default();
        let line = Ray64 { t_min, ..Ray64::new(ray.origin, ray.dir) };
        let hit = match ray.through {
            // The ray is still at the last layer it left.
            Some(_) => Hit64 { t: 0.0, ..Hit64::MISS },
            None => ray.shown.unwrap_or_else(|| self.prepared.nearest(&line, ray.kind)),
        };
        let absorption = scene.media[ray.stack.top(filled) as usize].absorption.as_dvec3();
        ray.weight *= DVec3::from(transmittance(absorption.into(), hit.t - clip));
        self.note(ray.node, |event| {
            (event.t, event.arrived) = (hit.t - clip, ray.weight);
            if ray.weight == DVec3::ZERO {
                event.met = Met::Spent;
            }
        });
        if ray.weight == DVec3::ZERO {
            return;
        }
        if !hit.is_hit() && ray.through.is_none() {
            self.tally.missed += u64::from(ray.kind == RayKind::Camera);
            self.add(ray.node, Source::Environment, ray.weight * colour::of_environment(scene, ray.dir));
            return;
        }
        let (object, primitive, surface, reached) = self.reached(&ray, &line, &hit);
        self.tally.met.insert(object);
        let front = ray.dir.dot(surface.outward) < 0.0;
        let material = self.prepared.material(object);
        let Reached { transition, onward, returning } = reached;
        let transition = transition.or_else(|| {
            let body = self.prepared.bodies.of_object(object)?;
            Some(ray.stack.cross(filled, body, front))
        });
        let point = surface.point;
        if let Some(Transition::Passed(beyond)) = transition {
            self.note(ray.node, |event| event.met = Met::Absent { object, primitive, point });
            self.pass(&ray, &surface, beyond, onward);
            return;
        }
        if let Some(Transition::Boundary { unmatched: true, .. }) = transition {
            self.tally.unmatched_exits.add(object);
        }
        let geometric = if front { surface.outward } else { -surface.outward };
        let shading = shading_normal(ray.dir, geometric, &surface);
        let cos_i = -ray.dir.dot(shading);
        self.note(ray.node, |event| event.met = Met::Surface { object, primitive, point, front, cos_i });
        let before = ray.polarisation.map(|carried| carried.facing(ray.dir, shading));
        let id = (object, primitive);
        let arrival =
            Arrival { ray: &ray, id, surface, material, geometric, shading, cos_i, onward, returning, before };
        self.shade(&arrival, transition);
        self.send_branches(&arrival);
    }

    /// Returns the surface to shade where a ray arrives: the one it hit, unless surfaces touch there.
    fn reached(&self, ray: &Pending, line: &Ray64, hit: &Hit64) -> (u32, u32, Surface, Reached) {
        let prepared = self.prepared;
        let (scene, contacts, filled) = (prepared.scene, &prepared.contacts, prepared.filled());
        let (place, surface) = match ray.through {
            Some(way) => (ContactPoint::resumed(scene, contacts, way), None),
            None => {
                let surface = Surface::at(scene, line, hit);
                let id = (hit.geometry, hit.primitive);
                (ContactPoint::met(scene, contacts, id, [line.origin, line.dir], surface.point), Some(surface))
            }
        };
        let Some(place) = place else {
            let surface = surface.expect("layers of a place are there as long as a ray is between them");
            return (hit.geometry, hit.primitive, surface, Reached::default());
        };
        let outside = |face: &Face| place.is_outside(face, ray.dir);
        let (face, transition) = match place.layer() {
            Layer::Alone(face) => (face, None),
            Layer::Media(faces) => {
                let crossed = place.crossed(faces, ray.dir, |object| prepared.bodies.of_object(object));
                let transition = ray.stack.cross_all(filled, &crossed);
                let sides = match &transition {
                    Transition::Boundary { from, to, .. } => [*from, *to],
                    Transition::Passed(beyond) => [ray.stack.top(filled), beyond.top(filled)],
                };
                (governing(scene, faces, sides, outside), Some(transition))
            }
        };
        let surface = Surface::on_face(scene, line, face, place.point(), place.spread(face).0);
        let reached = Reached { transition, onward: place.onward(), returning: place.returning() };
        (face.object, face.primitive, surface, reached)
    }

    /// Passes straight through a surface that is no boundary.
    fn pass(&mut self, ray: &Pending, surface: &Surface, stack: MediumStack, through: Option<Through>) {
        let kind = RayKind::Transmitted;
        if ray.passed >= MOST_PASSES {
            self.tally.end(Limit::Passes, ray.weight);
            let cut = Cut { kind, weight: ray.weight, too_deep: false, too_light: false };
            self.note(ray.node, |event| event.cut.push(cut));
            return;
        }
        let origin = surface.start(ray.dir);
        let passed = ray.passed + 1;
        self.queue(ray.node, Pending { origin, stack, kind, passed, through, image: None, shown: None, ..ray.clone() });
    }

    /// Queues a ray that the ray `parent` sent.
    pub fn queue(&mut self, parent: Node, mut ray: Pending) {
        let filled = self.prepared.filled();
        ray.node = self.record.note(|tree| tree.sent(ray.event(filled, Some(parent))));
        self.pending.push(ray);
    }

    /// Changes the record of a ray.
    pub fn note(&mut self, node: Node, what: impl FnOnce(&mut Event)) {
        self.record.note(|tree| tree.at(node, what));
    }

    /// Adds a contribution to the pixel and records it.
    pub fn add(&mut self, node: Node, source: Source, radiance: DVec3) {
        self.tally.add(radiance);
        self.note(node, |event| event.shares.push(Share::free(source, radiance)));
    }
}

impl Pending {
    /// Creates the record of the ray.
    fn event(&self, filled: Filled, parent: Option<Node>) -> Event {
        let line = (self.origin, self.dir);
        Event { media: self.stack.media(filled), ..Event::sent(parent, self.kind, self.depth, line, self.weight) }
    }
}

impl Arrival<'_> {
    /// Returns the unit mirror direction of the ray.
    pub fn mirrored(&self) -> DVec3 {
        DVec3::from(reflect(self.ray.dir.into(), Vector3::from(self.shading))).normalize()
    }
}

/// Returns the shading normal, on the side of the geometric one that faces the ray.
fn shading_normal(incident: DVec3, geometric: DVec3, surface: &Surface) -> DVec3 {
    let Some(interpolated) = surface.interpolated else { return geometric };
    let turned = if interpolated.dot(geometric) < 0.0 { -interpolated } else { interpolated };
    consistent_normal(incident.into(), geometric.into(), turned.into()).into()
}
