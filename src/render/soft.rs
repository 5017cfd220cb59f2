//! The light stages of lamps with an extent: many points, each of which shines as a lamp of its own.
//!
//! If the settings say so, each place first looks through the shaft between it and the lamp ([`Shafts`]). Where that is
//! proven empty, all points shine on it without a shadow ray; where one surface is proven to cover the lamp, none does.
//! All points get their shadow rays elsewhere. So the picture is that of all shadow rays, whatever the grouping of rays.

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

/// Points of a lamp that cost less than looking through a shaft.
const TOO_FEW: u32 = 4;

/// Shadow rays that one call of a stage may queue, so that memory does not grow with the number of points.
const MOST_QUEUED: usize = 1 << 14;

/// Function that adds the light of one lamp, by its index in the scene, to surfaces with these bases, met by rays of the
/// depth given.
pub type SoftStage = fn(&mut Shading, usize, &[Surface8], &[Base8], usize);

/// The stages of a lamp with an extent.
#[derive(Clone, Copy, Debug)]
pub struct SoftStages {
    /// Whether it casts shadows.
    pub shadows: bool,
    /// Adds its light where it casts none.
    pub open: SoftStage,
    /// Adds the light of its points that no shadow ray is needed for, and queues the shadow rays of the others.
    pub ask: SoftStage,
    /// Surfaces that are to go through it at a time.
    pub surfaces: usize,
}

/// The stages for a lamp with an extent on surfaces some of which have highlights (`shiny`); none for other lights.
#[must_use]
pub fn pick(light: &Light, shiny: bool, sampling: &LampSampling) -> Option<SoftStages> {
    match light.kind {
        LightKind::Sphere { .. } => Some(pick_for::<Ball<F32x8>>(light, shiny, sampling)),
        LightKind::Rectangle { .. } => Some(pick_for::<Sheet<F32x8>>(light, shiny, sampling)),
        LightKind::Point { .. } | LightKind::Spot { .. } | LightKind::Directional { .. } => None,
    }
}

fn pick_for<L: Lamp>(light: &Light, shiny: bool, sampling: &LampSampling) -> SoftStages {
    let [open, ask]: [SoftStage; 2] = match (light.falloff == Falloff::InverseSquare, shiny) {
        (false, false) => [open::<L, false, false>, ask::<L, false, false>],
        (false, true) => [open::<L, false, true>, ask::<L, false, true>],
        (true, false) => [open::<L, true, false>, ask::<L, true, false>],
        (true, true) => [open::<L, true, true>, ask::<L, true, true>],
    };
    let surfaces = (MOST_QUEUED / 8 / sampling.count.max(1) as usize).max(1);
    SoftStages { shadows: light.shadows, open, ask, surfaces }
}

/// Returns true if some lamp's shadow rays can be spared by looking through shafts, and the settings ask for it.
#[must_use]
pub fn looks_through_shafts(scene: &Scene) -> bool {
    let lamps = &scene.settings.lamps;
    let casts = |light: &Light| light.shadows && light.kind.is_extended();
    lamps.probe && lamps.count > TOO_FEW && scene.lights.iter().any(casts)
}

/// The view of a lamp from a place.
enum View {
    /// It does not shine there.
    Dark,
    /// Between them is a shaft.
    Through(Shaft),
    /// Rounding leaves open where between them is.
    Unclear,
}

/// A kind of lamp.
trait Lamp: Extent<F32x8> + Sized + 'static {
    /// The light, where it is of this kind.
    fn of(light: &Light) -> Option<Self>;

    /// The end of the shaft to a light of this kind, from a place. None where the place is within it or beside it.
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
            // Rays end on the near side; its rim is the farthest of that.
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

/// One lamp and the places of eight lanes that it shines on.
struct Shine<'a, L> {
    lamp: &'a L,
    /// Of one point.
    intensity: Rgb8,
    surface: &'a Surface8,
    base: &'a Base8,
    origin: Vec3x8,
    scrambles: [Scramble; 8],
    sample: u32,
}

/// What one point of a lamp sends to eight places.
struct Sent {
    dir: Vec3x8,
    distance: F32x8,
    light: Rgb8,
    /// Lanes that it reaches, were nothing in the way.
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

    /// Lanes on whose lit side, by both normals, a direction lies.
    fn facing(&self, dir: Vec3x8) -> u8 {
        let facing = dir.dot(self.surface.shading).gt(F32x8::ZERO) & dir.dot(self.surface.normal).gt(F32x8::ZERO);
        facing.bits() & self.surface.base_lanes
    }

    /// The view of the lamp from one lane's place.
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

    /// Lanes that the whole lamp shines on with nothing in between, and lanes that need a shadow ray for each point.
    fn sorted(&self, shading: &Shading, light: &Light, shafts: &Shafts) -> (u8, u8) {
        let (mut clear, mut traced) = (0, 0);
        for lane in set_lanes(self.surface.base_lanes) {
            // Layers of a place where surfaces touch are crossed by rays alone.
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
        Spawn8 {
            origin: self.origin,
            dir: sent.dir,
            t_max: sent.distance,
            admits: shading.shadow_admits,
            weight: sent.light,
            pixel: &self.surface.pixel,
            stack: &self.surface.stack,
            lead: self.surface.lead(sent.dir),
            passes: &self.surface.returning,
            place: self.surface.place,
            extra: None,
        }
    }
}

fn open<L: Lamp, const PHYSICAL: bool, const SHINY: bool>(
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

fn ask<L: Lamp, const PHYSICAL: bool, const SHINY: bool>(
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
