//! Direct light of lamps at a point, and its occlusion.

use glam::{DVec2, DVec3};

use super::super::extent::{Ball, Extent, Sheet};
use super::super::lamp::before_lamp;
use super::super::light::within_cone;
use super::super::place::{ContactPoint, Layer, Through, governing};
use super::super::shine::{Around, Emitters};
use super::super::unmatched::UnmatchedExits;
use super::media::{MediumStack, Transition};
use super::polarisation::Polarisation;
use super::split::{Lobes, at_boundary, at_pane};
use super::surface::Surface;
use super::trace::Arrival;
use super::{Prepared, colour, surface};
use crate::accel::reference::Ray64;
use crate::geometry::GeometryMask;
use crate::geometry::contact::Face;
use crate::math::Vector3;
use crate::optics::{Boundary, FresnelModel, transmittance};
use crate::scene::{Falloff, Interface, Light, LightKind, MOST_PASSES, Scene, ShadowRule, Spread};

/// Light that arrives at a point without occlusion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    /// Unit direction towards the light.
    pub towards: DVec3,
    /// Distance to the light; infinite for directional light.
    pub distance: f64,
    /// Radiance reflected by a Lambertian surface of albedo 1 at normal incidence.
    pub diffuse: DVec3,
    /// Factor of a highlight's colour and lobe.
    pub highlight: DVec3,
}

impl Arriving {
    /// Computes the light that reaches `point`; not finite if the light is at the point. For an area lamp this is the
    /// light of its whole intensity from its sample point `of`, in the unit square.
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
                (towards, distance, weakened * within_cone(cos, f64::from(cos_inner), f64::from(cos_outer)))
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

    /// Computes the light of all emissive shapes from the sample `of` of the unit cube.
    pub fn from_shapes(emitters: &Emitters, at: &Arrival, of: [f32; 3]) -> Option<Self> {
        // The picks depend on a point near the surface, not on the direction in which the ray will leave it.
        let point = at.surface.start(at.geometric);
        let glint = emitters.sample::<f64>(point.into(), (point, at.shading), of)?;
        let light = DVec3::from(glint.light);
        Some(Self {
            towards: glint.dir.into(),
            distance: glint.distance,
            diffuse: light / std::f64::consts::PI,
            highlight: light,
        })
    }

    /// Computes the light of the environment from the sample `of` of the unit cube. It makes no highlights.
    pub fn from_around(around: &Around, scene: &Scene, at: &Arrival, of: [f32; 3]) -> Self {
        let ray = around.sample::<f64>(at.shading.into(), of, DVec3::from);
        let towards = DVec3::from(ray.dir);
        let light = colour::of_environment(scene, towards) * ray.solid;
        Self { towards, distance: f64::INFINITY, diffuse: light / std::f64::consts::PI, highlight: DVec3::ZERO }
    }
}

/// Returns the direction to a point of a lamp, its distance, and the share of the intensity that arrives.
fn from_extent(lamp: &impl Extent<f64>, physical: bool, point: DVec3, of: [f64; 2]) -> (DVec3, f64, f64) {
    let point = Vector3::from(point);
    let seen = if physical { lamp.point::<true>(point, of) } else { lamp.point::<false>(point, of) };
    (seen.dir.into(), seen.distance, seen.share.max(0.0))
}

/// Returns the share of a light at the far end of `ray` that reaches its origin, and the unmatched exits on the way.
/// `stack` is the medium stack at the origin, and media use their indices at the wavelength `nm`. A ray that starts
/// between coinciding layers first crosses the remaining ones, given by `through`.
pub(super) fn let_through(
    prepared: &Prepared,
    ray: &Ray64,
    through: Option<Through>,
    stack: &MediumStack,
    nm: Option<f64>,
) -> (DVec3, UnmatchedExits) {
    let none = UnmatchedExits::default();
    let blocking = blocking(prepared, ray);
    if prepared.accel.occluded(&blocking) {
        return (DVec3::ZERO, none);
    }
    if blocking.admits == GeometryMask::ALL {
        // Every surface blocks, including the remaining layers at the origin.
        return (if through.is_some() { DVec3::ZERO } else { DVec3::ONE }, none);
    }
    march(prepared, ray, through, stack, nm)
}

