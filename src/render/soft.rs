//! The light stages of lamps with an extent: many points, each of which shines as a lamp of its own.
//!
//! Where the settings say so, a few shadow rays are asked first, and most of the others are left out where these agree:
//! rays to four corners around the lamp, which decide on anything with one straight edge, and to the first four of its
//! points, one in each quarter, against what is smaller. Only the latter count for the picture. What is asked of a place
//! depends on that place alone, so that no grouping of rays makes a difference.

use super::base::Base8;
use super::extent::{Ball, Extent, Seen, Sheet};
use super::light::lobe;
use super::pattern::{LampPoints, Scramble};
use super::queue::{Queue, Rgb8, Spawn8};
use super::shading::Shading;
use super::surface::Surface8;
use crate::math::{Real, Vector3};
use crate::scene::{Falloff, LampSampling, Light, LightKind, Rgb, Spread};
use crate::simd::{F32x8, Vec3x8};

/// Points of a lamp whose shadow rays go first.
const PROBES: u32 = 4;

/// Corners around a lamp that are looked at besides.
const CORNERS: u32 = 4;

/// Shadow rays that one call of a stage may queue, so that memory does not grow with the number of points.
const MOST_QUEUED: usize = 1 << 14;

/// What the lamp of this number in the scene does to surfaces with these bases, met by rays of the depth given.
pub type SoftStage = fn(&mut Shading, usize, &[Surface8], &[Base8], usize);

/// The stages of a lamp with an extent.
#[derive(Clone, Copy, Debug)]
pub struct SoftStages {
    /// Whether it casts shadows.
    pub shadows: bool,
    /// Adds its light where it casts none.
    pub open: SoftStage,
    /// Queues its shadow rays; where some go first, only those.
    pub ask: SoftStage,
    /// Once they have been traced: settles the rest of its points, also of places that none of the first ones left.
    pub settle: SoftStage,
    /// Surfaces that are to go through both at a time.
    pub surfaces: usize,
}

/// Shadow rays that go first, and what came of them.
#[derive(Debug, Default)]
pub struct Probes {
    /// The rays, with the light that they bring if nothing is in the way as their weight.
    pub queue: Queue,
    /// By ray: the place it answers for, and whether its light counts.
    pub askers: Vec<Asker>,
    /// By place, eight to a surface.
    pub verdicts: Vec<Verdict>,
}

/// Whom a shadow ray answers.
#[derive(Clone, Copy, Debug)]
pub struct Asker {
    /// Its place in [`Probes::verdicts`].
    pub place: u32,
    /// Whether its light is part of the picture.
    pub counts: bool,
}

/// What the shadow rays of a place found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdict(u8);

impl Verdict {
    const CLEAR: Self = Self(1);
    const BLOCKED: Self = Self(2);
    const WEAKENED: Self = Self(4);

    /// Adds what a ray found: whether its light arrives, and whether as strong as it set out.
    pub fn add(&mut self, arrives: bool, whole: bool) {
        self.0 |= match (arrives, whole) {
            (false, _) => Self::BLOCKED.0,
            (true, true) => Self::CLEAR.0,
            (true, false) => Self::WEAKENED.0,
        };
    }
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
    let [open, ask, settle]: [SoftStage; 3] = match (light.falloff == Falloff::InverseSquare, shiny) {
        (false, false) => [open::<L, false, false>, ask::<L, false, false>, settle::<L, false, false>],
        (false, true) => [open::<L, false, true>, ask::<L, false, true>, settle::<L, false, true>],
        (true, false) => [open::<L, true, false>, ask::<L, true, false>, settle::<L, true, false>],
        (true, true) => [open::<L, true, true>, ask::<L, true, true>, settle::<L, true, true>],
    };
    let surfaces = (MOST_QUEUED / 8 / sampling.count.max(1) as usize).max(1);
    SoftStages { shadows: light.shadows, open, ask, settle, surfaces }
}

/// Whether some of a lamp's shadow rays go first: not where there is too little to be left out for what asking costs.
pub fn probing(shading: &Shading) -> bool {
    shading.scene.settings.lamps.probe && shading.points.count() > PROBES + CORNERS
}

