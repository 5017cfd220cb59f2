//! Light stages for area lamps: many sample points, each of which shines like a lamp of its own.
//!
//! If the settings ask for it, each shaded point first tests the shaft between it and the lamp ([`Shafts`]). If the
//! shaft is proven empty, all samples are lit without shadow rays. If one surface is proven to cover the lamp, no
//! sample is lit. Otherwise every sample gets its shadow ray. So the picture equals that of all shadow rays, for any
//! grouping of rays.

use super::base::Base8;
use super::extent::{Ball, Extent, Seen, Sheet};
use super::light::lobe;
use super::pattern::{LampPoints, Scramble};
use super::queue::{Rgb8, Spawn8};
use super::shading::Shading;
use super::surface::Surface8;
use crate::accel::Shafts;
use crate::geometry::{Content, Shaft, ShaftEnd};
use crate::math::{Real, Vector3};
use crate::scene::{Falloff, LampSampling, Light, LightKind, Scene, Spread};
use crate::simd::{F32x8, Vec3x8, set_lanes};

/// Number of samples up to which shadow rays cost less than testing a shaft.
const TOO_FEW: u32 = 4;

/// Largest number of shadow rays queued by one call of a stage, so that memory does not grow with the number of
/// samples.
const MOST_QUEUED: usize = 1 << 14;

/// Function that adds the light of the lamp with the given scene index to surfaces with these bases. The last argument
/// is the depth of the rays that hit them.
pub type SoftStage = fn(&mut Shading, usize, &[Surface8], &[Base8], usize);

/// Stages of one area lamp.
#[derive(Clone, Copy, Debug)]
pub struct SoftStages {
    /// True if the lamp casts shadows.
    pub shadows: bool,
    /// Adds the lamp's light without testing for shadows.
    pub unoccluded: SoftStage,
    /// Adds the light of samples that need no shadow ray, and queues shadow rays for the others.
    pub shadowed: SoftStage,
    /// Number of surface packets per call.
    pub surfaces: usize,
}

/// Picks the stages of an area lamp; `shiny` says that some surfaces have highlights. Returns `None` for other lights.
#[must_use]
pub fn pick(light: &Light, shiny: bool, sampling: &LampSampling) -> Option<SoftStages> {
    match light.kind {
        LightKind::Sphere { .. } => Some(pick_for::<Ball<F32x8>>(light, shiny, sampling)),
        LightKind::Rectangle { .. } => Some(pick_for::<Sheet<F32x8>>(light, shiny, sampling)),
        LightKind::Point { .. } | LightKind::Spot { .. } | LightKind::Directional { .. } => None,
    }
}

fn pick_for<L: Lamp>(light: &Light, shiny: bool, sampling: &LampSampling) -> SoftStages {
    let [unoccluded, shadowed]: [SoftStage; 2] = match (light.falloff == Falloff::InverseSquare, shiny) {
        (false, false) => [unoccluded::<L, false, false>, shadowed::<L, false, false>],
        (false, true) => [unoccluded::<L, false, true>, shadowed::<L, false, true>],
        (true, false) => [unoccluded::<L, true, false>, shadowed::<L, true, false>],
        (true, true) => [unoccluded::<L, true, true>, shadowed::<L, true, true>],
    };
    SoftStages { shadows: light.shadows, unoccluded, shadowed, surfaces: surfaces_at_once(sampling) }
}

/// Returns the number of packets of surfaces that a soft stage works on at once, so that its shadow rays stay few enough.
pub(super) fn surfaces_at_once(sampling: &LampSampling) -> usize {
    (MOST_QUEUED / 8 / sampling.count.max(1) as usize).max(1)
}

/// Returns true if shaft tests can save shadow rays in this scene and the settings ask for them.
#[must_use]
pub fn looks_through_shafts(scene: &Scene) -> bool {
    let lamps = &scene.settings.lamps;
    let casts = |light: &Light| light.shadows && light.kind.is_extended();
    lamps.probe && lamps.count > TOO_FEW && scene.lights.iter().any(casts)
}

/// View of a lamp from a shaded point.
enum View {
    /// The lamp is below the horizon of the surface.
    Dark,
    /// The lamp can be seen through a shaft.
    Through(Shaft),
    /// Rounding leaves the shaft undetermined.
    Unclear,
}

/// Kind of area lamp.
trait Lamp: Extent<F32x8> + Sized + 'static {
    /// Returns the lamp if the light is of this kind.
    fn of(light: &Light) -> Option<Self>;

    /// Returns the lamp's end of the shaft from a point. `None` if the point is inside the lamp or too close to it.
    fn end(light: &Light, from: Vector3<f32>) -> Option<ShaftEnd>;
}