/// Returns the nearest object that blocks the light at the far end of `ray` by itself, as an index of geometry.
pub(super) fn blocker(prepared: &Prepared, ray: &Ray64) -> Option<u32> {
    let hit = prepared.accel.closest(&blocking(prepared, ray));
    hit.is_hit().then_some(hit.geometry)
}

/// Returns the shadow ray restricted to geometry that blocks it.
fn blocking(prepared: &Prepared, ray: &Ray64) -> Ray64 {
    let admits = match prepared.scene.settings.shadows {
        ShadowRule::Opaque => GeometryMask::ALL,
        ShadowRule::Straight => GeometryMask::OPAQUE,
    };
    Ray64 { admits, t_max: end_of(ray), ..*ray }
}

/// Returns the `t_max` for occlusion along a shadow ray.
fn end_of(ray: &Ray64) -> f64 {
    before_lamp(ray.origin.into(), ray.dir.into(), ray.t_max)
}

/// Marches light straight through every transmissive surface on the way.
fn march(
    prepared: &Prepared,
    ray: &Ray64,
    through: Option<Through>,
    stack: &MediumStack,
    nm: Option<f64>,
) -> (DVec3, UnmatchedExits) {
    let (scene, contacts) = (prepared.scene, &prepared.contacts);
    // The light's reflection at the surface does not depend on its polarisation, but its transmission does.
    let carried = (prepared.fresnel == FresnelModel::Polarised).then(|| Polarisation::none(ray.dir));
    let mut light = Marched {
        prepared,
        ray,
        nm,
        stack: stack.clone(),
        share: DVec3::ONE,
        unmatched: UnmatchedExits::default(),
        carried,
    };
    let marched = Ray64 { admits: GeometryMask::TRANSMISSIVE, t_max: end_of(ray), ..*ray };
    let crossings = surface::crossings(scene, &prepared.accel, &marched);
    if crossings.len() > MOST_PASSES as usize {
        return (DVec3::ZERO, UnmatchedExits::default());
    }
    let mut reached = 0.0;
    // Faces crossed together with an earlier one, and the ray parameter up to which they are skipped.
    let mut crossed: (Vec<(u32, bool)>, f64) = (Vec::new(), f64::NEG_INFINITY);
    if let Some(place) = through.and_then(|way| ContactPoint::resumed(scene, contacts, way)) {
        let (sides, apart) = place.sides(ray.dir);
        let cos = place.layer().faces()[0].outward(place.point()).dot(ray.dir).abs();
        crossed = (sides, apart / cos);
        light.cross_place(Some(place));
    }
    for crossing in crossings {
        if light.share == DVec3::ZERO {
            break;
        }
        let side = (crossing.geometry, crossing.front);
        if crossing.t <= crossed.1 && crossed.0.contains(&side) {
            continue;
        }
        light.absorb(crossing.t - reached);
        reached = crossing.t;
        let id = (crossing.geometry, crossing.primitive);
        match ContactPoint::met(scene, contacts, id, [ray.origin, ray.dir], crossing.point) {
            None => light.cross_face(crossing.geometry, crossing.outward, crossing.uv),
            Some(place) => {
                let (sides, apart) = place.sides(ray.dir);
                crossed = (sides, crossing.t + apart / (crossing.cos * ray.dir.length()));
                light.cross_place(Some(place));
            }
        }
    }
    light.absorb(ray.t_max - reached);
    (light.share, light.unmatched)
}

/// Light on its straight way from a surface to a lamp.
struct Marched<'a> {
    prepared: &'a Prepared<'a>,
    ray: &'a Ray64,
    nm: Option<f64>,
    stack: MediumStack,
    /// Share of the light that is left.
    share: DVec3,
    /// Media left without having been entered.
    unmatched: UnmatchedExits,
    carried: Option<Polarisation>,
}

