//! One ray and all that follows from it.

use glam::DVec3;

use super::light::{Arriving, let_through};
use super::media::{MediumStack, Meeting};
use super::split::{of_metal, reflectance, share};
use super::surface::Surface;
use super::{Prepared, Tally, colour};
use crate::accel::reference::Ray64;
use crate::math::Vector3;
use crate::optics::{
    Bec, Boundary, Crossing, Heckbert, Refracted, RefractionFormula, RefractionModel, SlidesVector, Stable,
    StraightThrough, Trigonometric, below_surface, consistent_normal, reflect, thin_reflectance, transmittance,
};
use crate::render::RayKind;
use crate::scene::{Highlight, HighlightModel, Interface, Material, MirrorSource};

/// Surfaces that are "not there" in a row, at most.
const PASSED_AT_MOST: u32 = 256;

/// A ray still to be traced.
#[derive(Clone, Debug)]
pub(super) struct Pending {
    pub origin: DVec3,
    /// Unit length.
    pub dir: DVec3,
    pub weight: DVec3,
    pub depth: u32,
    pub kind: RayKind,
    pub stack: MediumStack,
    /// Surfaces in a row that were not there.
    pub passed: u32,
}

/// A ray's arrival at a surface.
struct Arrival<'a> {
    ray: &'a Pending,
    surface: Surface,
    material: &'a Material,
    /// Unit normals on the side the ray arrives on.
    geometric: DVec3,
    shading: DVec3,
    cos_i: f64,
}

/// Traces depth first: what a ray sends out waits on a list instead of on the call stack, which a scene's depth limit
/// could exhaust.
pub(super) struct Tracer<'a> {
    prepared: &'a Prepared<'a>,
    tally: Tally,
    pending: Vec<Pending>,
}

impl<'a> Tracer<'a> {
    /// All that comes of a camera ray.
    pub fn trace(prepared: &'a Prepared<'a>, origin: DVec3, dir: DVec3) -> Tally {
        let camera_ray = Pending {
            origin,
            dir,
            weight: DVec3::ONE,
            depth: 0,
            kind: RayKind::Camera,
            stack: prepared.stack.clone(),
            passed: 0,
        };
        let mut tracer = Self { prepared, tally: Tally::default(), pending: vec![camera_ray] };
        while let Some(ray) = tracer.pending.pop() {
            tracer.follow(ray);
        }
        tracer.tally
    }

    fn follow(&mut self, mut ray: Pending) {
        let scene = self.prepared.scene;
        self.tally.rays.add(ray.kind, ray.depth as usize, 1);
        let line = Ray64::new(ray.origin, ray.dir);
        let hit = self.prepared.accel.closest(&line);
        let absorption = scene.media[ray.stack.top(scene) as usize].absorption.as_dvec3();
        ray.weight *= DVec3::from(transmittance(absorption.into(), hit.t));
        if ray.weight == DVec3::ZERO {
            return;
        }
        if !hit.is_hit() {
            self.tally.add(ray.weight * colour::of_environment(scene, ray.dir));
            return;
        }
        let surface = Surface::at(scene, &line, &hit);
        let front = ray.dir.dot(surface.outward) < 0.0;
        let material = self.prepared.material(hit.geometry);
        let meeting = match material.interface {
            Interface::Dielectric { medium, .. } => Some(ray.stack.meet(scene, medium, front)),
            _ => None,
        };
        if let Some(Meeting::NotThere(beyond)) = meeting {
            self.pass(&ray, &surface, beyond);
            return;
        }
        let geometric = if front { surface.outward } else { -surface.outward };
        let shading = shading_normal(ray.dir, geometric, &surface);
        let cos_i = -ray.dir.dot(shading);
        let arrival = Arrival { ray: &ray, surface, material, geometric, shading, cos_i };
        self.meet(&arrival, meeting);
    }

    /// Straight on through a surface that is not there.
    fn pass(&mut self, ray: &Pending, surface: &Surface, stack: MediumStack) {
        if ray.passed >= PASSED_AT_MOST {
            self.tally.truncated += ray.weight;
            return;
        }
        let origin = surface.start(ray.dir);
        let kind = RayKind::Transmitted;
        self.pending.push(Pending { origin, stack, kind, passed: ray.passed + 1, ..ray.clone() });
    }