impl Lamp for Ball<F32x8> {
    fn of(light: &Light) -> Option<Self> {
        let LightKind::Sphere { position, radius } = light.kind else { return None };
        Some(Self { centre: Vec3x8::splat(position), radius: F32x8::from(radius) })
    }

    fn end(light: &Light, from: Vector3<f32>) -> Option<ShaftEnd> {
        let LightKind::Sphere { position, radius } = light.kind else { return None };
        let ball = Ball { centre: Vector3::from(position), radius };
        let way: glam::Vec3 = (ball.centre - from).into();
        let distance = way.length();
        (distance > 1.001 * radius).then(|| ShaftEnd {
            corners: ball.corners(from).map(Into::into),
            across: way / distance,
            // Rays end on the near side of the ball, whose farthest part is its rim.
            end: distance - radius * radius / distance,
            stop: 1.0 - radius / distance,
            body: Some((way, radius)),
        })
    }
}

impl Lamp for Sheet<F32x8> {
    fn of(light: &Light) -> Option<Self> {
        let LightKind::Rectangle { corner, edges, spread } = light.kind else { return None };
        let normal = (spread == Spread::Cosine).then(|| Vec3x8::splat(normal_of(edges)));
        Some(Self { corner: Vec3x8::splat(corner), edges: edges.map(Vec3x8::splat), normal })
    }

    fn end(light: &Light, from: Vector3<f32>) -> Option<ShaftEnd> {
        let LightKind::Rectangle { corner, edges, .. } = light.kind else { return None };
        let sheet = Sheet { corner: Vector3::from(corner), edges: edges.map(Vector3::from), normal: None };
        let corners = sheet.corners(from).map(Into::into);
        let across = normal_of(edges);
        let away = (corner - glam::Vec3::from(from)).dot(across);
        let across = if away < 0.0 { -across } else { across };
        Some(ShaftEnd { corners, across, end: away.abs(), stop: 1.0, body: None })
    }
}

fn normal_of([u, v]: [glam::Vec3; 2]) -> glam::Vec3 {
    u.as_dvec3().cross(v.as_dvec3()).normalize().as_vec3()
}

/// One lamp and the points of eight lanes that it may light.
struct Shine<'a, L> {
    lamp: &'a L,
    /// Intensity of one sample.
    intensity: Rgb8,
    surface: &'a Surface8,
    base: &'a Base8,
    origin: Vec3x8,
    scrambles: [Scramble; 8],
    sample: u32,
}

/// Light of one lamp sample at eight shaded points.
struct Sent {
    dir: Vec3x8,
    distance: F32x8,
    light: Rgb8,
    /// Lanes that it reaches if unoccluded.
    lanes: u8,
}