impl Marched<'_> {
    /// Absorbs over a distance in the current medium.
    fn absorb(&mut self, distance: f64) {
        let medium = self.stack.top(self.prepared.filled());
        let absorption = self.prepared.scene.media[medium as usize].absorption.as_dvec3();
        self.share *= DVec3::from(transmittance(absorption.into(), distance));
    }

    /// Crosses all remaining layers of a point where surfaces touch.
    fn cross_place(&mut self, place: Option<ContactPoint>) {
        let Prepared { scene, contacts, .. } = self.prepared;
        let mut place = place;
        while let Some(here) = place {
            match here.layer() {
                Layer::Alone(face) => {
                    let uv = Surface::on_face(scene, self.ray, face, here.point(), 0.0).uv;
                    self.cross_face(face.object, face.outward(here.point()), uv);
                }
                Layer::Media(faces) => {
                    let outside = |face: &Face| here.is_outside(face, self.ray.dir);
                    let body = |object| self.prepared.bodies.of_object(object);
                    let crossed = here.crossed(faces, self.ray.dir, body);
                    let transition = self.stack.cross_all(self.prepared.filled(), &crossed);
                    let sides = match &transition {
                        Transition::Boundary { from, to, .. } => [*from, *to],
                        Transition::Passed(_) => [0, 0],
                    };
                    let face = *governing(scene, faces, sides, outside);
                    self.cross_boundary(transition, face.object, face.outward(here.point()));
                }
            }
            place = here.onward().and_then(|way| ContactPoint::resumed(scene, contacts, way));
        }
    }

    /// Crosses a boundary between media.
    fn cross_boundary(&mut self, transition: Transition, object: u32, outward: DVec3) {
        let Interface::Dielectric { rule, tint, .. } = self.prepared.material(object).interface else { return };
        match transition {
            Transition::Passed(beyond) => self.stack = beyond,
            Transition::Boundary { from, to, beyond, unmatched } => {
                let (n1, n2) = (self.prepared.ior(from, self.nm), self.prepared.ior(to, self.nm));
                let boundary = Boundary::new(n1.min(n2), n1.max(n2));
                let (cos, before) = self.at(outward);
                let Lobes { transmission, .. } =
                    at_boundary(self.prepared.fresnel, rule, &boundary, &boundary.cross(cos), before);
                self.share *= transmission.share * tint.as_dvec3();
                self.carried = transmission.polarisation;
                if unmatched {
                    self.unmatched.add(object);
                }
                self.stack = beyond;
            }
        }
    }

    /// Crosses one surface.
    fn cross_face(&mut self, object: u32, outward: DVec3, uv: DVec2) {
        let filled = self.prepared.filled();
        match self.prepared.material(object).interface {
            Interface::Dielectric { .. } => {
                let body = self.prepared.bodies.of_object(object).unwrap_or(0);
                let front = outward.dot(self.ray.dir) < 0.0;
                self.cross_boundary(self.stack.cross(filled, body, front), object, outward);
            }
            Interface::ThinDielectric { ior, rule, tint } => {
                let boundary = Boundary::new(self.prepared.ior(self.stack.top(filled), self.nm), f64::from(ior));
                let (cos, before) = self.at(outward);
                let Lobes { transmission, .. } =
                    at_pane(self.prepared.fresnel, rule, &boundary, &boundary.cross(cos), before);
                self.share *= transmission.share * tint.as_dvec3();
                self.carried = transmission.polarisation;
            }
            ref cover @ Interface::Alpha { .. } => self.share *= 1.0 - colour::opacity(self.prepared.scene, cover, uv),
            // Opaque surfaces only arrive here with a wrong geometry mask. They block the light.
            Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => {
                self.share = DVec3::ZERO;
            }
        }
    }

    /// Returns the cosine at a surface of unit normal `outward`, and the polarisation in its frame.
    fn at(&self, outward: DVec3) -> (f64, Option<Polarisation>) {
        let cos = outward.dot(self.ray.dir).abs() / self.ray.dir.length();
        (cos, self.carried.map(|carried| carried.facing(self.ray.dir, outward)))
    }
}