    /// The table of shares at the head of `scene/material.rs`.
    fn meet(&mut self, at: &Arrival, meeting: Option<Meeting>) {
        let prepared = self.prepared;
        let scene = prepared.scene;
        let one = DVec3::ONE;
        let here = || prepared.ior(at.ray.stack.top(scene));
        match at.material.interface {
            Interface::Opaque => self.base(at, 1.0),
            Interface::Mirror { reflectance, source } => {
                self.base(at, 1.0);
                match source {
                    MirrorSource::Traced => self.reflected(at, reflectance.as_dvec3()),
                    MirrorSource::Environment => {
                        let seen = colour::of_environment(scene, at.mirrored());
                        self.tally.add(at.ray.weight * reflectance.as_dvec3() * seen);
                    }
                }
            }
            Interface::Conductor { eta, k } => {
                self.base(at, 1.0);
                // A metal's index counts relative to what the light comes through.
                let (eta, k) = (eta.as_dvec3() / here(), k.as_dvec3() / here());
                self.reflected(at, of_metal(prepared.fresnel, at.cos_i, eta, k));
            }
            Interface::Dielectric { rule, tint, .. } => {
                self.base(at, 1.0);
                let Some(Meeting::Boundary { from, to, beyond, unmatched }) = meeting else { return };
                self.tally.unmatched_exits += u64::from(unmatched);
                let boundary = Boundary::new(prepared.ior(from), prepared.ior(to));
                let crossing = boundary.cross(at.cos_i);
                let r = share(rule, crossing.total, reflectance(prepared.fresnel, &boundary, &crossing));
                self.reflected(at, r);
                if !crossing.total {
                    let share = (one - r) * tint.as_dvec3();
                    let Refracted { direction, total } = prepared.refract(&boundary, at, &crossing);
                    // Light that is not bent at all goes on as it came.
                    if boundary.kc == 0.0 {
                        self.send(at, RayKind::Transmitted, at.ray.dir, share, beyond);
                    } else if total {
                        self.tally.truncated += at.ray.weight * share;
                    } else if at.surface.interpolated.is_some() {
                        let dir = below_surface(direction, at.geometric.into());
                        self.send(at, RayKind::Transmitted, dir.into(), share, beyond);
                    } else {
                        self.send(at, RayKind::Transmitted, direction.into(), share, beyond);
                    }
                }
            }
            Interface::ThinDielectric { ior, rule, tint } => {
                self.base(at, 1.0);
                let boundary = Boundary::new(here(), f64::from(ior));
                let crossing = boundary.cross(at.cos_i);
                let r = thin_reflectance(reflectance(prepared.fresnel, &boundary, &crossing));
                let r = share(rule, crossing.total, r);
                self.reflected(at, r);
                self.straight(at, (one - r) * tint.as_dvec3());
            }
            Interface::Coated { ior } => {
                let boundary = Boundary::new(here(), f64::from(ior));
                let r = reflectance(prepared.fresnel, &boundary, &boundary.cross(at.cos_i));
                self.base(at, 1.0 - r);
                self.reflected(at, DVec3::splat(r));
            }
            Interface::Alpha { opacity } => {
                self.base(at, f64::from(opacity));
                self.straight(at, DVec3::splat(1.0 - f64::from(opacity)));
            }
        }
    }

    fn reflected(&mut self, at: &Arrival, share: DVec3) {
        self.send(at, RayKind::Reflected, at.mirrored(), share, at.ray.stack.clone());
    }

    fn straight(&mut self, at: &Arrival, share: DVec3) {
        self.send(at, RayKind::Transmitted, at.ray.dir, share, at.ray.stack.clone());
    }

    /// Queues a secondary ray, or counts its weight as truncated.
    fn send(&mut self, at: &Arrival, kind: RayKind, dir: DVec3, share: DVec3, stack: MediumStack) {
        let settings = &self.prepared.scene.settings;
        let weight = at.ray.weight * share;
        if weight == DVec3::ZERO {
            return;
        }
        if at.ray.depth >= settings.max_depth || weight.max_element() < f64::from(settings.cutoff) {
            self.tally.truncated += weight;
            return;
        }
        let dir = dir.normalize();
        let origin = at.surface.start(dir);
        self.pending.push(Pending { origin, dir, weight, depth: at.ray.depth + 1, kind, stack, passed: 0 });
    }

