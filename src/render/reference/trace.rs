//! Tracing of a camera ray and all its secondary rays.

use glam::DVec3;

use super::disperse::Dispersing;
use super::light::{Arriving, blocker, let_through};
use super::media::{Filled, MediumStack, Meeting};
use super::polarisation::Polarisation;
use super::split::{Way, Ways, at_boundary, at_metal, at_mirror, at_pane};
use super::surface::Surface;
use super::{Prepared, Tally, colour};
use crate::accel::reference::{Hit64, Ray64};
use crate::geometry::contact::Face;
use crate::math::Vector3;
use crate::optics::{
    Bands, Boundary, Crossing, FresnelModel, Refracted, RefractionFormula, RefractionModel, RefractionVisitor,
    below_surface, consistent_normal, reflect, transmittance,
};
use crate::render::budget::{self, Division, divide};
use crate::render::place::{Layer, Place, Through, governing};
use crate::render::record::{Cut, Event, Met, Node, Recorder, Share, Source, Split};
use crate::render::{FilmRay, Limit, RayKind, Reflection};
use crate::scene::{FresnelRule, Highlight, HighlightModel, Interface, Light, Material, MirrorSource};

/// Largest number of consecutive surfaces that a ray may pass.
const PASSED_AT_MOST: u32 = 256;

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
    /// Index in the record, if one is kept.
    pub node: Node,
}

/// Hit of a ray on a surface.
pub(super) struct Arrival<'a> {
    pub ray: &'a Pending,
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
    meeting: Option<Meeting>,
    onward: Option<Through>,
    returning: Option<Through>,
}

/// Secondary ray that a surface would send.
struct Branch {
    kind: RayKind,
    dir: DVec3,
    weight: DVec3,
    nm: Option<f64>,
    stack: MediumStack,
    polarisation: Option<Polarisation>,
}

/// Contribution of a light, or of some sample points of it.
#[derive(Clone, Copy)]
struct Lit {
    /// Light from the first of the sample points.
    arriving: Arriving,
    unshadowed: DVec3,
    radiance: DVec3,
}

impl Lit {
    fn and(self, o: Self) -> Self {
        Self { unshadowed: self.unshadowed + o.unshadowed, radiance: self.radiance + o.radiance, ..self }
    }
}