/// A kind of lamp.
trait Lamp: Extent<F32x8> + Sized + 'static {
    /// The light, where it is of this kind.
    fn of(light: &Light) -> Option<Self>;
}

impl Lamp for Ball<F32x8> {
    fn of(light: &Light) -> Option<Self> {
        let LightKind::Sphere { position, radius } = light.kind else { return None };
        Some(Self { centre: Vec3x8::splat(position), radius: F32x8::from(radius) })
    }
}

impl Lamp for Sheet<F32x8> {
    fn of(light: &Light) -> Option<Self> {
        let LightKind::Rectangle { corner, edges, spread } = light.kind else { return None };
        let across = || edges[0].as_dvec3().cross(edges[1].as_dvec3()).normalize().as_vec3();
        let normal = (spread == Spread::Cosine).then(|| Vec3x8::splat(across()));
        Some(Self { corner: Vec3x8::splat(corner), edges: edges.map(Vec3x8::splat), normal })
    }
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
            passes: &[0; 8],
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
    let Some(lamp) = L::of(&shading.scene.lights[number]) else { return };
    let count = shading.points.count();
    let probing = probing(shading);
    shading.probes.verdicts.clear();
    shading.probes.verdicts.resize(surfaces.len() * 8, Verdict::default());
    for (place, (surface, base)) in surfaces.iter().zip(bases).enumerate() {
        if !base.lit {
            continue;
        }
        let shine = Shine::new(shading, (number, &lamp), surface, base, depth);
        let mut asking = 0;
        for i in 0..if probing { PROBES } else { count } {
            let sent = shine.point::<PHYSICAL, SHINY>(&shading.points, i);
            let new = shine.ray(shading, &sent);
            if probing {
                shading.probes.push8(sent.lanes, &new, place, true);
            } else {
                shading.shadows.push8(sent.lanes, &new);
            }
            asking |= sent.lanes;
        }
        if !probing || asking == 0 {
            continue;
        }
        for corner in 0..CORNERS as usize {
            let Seen { dir, distance, .. } = lamp.corner(shine.origin, corner);
            let lanes = asking & shine.facing(dir);
            let sent = Sent { dir, distance, light: Vec3x8::splat(Rgb::ONE), lanes };
            let new = shine.ray(shading, &sent);
            shading.probes.push8(lanes, &new, place, false);
        }
    }
}

fn settle<L: Lamp, const PHYSICAL: bool, const SHINY: bool>(
    shading: &mut Shading,
    number: usize,
    surfaces: &[Surface8],
    bases: &[Base8],
    depth: usize,
) {
    let Some(lamp) = L::of(&shading.scene.lights[number]) else { return };
    for (k, (surface, base)) in surfaces.iter().zip(bases).enumerate() {
        if !base.lit {
            continue;
        }
        let verdicts = &shading.probes.verdicts[k * 8..k * 8 + 8];
        let of = |verdict: Verdict| super::split::lane_bits(|lane| verdicts[lane] == verdict);
        let (clear, blocked) = (of(Verdict::CLEAR), of(Verdict::BLOCKED));
        if surface.base_lanes & !blocked == 0 {
            continue;
        }
        let shine = Shine::new(shading, (number, &lamp), surface, base, depth);
        for i in PROBES..shading.points.count() {
            let sent = shine.point::<PHYSICAL, SHINY>(&shading.points, i);
            shading.accumulator.add_light8(sent.lanes & clear, &surface.pixel, &sent.light);
            let new = shine.ray(shading, &sent);
            // Penumbras seldom take up all eight lanes.
            shading.shadows.push_in_order(sent.lanes & !clear & !blocked, &new);
        }
    }
}

impl Probes {
    fn push8(&mut self, lanes: u8, new: &Spawn8, surface: usize, counts: bool) {
        self.queue.push_in_order(lanes, new);
        let asker = |lane| Asker { place: (surface * 8 + lane) as u32, counts };
        self.askers.extend(super::accumulate::set_lanes(lanes).map(asker));
    }
}