    /// What the surface sends by itself: emission, ambient, and each light it faces.
    fn base(&mut self, at: &Arrival, share: f64) {
        let scene = self.prepared.scene;
        let weight = at.ray.weight * share;
        let material = at.material;
        let ambient = material.ambient.as_dvec3() * scene.ambient.as_dvec3();
        self.tally.add(weight * (material.emission.as_dvec3() + ambient));
        let albedo = colour::on_surface(scene, &material.diffuse, at.surface.point, at.surface.uv);
        for light in &scene.lights {
            let arriving = Arriving::at(light, at.surface.point);
            let cos_theta = arriving.towards.dot(at.shading);
            if cos_theta <= 0.0 || arriving.towards.dot(at.geometric) <= 0.0 {
                continue;
            }
            let lobe = material.highlight.map_or(DVec3::ZERO, |h| highlight(&h, at, arriving.towards));
            let sent = albedo * arriving.diffuse * cos_theta + lobe * arriving.highlight;
            if weight * sent == DVec3::ZERO {
                continue;
            }
            let let_through = if light.shadows { self.shadow(at, &arriving) } else { DVec3::ONE };
            self.tally.add(weight * sent * let_through);
        }
    }

    fn shadow(&mut self, at: &Arrival, arriving: &Arriving) -> DVec3 {
        self.tally.rays.add(RayKind::Shadow, at.ray.depth as usize, 1);
        let origin = at.surface.start(arriving.towards);
        let ray = Ray64 { t_max: arriving.distance, ..Ray64::new(origin, arriving.towards) };
        let (share, unmatched_exits) = let_through(self.prepared, &ray, &at.ray.stack);
        self.tally.unmatched_exits += unmatched_exits;
        share
    }
}

impl Prepared<'_> {
    /// The refracted direction by the chosen formula.
    fn refract(&self, boundary: &Boundary<f64>, at: &Arrival, crossing: &Crossing<f64>) -> Refracted<f64> {
        fn by<F: RefractionFormula>(
            formula: F,
            boundary: &Boundary<f64>,
            at: &Arrival,
            crossing: &Crossing<f64>,
        ) -> Refracted<f64> {
            formula.refract(boundary, at.ray.dir.into(), at.shading.into(), crossing)
        }
        match self.refraction {
            RefractionModel::Stable => by(Stable, boundary, at, crossing),
            RefractionModel::Trigonometric => by(Trigonometric, boundary, at, crossing),
            RefractionModel::Heckbert => by(Heckbert, boundary, at, crossing),
            RefractionModel::Bec => by(Bec, boundary, at, crossing),
            RefractionModel::SlidesVector => by(SlidesVector, boundary, at, crossing),
            RefractionModel::Oliveira => by(self.oliveira, boundary, at, crossing),
            RefractionModel::StraightThrough => by(StraightThrough, boundary, at, crossing),
        }
    }
}

impl Arrival<'_> {
    /// The unit direction of the ray's mirror image.
    fn mirrored(&self) -> DVec3 {
        DVec3::from(reflect(self.ray.dir.into(), Vector3::from(self.shading))).normalize()
    }
}

/// The normal that shading uses, on the side of the geometric one that faces the ray.
fn shading_normal(incident: DVec3, geometric: DVec3, surface: &Surface) -> DVec3 {
    let Some(interpolated) = surface.interpolated else { return geometric };
    let turned = if interpolated.dot(geometric) < 0.0 { -interpolated } else { interpolated };
    consistent_normal(incident.into(), geometric.into(), turned.into()).into()
}

/// A highlight's colour times its lobe.
fn highlight(highlight: &Highlight, at: &Arrival, towards: DVec3) -> DVec3 {
    let viewer = -at.ray.dir;
    let cos = match highlight.model {
        HighlightModel::Phong => DVec3::from(reflect((-towards).into(), Vector3::from(at.shading))).dot(viewer),
        HighlightModel::BlinnPhong => (towards + viewer).normalize_or_zero().dot(at.shading),
    };
    highlight.colour.as_dvec3() * cos.max(0.0).powf(f64::from(highlight.exponent))
}
