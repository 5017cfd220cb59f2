//! Light from a surface itself, and from the lamps that it faces.

use glam::DVec3;

use super::colour;
use super::light::{Arriving, blocker, let_through};
use super::trace::{Arrival, Tracer};
use crate::accel::reference::Ray64;
use crate::math::Vector3;
use crate::optics::reflect;
use crate::render::RayKind;
use crate::render::record::{Recorder, Share, Source};
use crate::render::shine::{Shine, Shiner};
use crate::scene::{Highlight, HighlightModel, Light};

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

impl<L: Recorder> Tracer<'_, '_, L> {
    /// Adds the base of the surface: emission, ambient light, and the light of each lamp it faces.
    pub fn base(&mut self, at: &Arrival, share: DVec3) {
        let scene = self.prepared.scene;
        let weight = at.ray.weight * share;
        let material = at.material;
        let ambient = material.ambient.as_dvec3() * scene.ambient.as_dvec3();
        let emission = material
            .glow
            .as_ref()
            .map_or(material.emission.as_dvec3(), |glow| colour::on_surface(scene, glow, &at.surface));
        let glow = weight * (emission + ambient);
        if glow != DVec3::ZERO {
            self.add(at.ray.node, Source::Glow, glow);
        }
        let albedo = colour::on_surface(scene, &material.diffuse, &at.surface);
        for (number, light) in scene.lights.iter().enumerate().filter(|(_, light)| !scene.is_sampled(light)) {
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
                self.write_down(at, Source::Light(number as u32), &lit);
            }
        }
        for kind in Shiner::ALL {
            self.shine(at, kind, albedo, weight);
        }
    }

    /// Adds the light of a source that shines beside lamps.
    fn shine(&mut self, at: &Arrival, kind: Shiner, albedo: DVec3, weight: DVec3) {
        let prepared = self.prepared;
        let Shine { emitters, around } = &prepared.shine;
        let is_there = match kind {
            Shiner::Emitters => emitters.is_some(),
            Shiner::Around => around.is_some(),
        };
        if !is_there {
            return;
        }
        let points = &prepared.points;
        let by = points.scramble(self.film.pixel, at.ray.depth, kind.number(prepared.scene) as u32);
        let mut sum: Option<Lit> = None;
        for i in 0..points.count() {
            let of = points.in_cube(by, self.film.sample, i);
            let arriving = match kind {
                Shiner::Emitters => emitters.as_ref().and_then(|e| Arriving::from_shapes(e, at, of)),
                Shiner::Around => around.as_ref().map(|a| Arriving::from_around(a, prepared.scene, at, of)),
            };
            let shadows = prepared.scene.settings.shine_shadows;
            let lit = arriving.and_then(|a| self.lit_by(at, a, shadows, albedo, weight / f64::from(points.count())));
            if let Some(lit) = lit {
                sum = Some(sum.map_or(lit, |sum| sum.and(lit)));
            }
        }
        if let Some(lit) = sum {
            let source = if kind == Shiner::Emitters { Source::Emitters } else { Source::Sky };
            self.write_down(at, source, &lit);
        }
    }

    /// Adds the light of one lamp sample that the surface reflects. Returns `None` if there is none.
    fn lit(&mut self, at: &Arrival, light: &Light, of: [f64; 2], albedo: DVec3, weight: DVec3) -> Option<Lit> {
        self.lit_by(at, Arriving::at(light, at.surface.point, of), light.shadows, albedo, weight)
    }

    /// Adds the arriving light that the surface reflects. Returns `None` if there is none.
    fn lit_by(&mut self, at: &Arrival, arriving: Arriving, shadows: bool, albedo: DVec3, weight: DVec3) -> Option<Lit> {
        let cos_theta = arriving.towards.dot(at.shading);
        if cos_theta <= 0.0 || arriving.towards.dot(at.geometric) <= 0.0 {
            return None;
        }
        let lobe = at.material.highlight.map_or(DVec3::ZERO, |h| highlight(&h, at, arriving.towards));
        let sent = albedo * arriving.diffuse * cos_theta + lobe * arriving.highlight;
        if weight * sent == DVec3::ZERO {
            return None;
        }
        let let_through = if shadows { self.shadow(at, &arriving) } else { DVec3::ONE };
        let radiance = weight * sent * let_through;
        self.tally.add(radiance);
        self.tally.lit |= radiance != DVec3::ZERO;
        Some(Lit { arriving, unshadowed: weight * sent, radiance })
    }

    /// Records a light's contribution, and the object that blocks it.
    fn write_down(&mut self, at: &Arrival, source: Source, lit: &Lit) {
        let prepared = self.prepared;
        self.note(at.ray.node, |event| {
            let &Lit { arriving: Arriving { towards, distance, .. }, unshadowed, radiance } = lit;
            let shadow = Ray64 { t_max: distance, ..Ray64::new(at.surface.start(towards), towards) };
            let dark = radiance == DVec3::ZERO;
            let blocker = dark.then(|| blocker(prepared, &shadow)).flatten();
            event.shares.push(Share { source, unshadowed, radiance, blocker });
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

/// Returns a highlight's colour times its lobe.
fn highlight(highlight: &Highlight, at: &Arrival, towards: DVec3) -> DVec3 {
    let viewer = -at.ray.dir;
    let cos = match highlight.model {
        HighlightModel::Phong => DVec3::from(reflect((-towards).into(), Vector3::from(at.shading))).dot(viewer),
        HighlightModel::BlinnPhong => (towards + viewer).normalize_or_zero().dot(at.shading),
    };
    highlight.colour.as_dvec3() * cos.max(0.0).powf(f64::from(highlight.exponent))
}
