//! What arrives at a point from a light.

use glam::DVec3;

use super::super::extent::{Ball, Extent, Sheet};
use super::super::lamp::before_lamp;
use super::super::unmatched::UnmatchedExits;
use super::media::{MediumStack, Meeting};
use super::polarisation::Polarisation;
use super::split::{Ways, at_boundary, at_pane};
use super::{Prepared, surface};
use crate::accel::reference::Ray64;
use crate::geometry::GeometryMask;
use crate::math::Vector3;
use crate::optics::{Boundary, FresnelModel, transmittance};
use crate::scene::{Falloff, Interface, Light, LightKind, ShadowRule, Spread};

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
    /// The light that reaches `point`; not finite where the light stands on the point. Of a lamp with an extent it is
    /// what its whole intensity would send from its point `of`.
    pub fn at(light: &Light, point: DVec3, of: [f64; 2]) -> Self {
        let physical = light.falloff == Falloff::InverseSquare;
        let from_point = |position: DVec3| {
            let way = position - point;
            let weakened = if physical { 1.0 / way.length_squared() } else { 1.0 };
            (way / way.length(), way.length(), weakened)
        };
        let (towards, distance, factor) = match light.kind {
            LightKind::Directional { direction } => (-direction.as_dvec3().normalize(), f64::INFINITY, 1.0),
            LightKind::Point { position } => from_point(position.as_dvec3()),
            LightKind::Spot { position, direction, cos_inner, cos_outer } => {
                let (towards, distance, weakened) = from_point(position.as_dvec3());
                let cos = -towards.dot(direction.as_dvec3().normalize());
                (towards, distance, weakened * cone(cos, f64::from(cos_inner), f64::from(cos_outer)))
            }
            LightKind::Sphere { position, radius } => {
                let ball = Ball { centre: position.as_dvec3().into(), radius: f64::from(radius) };
                from_extent(&ball, physical, point, of)
            }
            LightKind::Rectangle { corner, edges, spread } => {
                let edges = edges.map(|edge| edge.as_dvec3());
                let normal = (spread == Spread::Cosine).then(|| edges[0].cross(edges[1]).normalize().into());
                let sheet = Sheet { corner: corner.as_dvec3().into(), edges: edges.map(Vector3::from), normal };
                from_extent(&sheet, physical, point, of)
            }
        };
        let highlight = light.intensity.as_dvec3() * factor;
        let diffuse = if physical { highlight / std::f64::consts::PI } else { highlight };
        Self { towards, distance, diffuse, highlight }
    }
}

/// Direction to a point of a lamp, distance, and what share of its intensity arrives.
fn from_extent(lamp: &impl Extent<f64>, physical: bool, point: DVec3, of: [f64; 2]) -> (DVec3, f64, f64) {
    let point = Vector3::from(point);
    let seen = if physical { lamp.point::<true>(point, of) } else { lamp.point::<false>(point, of) };
    (seen.dir.into(), seen.distance, seen.share.max(0.0))
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
pub(super) fn let_through(
    prepared: &Prepared,
    ray: &Ray64,
    stack: &MediumStack,
    nm: Option<f64>,
) -> (DVec3, UnmatchedExits) {
    let none = UnmatchedExits::default();
    if prepared.accel.occluded(&blocking(prepared, ray)) {
        return (DVec3::ZERO, none);
    }
    match prepared.scene.settings.shadows {
        ShadowRule::Opaque => (DVec3::ONE, none),
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
fn march(prepared: &Prepared, ray: &Ray64, stack: &MediumStack, nm: Option<f64>) -> (DVec3, UnmatchedExits) {
    let scene = prepared.scene;
    let mut stack = stack.clone();
    let (mut share_left, mut unmatched_exits, mut reached) = (DVec3::ONE, UnmatchedExits::default(), 0.0);
    let absorbed = |stack: &MediumStack, distance: f64| -> DVec3 {
        let absorption = scene.media[stack.top(scene) as usize].absorption.as_dvec3();
        transmittance(absorption.into(), distance).into()
    };
    let marched = Ray64 { admits: GeometryMask::TRANSMISSIVE, t_max: end_of(ray), ..*ray };
    // What the surface makes of the light depends on none of its polarisation, but what lets it through does.
    let mut carried = (prepared.fresnel == FresnelModel::Polarised).then(|| Polarisation::none(ray.dir));
    let crossings = surface::crossings(scene, &prepared.accel, &marched);
    if crossings.len() > MARCHED_AT_MOST {
        return (DVec3::ZERO, unmatched_exits);
    }
    for crossing in crossings {
        if share_left == DVec3::ZERO {
            break;
        }
        share_left *= absorbed(&stack, crossing.t - reached);
        reached = crossing.t;
        let cos = crossing.cos;
        let before = carried.map(|carried| carried.facing(ray.dir, crossing.outward));
        match prepared.material(crossing.geometry).interface {
            Interface::Dielectric { medium, rule, tint } => match stack.meet(scene, medium, crossing.front) {
                Meeting::NotThere(beyond) => stack = beyond,
                Meeting::Boundary { from, to, beyond, unmatched } => {
                    let (n1, n2) = (prepared.ior(from, nm), prepared.ior(to, nm));
                    let boundary = Boundary::new(n1.min(n2), n1.max(n2));
                    let Ways { on, .. } = at_boundary(prepared.fresnel, rule, &boundary, &boundary.cross(cos), before);
                    share_left *= on.share * tint.as_dvec3();
                    carried = on.polarisation;
                    if unmatched {
                        unmatched_exits.add(crossing.geometry);
                    }
                    stack = beyond;
                }
            },
            Interface::ThinDielectric { ior, rule, tint } => {
                let boundary = Boundary::new(prepared.ior(stack.top(scene), nm), f64::from(ior));
                let at = boundary.cross(cos);
                let Ways { on, .. } = at_pane(prepared.fresnel, rule, &boundary, &at, before);
                share_left *= on.share * tint.as_dvec3();
                carried = on.polarisation;
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