/// Depth-first tracer of one camera ray. Secondary rays wait on a list rather than on the call stack, which deep scenes
/// could exhaust.
pub(super) struct Tracer<'a, 'r, L: Recorder> {
    pub prepared: &'a Prepared<'a>,
    /// Camera ray that is traced.
    film: FilmRay,
    /// Vector added to the unit direction of every shadow ray; zero except in tests of a pixel's condition.
    shadows_turned: DVec3,
    /// Wavelengths that white light divides into.
    pub bands: &'a Bands,
    tally: Tally,
    pending: Vec<Pending>,
    /// Secondary rays of the current surface.
    branches: Vec<Branch>,
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
        let line = Ray64::new(ray.origin, ray.dir);
        let hit = match ray.through {
            // The ray is still at the last layer it left.
            Some(_) => Hit64 { t: 0.0, ..Hit64::MISS },
            None => self.prepared.accel.closest(&line),
        };
        let absorption = scene.media[ray.stack.top(filled) as usize].absorption.as_dvec3();
        ray.weight *= DVec3::from(transmittance(absorption.into(), hit.t));
        self.note(ray.node, |event| {
            (event.t, event.arrived) = (hit.t, ray.weight);
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
        let Reached { meeting, onward, returning } = reached;
        let meeting = meeting.or_else(|| {
            let body = self.prepared.bodies.of_object(object)?;
            Some(ray.stack.meet(filled, body, front))
        });
        let point = surface.point;
        if let Some(Meeting::NotThere(beyond)) = meeting {
            self.note(ray.node, |event| event.met = Met::Absent { object, primitive, point });
            self.pass(&ray, &surface, beyond, onward);
            return;
        }
        if let Some(Meeting::Boundary { unmatched: true, .. }) = meeting {
            self.tally.unmatched_exits.add(object);
        }
        let geometric = if front { surface.outward } else { -surface.outward };
        let shading = shading_normal(ray.dir, geometric, &surface);
        let cos_i = -ray.dir.dot(shading);
        self.note(ray.node, |event| event.met = Met::Surface { object, primitive, point, front, cos_i });
        let before = ray.polarisation.map(|carried| carried.facing(ray.dir, shading));
        let arrival = Arrival { ray: &ray, surface, material, geometric, shading, cos_i, onward, returning, before };
        self.meet(&arrival, meeting);
        self.send_branches(&arrival);
    }

    /// Returns the surface to shade where a ray arrives: the one it hit, unless surfaces touch there.
    fn reached(&self, ray: &Pending, line: &Ray64, hit: &Hit64) -> (u32, u32, Surface, Reached) {
        let prepared = self.prepared;
        let (scene, contacts, filled) = (prepared.scene, &prepared.contacts, prepared.filled());
        let (place, surface) = match ray.through {
            Some(way) => (Place::resumed(scene, contacts, way), None),
            None => {
                let surface = Surface::at(scene, line, hit);
                let id = (hit.geometry, hit.primitive);
                (Place::met(scene, contacts, id, [line.origin, line.dir], surface.point), Some(surface))
            }
        };
        let Some(place) = place else {
            let surface = surface.expect("layers of a place are there as long as a ray is between them");
            return (hit.geometry, hit.primitive, surface, Reached::default());
        };
        let outside = |face: &Face| place.is_outside(face, ray.dir);
        let (face, meeting) = match place.layer() {
            Layer::Alone(face) => (face, None),
            Layer::Media(faces) => {
                let crossed = place.crossed(faces, ray.dir, |object| prepared.bodies.of_object(object));
                let meeting = ray.stack.meet_all(filled, &crossed);
                let sides = match &meeting {
                    Meeting::Boundary { from, to, .. } => [*from, *to],
                    Meeting::NotThere(beyond) => [ray.stack.top(filled), beyond.top(filled)],
                };
                (governing(scene, faces, sides, outside), Some(meeting))
            }
        };
        let surface = Surface::on_face(scene, line, face, place.point(), place.spread(face).0);
        let reached = Reached { meeting, onward: place.onward(), returning: place.returning() };
        (face.object, face.primitive, surface, reached)
    }

    /// Passes straight through a surface that is no boundary.
    fn pass(&mut self, ray: &Pending, surface: &Surface, stack: MediumStack, through: Option<Through>) {
        let kind = RayKind::Transmitted;
        if ray.passed >= PASSED_AT_MOST {
            self.tally.end(Limit::Passes, ray.weight);
            let cut = Cut { kind, weight: ray.weight, too_deep: false, too_light: false };
            self.note(ray.node, |event| event.cut.push(cut));
            return;
        }
        let origin = surface.start(ray.dir);
        self.queue(ray.node, Pending { origin, stack, kind, passed: ray.passed + 1, through, ..ray.clone() });
    }

    /// Queues a ray that the ray `parent` sent.
    fn queue(&mut self, parent: Node, mut ray: Pending) {
        let filled = self.prepared.filled();
        ray.node = self.record.note(|tree| tree.sent(ray.event(filled, Some(parent))));
        self.pending.push(ray);
    }

    /// Changes the record of a ray.
    fn note(&mut self, node: Node, what: impl FnOnce(&mut Event)) {
        self.record.note(|tree| tree.at(node, what));
    }

    /// Adds a contribution to the pixel and records it.
    fn add(&mut self, node: Node, source: Source, radiance: DVec3) {
        self.tally.add(radiance);
        self.note(node, |event| event.shares.push(Share::free(source, radiance)));
    }

    /// Records the division of light at a surface.
    pub fn split(&mut self, at: &Arrival, split: Split) {
        self.note(at.ray.node, |event| event.split = Some(split));
    }

    /// Shades the surface: contributions and secondary rays, by the table of shares in `scene/material.rs`.
    fn meet(&mut self, at: &Arrival, meeting: Option<Meeting>) {
        let prepared = self.prepared;
        let one = DVec3::ONE;
        let nm = at.ray.nm;
        let here = || prepared.ior(at.ray.stack.top(prepared.filled()), nm);
        match at.material.interface {
            Interface::Opaque => {
                self.split(at, Split::OPAQUE);
                self.base(at, one);
            }
            Interface::Mirror { reflectance, source } => {
                let reflected = reflectance.as_dvec3();
                self.split(at, Split { reflected, absorbed: one - reflected, ..Split::OPAQUE });
                self.base(at, one);
                match source {
                    MirrorSource::Traced => self.reflected(at, at_mirror(reflected, at.before)),
                    MirrorSource::Environment => self.mirror_environment(at, reflected),
                }
            }
            Interface::Conductor { eta, k } => {
                self.base(at, one);
                // A metal's index is relative to the medium in front of it.
                let (eta, k) = (eta.as_dvec3() / here(), k.as_dvec3() / here());
                let way = at_metal(prepared.fresnel, at.cos_i, eta, k, at.before);
                self.split(at, Split { reflected: way.share, absorbed: one - way.share, ..Split::OPAQUE });
                self.reflected(at, way);
            }
            Interface::Dielectric { rule, tint, .. } => {
                self.base(at, one);
                let Some(Meeting::Boundary { from, to, beyond, .. }) = meeting else { return };
                let tint = tint.as_dvec3();
                if self.disperse(at, &Dispersing { from, to, beyond: beyond.clone(), rule, tint }) {
                    return;
                }
                let boundary = Boundary::new(prepared.ior(from, nm), prepared.ior(to, nm));
                let crossing = boundary.cross(at.cos_i);
                if crossing.total && prepared.total_is_lost {
                    self.tally.end(Limit::Asked, at.ray.weight);
                    return;
                }
                let Ways { back, on } = at_boundary(prepared.fresnel, rule, &boundary, &crossing, at.before);
                let through = if crossing.total { DVec3::ZERO } else { on.share };
                let transmitted = through * tint;
                let Refracted { direction, total } = prepared.refract(&boundary, at, &crossing);
                let bent = (!crossing.total && !total).then(|| match prepared.refraction {
                    RefractionModel::Stable => crossing.cos_t,
                    _ => -DVec3::from(direction).normalize().dot(at.shading),
                });
                self.split(
                    at,
                    Split {
                        indices: Some((prepared.ior(from, nm), prepared.ior(to, nm))),
                        cos_t: bent,
                        total: crossing.total,
                        reflected: back.share,
                        transmitted,
                        absorbed: through * (one - tint),
                    },
                );
                self.reflected(at, back);
                if !crossing.total {
                    let way = Way { share: transmitted, ..on };
                    self.refracted(at, &boundary, &crossing, way, beyond, nm);
                }
            }
            Interface::ThinDielectric { ior, rule, tint } => {
                self.base(at, one);
                let boundary = Boundary::new(here(), f64::from(ior));
                let crossing = boundary.cross(at.cos_i);
                let Ways { back, on } = at_pane(prepared.fresnel, rule, &boundary, &crossing, at.before);
                let tint = tint.as_dvec3();
                self.split(
                    at,
                    Split {
                        indices: Some((here(), f64::from(ior))),
                        total: crossing.total,
                        reflected: back.share,
                        transmitted: on.share * tint,
                        absorbed: on.share * (one - tint),
                        ..Split::OPAQUE
                    },
                );
                self.reflected(at, back);
                self.straight(at, Way { share: on.share * tint, ..on });
            }
            Interface::Coated { ior } => {
                let boundary = Boundary::new(here(), f64::from(ior));
                let crossing = boundary.cross(at.cos_i);
                let Ways { back, on } =
                    at_boundary(prepared.fresnel, FresnelRule::Fresnel, &boundary, &crossing, at.before);
                self.split(
                    at,
                    Split {
                        indices: Some((here(), f64::from(ior))),
                        total: crossing.total,
                        reflected: back.share,
                        absorbed: on.share,
                        ..Split::OPAQUE
                    },
                );
                self.base(at, on.share);
                self.reflected(at, back);
            }
            Interface::Alpha { opacity } => {
                let (absorbed, transmitted) =
                    (DVec3::splat(f64::from(opacity)), DVec3::splat(1.0 - f64::from(opacity)));
                self.split(at, Split { transmitted, absorbed, ..Split::OPAQUE });
                self.base(at, absorbed);
                self.straight(at, Way { share: transmitted, polarisation: at.before });
            }
        }
    }

    /// Sends refracted light, of one wavelength or white.
    pub fn refracted(
        &mut self,
        at: &Arrival,
        boundary: &Boundary<f64>,
        crossing: &Crossing<f64>,
        way: Way,
        beyond: MediumStack,
        nm: Option<f64>,
    ) {
        let Refracted { direction, total } = self.prepared.refract(boundary, at, crossing);
        // Light that is not bent keeps its direction.
        if boundary.kc == 0.0 {
            self.send_coloured(at, RayKind::Transmitted, at.ray.dir, way, beyond, nm);
        } else if total {
            self.cut(at, RayKind::Transmitted, at.ray.weight * way.share, false, false);
        } else if at.surface.interpolated.is_some() {
            let dir = below_surface(direction, at.geometric.into());
            self.send_coloured(at, RayKind::Transmitted, dir.into(), way, beyond, nm);
        } else {
            self.send_coloured(at, RayKind::Transmitted, direction.into(), way, beyond, nm);
        }
    }

    /// Handles reflected light as the render's options say.
    pub fn reflected(&mut self, at: &Arrival, way: Way) {
        match self.prepared.reflection {
            Reflection::Traced => self.send(at, RayKind::Reflected, at.mirrored(), way, at.ray.stack.clone()),
            Reflection::Environment => self.mirror_environment(at, way.share),
            Reflection::None => self.not_reflected(at, way.share),
        }
    }

    fn mirror_environment(&mut self, at: &Arrival, share: DVec3) {
        let seen = colour::of_environment(self.prepared.scene, at.mirrored());
        self.add(at.ray.node, Source::MirroredEnvironment, at.ray.weight * share * seen);
    }

    /// Leaves a reflection out, and counts its weight as truncated.
    fn not_reflected(&mut self, at: &Arrival, share: DVec3) {
        let weight = at.ray.weight * share;
        if weight != DVec3::ZERO {
            self.cut(at, RayKind::Reflected, weight, false, false);
        }
    }

    fn straight(&mut self, at: &Arrival, way: Way) {
        self.send(at, RayKind::Transmitted, at.ray.dir, way, at.ray.stack.clone());
    }

    /// Adds a secondary ray of the arriving wavelength.
    fn send(&mut self, at: &Arrival, kind: RayKind, dir: DVec3, way: Way, stack: MediumStack) {
        self.send_coloured(at, kind, dir, way, stack, at.ray.nm);
    }

    /// Adds a secondary ray.
    fn send_coloured(
        &mut self,
        at: &Arrival,
        kind: RayKind,
        dir: DVec3,
        way: Way,
        stack: MediumStack,
        nm: Option<f64>,
    ) {
        let weight = at.ray.weight * way.share;
        if weight != DVec3::ZERO {
            self.branches.push(Branch { kind, dir, weight, nm, stack, polarisation: way.polarisation });
        }
    }

    /// Queues the surface's secondary rays, except for those that the depth limit or the cut-off ends.
    fn send_branches(&mut self, at: &Arrival) {
        let settings = &self.prepared.scene.settings;
        let depth = at.ray.depth + 1;
        let too_deep = at.ray.depth >= self.prepared.max_depth;
        let mut branches = std::mem::take(&mut self.branches);
        let proven = self.prepared.tolls.as_ref().ok().and_then(Option::as_ref).map(|tolls| {
            debug_assert!(branches.len() <= 2, "a budget is divided between two");
            let toll = |k: usize| branches.get(k).map_or(DVec3::ZERO, |b: &Branch| b.weight * tolls.at(depth as usize));
            divide(at.ray.budget.into(), [toll(0).into(), toll(1).into()])
        });
        for (k, branch) in branches.drain(..).enumerate() {
            let Branch { kind, dir, weight, nm, stack, polarisation } = branch;
            let (too_light, budget) = match &proven {
                None => (weight.abs().max_element() < f64::from(settings.cutoff), at.ray.budget),
                Some(Division { cut, budget }) => (cut[k], budget[k].into()),
            };
            if too_deep || too_light {
                self.cut(at, kind, weight, too_deep, too_light);
                continue;
            }
            let dir = dir.normalize();
            let polarisation = polarisation.map(|carried| carried.along(dir));
            let origin = at.surface.start(dir);
            let through = if dir.dot(at.geometric) < 0.0 { at.onward } else { at.returning };
            let ray = Pending {
                origin,
                dir,
                weight,
                depth,
                kind,
                nm,
                stack,
                passed: 0,
                through,
                polarisation,
                budget,
                node: 0,
            };
            self.queue(at.ray.node, ray);
        }
        self.branches = branches;
    }

    /// Counts a secondary ray's weight as truncated.
    fn cut(&mut self, at: &Arrival, kind: RayKind, weight: DVec3, too_deep: bool, too_light: bool) {
        let proven = matches!(self.prepared.tolls, Ok(Some(_)));
        let limit = match (too_deep, too_light && !proven) {
            (true, _) => Limit::Depth,
            (false, true) => Limit::Cutoff,
            (false, false) => Limit::Asked,
        };
        self.tally.end(limit, weight);
        self.note(at.ray.node, |event| event.cut.push(Cut { kind, weight, too_deep, too_light }));
    }

    /// Adds the base of the surface: emission, ambient light, and the light of each lamp it faces.
    fn base(&mut self, at: &Arrival, share: DVec3) {
        let scene = self.prepared.scene;
        let weight = at.ray.weight * share;
        let material = at.material;
        let ambient = material.ambient.as_dvec3() * scene.ambient.as_dvec3();
        let glow = weight * (material.emission.as_dvec3() + ambient);
        if glow != DVec3::ZERO {
            self.add(at.ray.node, Source::Glow, glow);
        }
        let albedo = colour::on_surface(scene, &material.diffuse, at.surface.point, at.surface.uv);
        for (number, light) in scene.lights.iter().enumerate() {
            let points = &self.prepared.points;
            let count = if light.kind.is_extended() { points.count() } else { 1 };
            let by = points.scramble(self.film.pixel, at.ray.depth, number as u32);
            let mut sum: Option<Lit> = None;
            for i in 0..count {
                let of = points.point(by, self.film.sample, i).map(f64::from);
                if let Some(lit) = self.lit(at, light, of, albedo, weight / f64::from(count)) {
                    sum = Some(sum.map_or(lit, |sum| sum.and(lit)));
                }
            }
            if let Some(lit) = sum {
                self.write_down(at, number, &lit);
            }
        }
    }

    /// Adds the light of one lamp sample that the surface reflects. Returns `None` if there is none.
    fn lit(&mut self, at: &Arrival, light: &Light, of: [f64; 2], albedo: DVec3, weight: DVec3) -> Option<Lit> {
        let arriving = Arriving::at(light, at.surface.point, of);
        let cos_theta = arriving.towards.dot(at.shading);
        if cos_theta <= 0.0 || arriving.towards.dot(at.geometric) <= 0.0 {
            return None;
        }
        let lobe = at.material.highlight.map_or(DVec3::ZERO, |h| highlight(&h, at, arriving.towards));
        let sent = albedo * arriving.diffuse * cos_theta + lobe * arriving.highlight;
        if weight * sent == DVec3::ZERO {
            return None;
        }
        let let_through = if light.shadows { self.shadow(at, &arriving) } else { DVec3::ONE };
        let radiance = weight * sent * let_through;
        self.tally.add(radiance);
        self.tally.lit |= radiance != DVec3::ZERO;
        Some(Lit { arriving, unshadowed: weight * sent, radiance })
    }

    /// Records a light's contribution, and the object that blocks it.
    fn write_down(&mut self, at: &Arrival, light: usize, lit: &Lit) {
        let prepared = self.prepared;
        self.note(at.ray.node, |event| {
            let &Lit { arriving: Arriving { towards, distance, .. }, unshadowed, radiance } = lit;
            let shadow = Ray64 { t_max: distance, ..Ray64::new(at.surface.start(towards), towards) };
            let dark = radiance == DVec3::ZERO;
            let blocker = dark.then(|| blocker(prepared, &shadow)).flatten();
            event.shares.push(Share { source: Source::Light(light as u32), unshadowed, radiance, blocker });
        });
    }

    fn shadow(&mut self, at: &Arrival, arriving: &Arriving) -> DVec3 {
        self.tally.rays.add(RayKind::Shadow, at.ray.depth as usize, 1);
        let origin = at.surface.start(arriving.towards);
        let mut towards = arriving.towards;
        if self.shadows_turned != DVec3::ZERO {
            towards = (towards + self.shadows_turned).normalize();
        }
        let ray = Ray64 { t_max: arriving.distance, ..Ray64::new(origin, towards) };
        let (share, unmatched_exits) = let_through(self.prepared, &ray, at.returning, &at.ray.stack, at.ray.nm);
        self.tally.unmatched_exits.merge(&unmatched_exits);
        share
    }
}

impl Prepared<'_> {
    /// Returns the refracted direction by the chosen formula.
    fn refract(&self, boundary: &Boundary<f64>, at: &Arrival, crossing: &Crossing<f64>) -> Refracted<f64> {
        struct Of<'a>(&'a Boundary<f64>, &'a Arrival<'a>, &'a Crossing<f64>);
        impl RefractionVisitor for Of<'_> {
            type Output = Refracted<f64>;
            fn visit<F: RefractionFormula>(self, formula: F) -> Refracted<f64> {
                let Self(boundary, at, crossing) = self;
                formula.refract(boundary, at.ray.dir.into(), at.shading.into(), crossing)
            }
        }
        self.refraction.dispatch(Of(boundary, at, crossing))
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
    fn mirrored(&self) -> DVec3 {
        DVec3::from(reflect(self.ray.dir.into(), Vector3::from(self.shading))).normalize()
    }
}

/// Returns the shading normal, on the side of the geometric one that faces the ray.
fn shading_normal(incident: DVec3, geometric: DVec3, surface: &Surface) -> DVec3 {
    let Some(interpolated) = surface.interpolated else { return geometric };
    let turned = if interpolated.dot(geometric) < 0.0 { -interpolated } else { interpolated };
    consistent_normal(incident.into(), geometric.into(), turned.into()).into()
}

/// Returns a highlight's colour times its lobe.
fn highlight(highlight: &Highlight, at: &Arrival, towards: DVec3) -> DVec3 {
    let viewer = -at.ray.dir;
    let cos = match highlight.model {
        HighlightModel::Phong => DVec3::from(reflect((-towards).into(), Vector3::from(at.shading))).dot(viewer),
        HighlightModel::BlinnPhong => (towards + viewer).normalize_or_zero().dot(at.shading),
    };
    highlight.colour.as_dvec3() * cos.max(0.0).powf(f64::from(highlight.exponent))
}