impl<'a, L: Lamp> Shine<'a, L> {
    fn new(
        shading: &Shading,
        (number, lamp): (usize, &'a L),
        surface: &'a Surface8,
        base: &'a Base8,
        depth: usize,
    ) -> Self {
        let points = &shading.points;
        let light = &shading.scene.lights[number];
        let scrambles = surface.pixel.map(|p| points.scramble(shading.film_pixel(p), depth as u32, number as u32));
        let share = 1.0 / f64::from(points.count());
        let intensity = Vec3x8::splat(light.intensity) * F32x8::splat(share);
        let origin = surface.above();
        Self { lamp, intensity, surface, base, origin, scrambles, sample: shading.sample }
    }

    /// Returns the lanes in which a direction lies on the lit side of both normals.
    fn facing(&self, dir: Vec3x8) -> u8 {
        let facing = dir.dot(self.surface.shading).gt(F32x8::ZERO) & dir.dot(self.surface.normal).gt(F32x8::ZERO);
        facing.bits() & self.surface.base_lanes
    }

    /// Returns the view of the lamp from one lane's point.
    fn view(&self, light: &Light, lane: usize) -> View {
        let from = self.origin.lane(lane);
        let normal = self.surface.normal.lane(lane);
        let shaft = L::end(light, from.into()).and_then(|end| Shaft::new(from, normal, &end));
        match shaft {
            Some(shaft) if shaft.is_below(normal) || shaft.is_below(self.surface.shading.lane(lane)) => View::Dark,
            Some(shaft) => View::Through(shaft),
            None => View::Unclear,
        }
    }

    /// Returns the lanes that the whole lamp lights unoccluded, and the lanes that need a shadow ray per sample.
    fn sorted(&self, shading: &Shading, light: &Light, shafts: &Shafts) -> (u8, u8) {
        let (mut clear, mut traced) = (0, 0);
        for lane in set_lanes(self.surface.base_lanes) {
            // Where surfaces touch, only rays can cross the layers.
            let layered = self.surface.returning[lane] != 0;
            let content = match self.view(light, lane) {
                View::Dark => continue,
                View::Through(_) if layered => Content::Mixed,
                View::Through(shaft) => shafts.content(&shaft, shading.shadow_admits),
                View::Unclear => Content::Mixed,
            };
            let absorbs = shading.media.absorption(self.surface.stack[lane]).is_some();
            match content {
                Content::Covered => {}
                Content::Empty if !absorbs => clear |= 1 << lane,
                Content::Empty | Content::Mixed => traced |= 1 << lane,
            }
        }
        (clear, traced)
    }

    #[inline(always)]
    fn point<const PHYSICAL: bool, const SHINY: bool>(&self, points: &LampPoints, i: u32) -> Sent {
        let at = points.points8(&self.scrambles, self.sample, i);
        let Seen { dir, distance, share } = self.lamp.point::<PHYSICAL>(self.origin, at);
        let lanes = self.facing(dir) & share.gt(F32x8::ZERO).bits();
        let cos = dir.dot(self.surface.shading);
        let lambert = if PHYSICAL { cos * F32x8::splat(std::f64::consts::FRAC_1_PI) } else { cos };
        let mut sent = self.base.diffuse * lambert;
        if SHINY {
            let bright = sent + self.base.highlight * lobe(self.base, self.surface, dir);
            sent = Vec3x8::select(self.base.shiny, bright, sent);
        }
        let light = sent.times(self.intensity * share).times(self.surface.base_weight);
        let zero = Vector3::new(light.x.eq(F32x8::ZERO), light.y.eq(F32x8::ZERO), light.z.eq(F32x8::ZERO));
        Sent { dir, distance, light, lanes: lanes & !(zero.x & zero.y & zero.z).bits() }
    }

    fn ray<'b>(&'b self, shading: &Shading, sent: &Sent) -> Spawn8<'b> {
        let (origin, t_max, admits) = (self.origin, sent.distance, shading.shadow_admits);
        Spawn8 { origin, t_max, admits, ..self.surface.reflected(sent.dir, sent.light) }
    }
}

fn unoccluded<L: Lamp, const PHYSICAL: bool, const SHINY: bool>(
    shading: &mut Shading,
    number: usize,
    surfaces: &[Surface8],
    bases: &[Base8],
    depth: usize,
) {
    let Some(lamp) = L::of(&shading.scene.lights[number]) else { return };
    for (surface, base) in surfaces.iter().zip(bases).filter(|(_, base)| base.lit) {
        let shine = Shine::new(shading, (number, &lamp), surface, base, depth);
        for i in 0..shading.points.count() {
            let sent = shine.point::<PHYSICAL, SHINY>(&shading.points, i);
            shading.accumulator.add_light8(sent.lanes, &surface.pixel, &sent.light);
        }
    }
}

fn shadowed<L: Lamp, const PHYSICAL: bool, const SHINY: bool>(
    shading: &mut Shading,
    number: usize,
    surfaces: &[Surface8],
    bases: &[Base8],
    depth: usize,
) {
    let light = &shading.scene.lights[number];
    let Some(lamp) = L::of(light) else { return };
    for (surface, base) in surfaces.iter().zip(bases).filter(|(_, base)| base.lit) {
        let shine = Shine::new(shading, (number, &lamp), surface, base, depth);
        let (clear, traced) = match shading.shafts {
            Some(shafts) => shine.sorted(shading, light, shafts),
            None => (0, u8::MAX),
        };
        if clear | traced == 0 {
            continue;
        }
        for i in 0..shading.points.count() {
            let sent = shine.point::<PHYSICAL, SHINY>(&shading.points, i);
            shading.accumulator.add_light8(sent.lanes & clear, &surface.pixel, &sent.light);
            let lanes = sent.lanes & traced;
            if lanes == 0 {
                continue;
            }
            let new = shine.ray(shading, &sent);
            if shading.shafts.is_none() {
                shading.shadows.push8(lanes, &new);
            } else {
                // Penumbras seldom take up all eight lanes.
                shading.shadows.push_in_order(lanes, &new);
            }
        }
    }
}
