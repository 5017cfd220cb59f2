//! What arrives at a point from a light.

use glam::DVec3;

use super::super::lamp::before_lamp;
use super::media::{MediumStack, Meeting};
use super::split::{reflectance, share};
use super::{Prepared, surface};
use crate::accel::reference::Ray64;
use crate::geometry::GeometryMask;
use crate::optics::{Boundary, thin_reflectance, transmittance};
use crate::scene::{Falloff, Interface, Light, LightKind, ShadowRule};

/// Transmissive surfaces that light passes on its way, at most; more count as an opaque one.
const MARCHED_AT_MOST: usize = 256;

/// Light that arrives at a point, were nothing in its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    /// Unit direction towards the light.
    pub towards: DVec3,
    /// Distance to it; infinite where it shines from infinitely far.
    pub distance: f64,
    /// What a Lambert surface of albedo 1 sends back at normal incidence.
    pub diffuse: DVec3,
    /// What a highlight's colour and lobe are multiplied with.
    pub highlight: DVec3,
}

impl Arriving {
    /// The light that reaches `point`; not finite where the light stands on the point.
    pub fn at(light: &Light, point: DVec3) -> Self {
        let (towards, distance, cone) = match light.kind {
            LightKind::Directional { direction } => (-direction.as_dvec3().normalize(), f64::INFINITY, 1.0),
            LightKind::Point { position } => {
                let way = position.as_dvec3() - point;
                (way / way.length(), way.length(), 1.0)
            }
            LightKind::Spot { position, direction, cos_inner, cos_outer } => {
                let way = position.as_dvec3() - point;
                let towards = way / way.length();
                let cos = -towards.dot(direction.as_dvec3().normalize());
                (towards, way.length(), cone(cos, f64::from(cos_inner), f64::from(cos_outer)))
            }
        };
        let strength = light.intensity.as_dvec3() * cone;
        let (diffuse, highlight) = match light.falloff {
            Falloff::None => (strength, strength),
            Falloff::InverseSquare => {
                let weakened = if distance.is_infinite() { strength } else { strength / (distance * distance) };
                (weakened / std::f64::consts::PI, weakened)
            }
        };
        Self { towards, distance, diffuse, highlight }
    }
}

fn cone(cos: f64, inner: f64, outer: f64) -> f64 {
    if cos >= inner {
        1.0
    } else if cos <= outer {
        0.0
    } else {
        let s = (cos - outer) / (inner - outer);
        s * s * (3.0 - 2.0 * s)
    }
}

/// The share of a light at the far end of `ray` that reaches its start, where the media are `stack`, and how often it
/// left a medium it had never entered. The media have their indices for light of the wavelength `nm`.
pub(super) fn let_through(prepared: &Prepared, ray: &Ray64, stack: &MediumStack, nm: Option<f64>) -> (DVec3, u64) {
    if prepared.accel.occluded(&blocking(prepared, ray)) {
        return (DVec3::ZERO, 0);
    }
    match prepared.scene.settings.shadows {
        ShadowRule::Opaque => (DVec3::ONE, 0),
        ShadowRule::Straight => march(prepared, ray, stack, nm),
    }
}

/// The nearest thing that blocks the light at the far end of `ray` all by itself, a place in the list of geometries.
pub(super) fn blocker(prepared: &Prepared, ray: &Ray64) -> Option<u32> {
    let hit = prepared.accel.closest(&blocking(prepared, ray));
    hit.is_hit().then_some(hit.geometry)
}

/// A shadow ray that looks for what blocks it.
fn blocking(prepared: &Prepared, ray: &Ray64) -> Ray64 {
    let admits = match prepared.scene.settings.shadows {
        ShadowRule::Opaque => GeometryMask::ALL,
        ShadowRule::Straight => GeometryMask::OPAQUE,
    };
    Ray64 { admits, t_max: end_of(ray), ..*ray }
}

/// As far as surfaces are in a shadow ray's way.
fn end_of(ray: &Ray64) -> f64 {
    before_lamp(ray.origin.into(), ray.dir.into(), ray.t_max)
}

/// Straight through every transmissive surface on the way.
fn march(prepared: &Prepared, ray: &Ray64, stack: &MediumStack, nm: Option<f64>) -> (DVec3, u64) {
    let scene = prepared.scene;
    let mut stack = stack.clone();
    let (mut share_left, mut unmatched_exits, mut reached) = (DVec3::ONE, 0, 0.0);
    let absorbed = |stack: &MediumStack, distance: f64| -> DVec3 {
        let absorption = scene.media[stack.top(scene) as usize].absorption.as_dvec3();
        transmittance(absorption.into(), distance).into()
    };
    let marched = Ray64 { admits: GeometryMask::TRANSMISSIVE, t_max: end_of(ray), ..*ray };
    let crossings = surface::crossings(scene, &prepared.accel, &marched);
    if crossings.len() > MARCHED_AT_MOST {
        return (DVec3::ZERO, 0);
    }
    for crossing in crossings {
        if share_left == DVec3::ZERO {
            break;
        }
        share_left *= absorbed(&stack, crossing.t - reached);
        reached = crossing.t;
        let cos = crossing.cos;
        match prepared.material(crossing.geometry).interface {
            Interface::Dielectric { medium, rule, tint } => match stack.meet(scene, medium, crossing.front) {
                Meeting::NotThere(beyond) => stack = beyond,
                Meeting::Boundary { from, to, beyond, unmatched } => {
                    let (n1, n2) = (prepared.ior(from, nm), prepared.ior(to, nm));
                    let boundary = Boundary::new(n1.min(n2), n1.max(n2));
                    let r = reflectance(prepared.fresnel, &boundary, &boundary.cross(cos));
                    share_left *= (DVec3::ONE - share(rule, false, r)) * tint.as_dvec3();
                    unmatched_exits += u64::from(unmatched);
                    stack = beyond;
                }
            },
            Interface::ThinDielectric { ior, rule, tint } => {
                let boundary = Boundary::new(prepared.ior(stack.top(scene), nm), f64::from(ior));
                let at = boundary.cross(cos);
                let r = thin_reflectance(reflectance(prepared.fresnel, &boundary, &at));
                share_left *= (DVec3::ONE - share(rule, at.total, r)) * tint.as_dvec3();
            }
            Interface::Alpha { opacity } => share_left *= 1.0 - f64::from(opacity),
            // Only a wrong geometry mask brings one of these here; it blocks all the same.
            Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => {
                return (DVec3::ZERO, unmatched_exits);
            }
        }
    }
    (share_left * absorbed(&stack, ray.t_max - reached), unmatched_exits)
}
