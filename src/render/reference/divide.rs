//! Shares of light that a surface divides a ray into: the table in `scene/material.rs`.

use glam::DVec3;

use super::disperse::Dispersing;
use super::media::{MediumStack, Transition};
use super::split::{Lobe, Lobes, at_boundary, at_metal, at_mirror, at_pane};
use super::trace::{Arrival, Tracer};
use super::{Prepared, colour};
use crate::optics::{
    Boundary, Crossing, Refracted, RefractionFormula, RefractionModel, RefractionVisitor, below_surface,
};
use crate::render::record::{Recorder, Source, Split};
use crate::render::{Limit, RayKind, Reflection};
use crate::scene::{FresnelRule, Interface, MirrorSource};

impl<L: Recorder> Tracer<'_, '_, L> {
    /// Records the division of light at a surface.
    pub fn split(&mut self, at: &Arrival, split: Split) {
        self.note(at.ray.node, |event| event.split = Some(split));
    }

    /// Shades the surface: contributions and secondary rays, by the table of shares in `scene/material.rs`.
    pub fn shade(&mut self, at: &Arrival, transition: Option<Transition>) {
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
                let lobe = at_metal(prepared.fresnel, at.cos_i, eta, k, at.before);
                self.split(at, Split { reflected: lobe.share, absorbed: one - lobe.share, ..Split::OPAQUE });
                self.reflected(at, lobe);
            }
            Interface::Dielectric { rule, tint, .. } => {
                self.base(at, one);
                let Some(Transition::Boundary { from, to, beyond, .. }) = transition else { return };
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
                let Lobes { reflection, transmission } =
                    at_boundary(prepared.fresnel, rule, &boundary, &crossing, at.before);
                let through = if crossing.total { DVec3::ZERO } else { transmission.share };
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
                        reflected: reflection.share,
                        transmitted,
                        absorbed: through * (one - tint),
                    },
                );
                self.reflected(at, reflection);
                if !crossing.total {
                    let lobe = Lobe { share: transmitted, ..transmission };
                    self.refracted(at, &boundary, &crossing, lobe, beyond, nm);
                }
            }
            Interface::ThinDielectric { ior, rule, tint } => {
                self.base(at, one);
                let boundary = Boundary::new(here(), f64::from(ior));
                let crossing = boundary.cross(at.cos_i);
                let Lobes { reflection, transmission } =
                    at_pane(prepared.fresnel, rule, &boundary, &crossing, at.before);
                let tint = tint.as_dvec3();
                self.split(
                    at,
                    Split {
                        indices: Some((here(), f64::from(ior))),
                        total: crossing.total,
                        reflected: reflection.share,
                        transmitted: transmission.share * tint,
                        absorbed: transmission.share * (one - tint),
                        ..Split::OPAQUE
                    },
                );
                self.reflected(at, reflection);
                self.straight(at, Lobe { share: transmission.share * tint, ..transmission });
            }
            Interface::Coated { ior } => {
                let boundary = Boundary::new(here(), f64::from(ior));
                let crossing = boundary.cross(at.cos_i);
                let Lobes { reflection, transmission } =
                    at_boundary(prepared.fresnel, FresnelRule::Fresnel, &boundary, &crossing, at.before);
                self.split(
                    at,
                    Split {
                        indices: Some((here(), f64::from(ior))),
                        total: crossing.total,
                        reflected: reflection.share,
                        absorbed: transmission.share,
                        ..Split::OPAQUE
                    },
                );
                self.base(at, transmission.share);
                self.reflected(at, reflection);
            }
            Interface::Alpha { .. } => {
                let opacity = colour::opacity(prepared.scene, &at.material.interface, at.surface.uv);
                let (absorbed, transmitted) = (DVec3::splat(opacity), DVec3::splat(1.0 - opacity));
                self.split(at, Split { transmitted, absorbed, ..Split::OPAQUE });
                self.base(at, absorbed);
                self.straight(at, Lobe { share: transmitted, polarisation: at.before });
            }
        }
    }

    /// Sends refracted light, of one wavelength or white.
    pub fn refracted(
        &mut self,
        at: &Arrival,
        boundary: &Boundary<f64>,
        crossing: &Crossing<f64>,
        lobe: Lobe,
        beyond: MediumStack,
        nm: Option<f64>,
    ) {
        let Refracted { direction, total } = self.prepared.refract(boundary, at, crossing);
        // Light that is not bent keeps its direction.
        if boundary.kc == 0.0 {
            self.send_coloured(at, RayKind::Transmitted, at.ray.dir, lobe, beyond, nm);
        } else if total {
            self.cut(at, RayKind::Transmitted, at.ray.weight * lobe.share, false, false);
        } else {
            let smooth = at.surface.interpolated.is_some();
            let dir = if smooth { below_surface(direction, at.geometric.into()) } else { direction };
            if nm.is_some() || !self.looked_up(at, boundary, dir.into(), &lobe) {
                self.send_coloured(at, RayKind::Transmitted, dir.into(), lobe, beyond, nm);
            }
        }
    }

    /// Handles reflected light as the render's options say.
    pub fn reflected(&mut self, at: &Arrival, lobe: Lobe) {
        match self.prepared.reflection {
            Reflection::Traced => self.send(at, RayKind::Reflected, at.mirrored(), lobe, at.ray.stack.clone()),
            Reflection::Environment => self.mirror_environment(at, lobe.share),
            Reflection::None => self.not_reflected(at, lobe.share),
            Reflection::CubeMap | Reflection::SphereMap => self.reflected_in_map(at, lobe),
            Reflection::Planar => self.reflected_by_matrix(at, lobe),
            Reflection::Virtual => self.reflected_in_virtual_scene(at, lobe),
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

    fn straight(&mut self, at: &Arrival, lobe: Lobe) {
        self.send(at, RayKind::Transmitted, at.ray.dir, lobe, at.ray.stack.clone());
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
        // Only what lies behind a plane is raised as a whole.
        let flat = || self.flats.as_ref().is_some_and(|flats| flats.at(at.id.0, at.id.1).is_some());
        let curved = self.refraction == RefractionModel::Raised && !flat();
        let model = if curved { RefractionModel::Stable } else { self.refraction };
        model.dispatch(Of(boundary, at, crossing))
    }
}
