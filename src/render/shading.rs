//! Shading state of one thread, shared by its stages: the scene, the pixel sums and the ray queues. Independent of the
//! accelerator.

use super::accumulate::Accumulator;
use super::bodies::Bodies8;
use super::budget::divide;
use super::ceiling::Ceiling;
use super::extra::Extra8;
use super::images::VirtualRays;
use super::limit::Limit;
use super::media::{MediaTable, StackId, Transition};
use super::options::Options;
use super::outcome::{RayCounts, RayKind, StreamCounts};
use super::passes::Passes;
use super::pattern::LampPoints;
use super::queue::{Chunk, Queue, Rgb8, Spawn8};
use super::shine::Shine;
use super::split::mirrored::{self, ReflectStage};
use super::stages::Stages;
use super::surface::{HitRef, Surface8};
use super::tile::Tile;
use super::touch::{Arrivals, Touching};
use super::unmatched::UnmatchedExits;
use crate::accel::Shafts;
use crate::accel::native::Scratch;
use crate::effects::{Effect, Pipeline};
use crate::geometry::GeometryMask;
use crate::geometry::contact::Contacts;
use crate::math::Real;
use crate::optics::{RefractionModel, Spectrum, transmittance};
use crate::scene::{Bodies, Interface, Medium, Rgb, Scene};
use crate::simd::{F32x8, Mask8, Vec3x8, set_lanes};
use crate::systems::maps::{Maps, Proxy};
use crate::systems::planar::Mirrors;

/// Factor that makes up for rounding tolls down to `f32`.
const ROUNDED_UP: f32 = 1.0 + 1e-6;

/// Secondary rays held back until budgets decide which of them end.
#[derive(Clone, Debug)]
struct HeldRays {
    lanes: u8,
    kind: RayKind,
    origin: Vec3x8,
    dir: Vec3x8,
    weight: Rgb8,
    pixel: [u32; 8],
    stack: [StackId; 8],
    lead: F32x8,
    passes: [u32; 8],
    place: u32,
    extra: Extra8,
}

/// State that stages read and write, reused from tile to tile.
#[derive(Debug)]
pub struct Shading<'a> {
    pub scene: &'a Scene,
    pub media: MediaTable<'a>,
    /// Touching surfaces, and the rays between their layers.
    pub touching: Touching<'a>,
    /// Arrivals of the chunk's rays and of their shadow rays where surfaces touch.
    pub arrivals: Arrivals,
    pub shadow_arrivals: Arrivals,
    /// Formula for the direction of refracted light, with its constant.
    pub refraction: RefractionModel,
    /// Stage for reflected light.
    pub reflect: ReflectStage,
    /// Classes of geometry that block a shadow ray.
    pub shadow_admits: GeometryMask,
    /// Largest number of reflections and refractions along a path.
    pub max_depth: usize,
    /// Throughput below which rays end.
    pub cutoff: f32,
    /// True if rays carry extras.
    pub carries: bool,
    /// Extras of the rays that hit the current stream's surfaces, by packet. Empty if rays carry none.
    pub extras: Vec<Extra8>,
    /// Upper bounds on the tolls of rays of weight 1, if budgets decide which rays end.
    pub tolls: Option<&'a Ceiling>,
    /// Rays of the current stream that [`Self::settle`] has yet to decide on.
    held: Vec<HeldRays>,
    pub accumulator: Accumulator,
    pub counts: RayCounts,
    pub unmatched_exits: UnmatchedExits,
    pub streams: StreamCounts,
    /// True if light ends where it would be totally reflected.
    pub total_is_lost: bool,
    /// Queues by depth; reflected and transmitted rays are kept apart because their directions differ.
    queues: Vec<[Queue; 2]>,
    pub shadows: Queue,
    /// Sample points on area lamps.
    pub points: LampPoints,
    /// Finder of occluders between a point and a lamp. `None` if all samples of lamps get shadow rays.
    pub shafts: Option<&'a Shafts<'a>>,
    /// Sources beside lamps that light surfaces.
    pub shine: Option<&'a Shine>,
    /// Cameras mirrored in planar mirrors, and the rays that they still have to trace. Empty if none are requested.
    pub passes: Passes<'a>,
    /// Maps that reflectors show, the stand-in for their surroundings, and reflections that were traced instead.
    pub maps: Option<&'a Maps>,
    /// Planes that raise what lies behind them, if any are asked for.
    pub flats: Option<&'a Mirrors>,
    /// Rays of the eye that go on in virtual scenes; empty if none are requested.
    pub(super) virtual_rays: VirtualRays<'a>,
    pub proxy: Proxy,
    pub without_map: u64,
    /// Maps of bodies that refracted light is looked up in, if any are asked for, and rays that were traced instead.
    pub(super) bodies: Option<&'a Bodies8>,
    pub without_body_map: u64,
    /// Scratch of the hierarchies over virtual scenes and bodies, once one of them is traced.
    pub(super) own_scratch: Option<Scratch>,
    /// Current tile, and index of the current camera ray within its pixel.
    pub tile: Tile,
    pub sample: u32,
}

impl<'a> Shading<'a> {
    /// Creates the state with nothing summed and nothing queued.
    pub fn new(
        scene: &'a Scene,
        bodies: &'a Bodies,
        contacts: &'a Contacts,
        options: &Options,
        stages: &Stages,
        tolls: Option<&'a Ceiling>,
    ) -> Self {
        let settings = &scene.settings;
        let media = if disperses(scene, options) {
            MediaTable::dispersing(&scene.media, bodies, Spectrum::new(settings.wavelengths, settings.samples))
        } else {
            MediaTable::new(&scene.media, bodies)
        };
        Self {
            scene,
            media,
            touching: Touching::new(contacts),
            arrivals: Arrivals::default(),
            shadow_arrivals: Arrivals::default(),
            refraction: stages.refraction,
            reflect: mirrored::pick(options.reflection, scene),
            shadow_admits: stages.shadow_admits,
            carries: stages.carries,
            extras: Vec::new(),
            tolls,
            held: Vec::new(),
            max_depth: scene.settings.max_depth as usize,
            cutoff: scene.settings.cutoff,
            accumulator: Accumulator::default(),
            counts: RayCounts::default(),
            unmatched_exits: UnmatchedExits::default(),
            streams: StreamCounts::default(),
            total_is_lost: options.effects.without.has(Effect::TotalInternalReflection),
            queues: Vec::new(),
            shadows: Queue::new(stages.carries),
            points: LampPoints::new(&scene.settings.lamps),
            shafts: None,
            shine: None,
            passes: Passes::default(),
            maps: None,
            flats: None,
            virtual_rays: VirtualRays::default(),
            proxy: options.proxy,
            without_map: 0,
            bodies: None,
            without_body_map: 0,
            own_scratch: None,
            tile: Tile { x: 0, y: 0, width: 1, height: 1 },
            sample: 0,
        }
    }

    /// Returns the column and row, in the picture, of a pixel of the tile.
    #[inline]
    pub fn film_pixel(&self, pixel: u32) -> [u32; 2] {
        [self.tile.x + pixel % self.tile.width, self.tile.y + pixel / self.tile.width]
    }

    /// Returns the queue for rays of one kind at one depth.
    pub fn queue(&mut self, kind: RayKind, depth: usize) -> &mut Queue {
        if self.queues.len() <= depth {
            let carries = self.carries;
            self.queues.resize_with(depth + 1, || [Queue::new(carries), Queue::new(carries)]);
        }
        &mut self.queues[depth][usize::from(kind == RayKind::Transmitted)]
    }

    /// Returns the deepest queue with at least `enough` rays for a long stream. If there is none, returns the
    /// shallowest non-empty queue, whose children join the rays that wait below. So no queue holds more than the
    /// children of two streams.
    pub fn next_queue(&self, enough: usize) -> Option<(usize, RayKind)> {
        self.full_queue(enough).or_else(|| {
            let any = self.longer().find(|&(.., rays)| rays > 0);
            any.map(|(depth, kind, _)| (depth, kind))
        })
    }

    /// The deepest queue that holds `enough` rays for a long stream.
    pub fn full_queue(&self, enough: usize) -> Option<(usize, RayKind)> {
        self.longer().rev().find(|&(.., rays)| rays >= enough).map(|(depth, kind, _)| (depth, kind))
    }

    /// By depth, the longer of both queues and its length.
    fn longer(&self) -> impl DoubleEndedIterator<Item = (usize, RayKind, usize)> {
        self.queues.iter().enumerate().map(|(depth, [reflected, transmitted])| {
            if transmitted.len() > reflected.len() {
                (depth, RayKind::Transmitted, transmitted.len())
            } else {
                (depth, RayKind::Reflected, reflected.len())
            }
        })
    }

    /// Queues the secondary rays of a hit at `depth`, except for those that the depth limit or the cut-off ends.
    pub fn spawn(&mut self, lanes: u8, new: &Spawn8, kind: RayKind, depth: usize) {
        if self.tolls.is_some() {
            return self.hold(lanes, new, kind);
        }
        let lasting = self.lasting(lanes, &new.weight, new.pixel, depth);
        if lasting != 0 {
            self.queue(kind, depth + 1).push8(lasting, new);
        }
    }

    /// Returns the lanes of secondary rays of a hit at `depth` that neither the depth limit nor the cut-off ends. The
    /// weight of the others is counted as truncated.
    #[inline(always)]
    pub fn lasting(&mut self, lanes: u8, weight: &Rgb8, pixel: &[u32; 8], depth: usize) -> u8 {
        // The rays of a single wavelength can have negative channels.
        let heaviest = weight.abs().max_component();
        let carrying = lanes & !heaviest.eq(F32x8::ZERO).bits();
        if depth >= self.max_depth {
            self.accumulator.add_ended8(Limit::Depth, carrying, pixel, weight);
            return 0;
        }
        // A NaN weight compares false. The ray continues and is counted where its contribution is added.
        let light = heaviest.lt(F32x8::from(self.cutoff)).bits();
        let ended = carrying & light;
        self.accumulator.add_cut8(ended, pixel, weight);
        carrying & !ended
    }

    /// Holds rays back until all secondary rays of their surface are known.
    #[cold]
    fn hold(&mut self, lanes: u8, new: &Spawn8, kind: RayKind) {
        let carrying = lanes & !new.weight.max_component().eq(F32x8::ZERO).bits();
        self.held.push(HeldRays {
            lanes: carrying,
            kind,
            origin: new.origin,
            dir: new.dir,
            weight: new.weight,
            pixel: *new.pixel,
            stack: *new.stack,
            lead: new.lead,
            passes: *new.passes,
            place: new.place,
            extra: new.extra.copied().unwrap_or(self.extras[new.place as usize]),
        });
    }

    /// Divides the budgets of the rays of depth `depth` that hit the current stream's surfaces, and queues the rays
    /// that the budgets do not cut.
    pub fn settle(&mut self, depth: usize) {
        let Some(tolls) = self.tolls else { return };
        let toll = Vec3x8::splat(tolls.at(depth + 1).as_vec3() * ROUNDED_UP);
        let too_deep = depth >= self.max_depth;
        let held = std::mem::take(&mut self.held);
        for family in held.chunk_by(|a, b| a.place == b.place) {
            let costs = |ray: &HeldRays| {
                let zero = Vec3x8::splat(Rgb::ZERO);
                Vec3x8::select(Mask8::from_bits(ray.lanes), ray.weight.times(toll), zero)
            };
            let mut budget = self.extras[family[0].place as usize].budget();
            // Lanes in which the budget pays for all remaining rays.
            let mut paid = 0_u8;
            for (k, ray) in family.iter().enumerate() {
                let rest = family[k + 1..].iter().fold(Vec3x8::splat(Rgb::ZERO), |sum, other| sum + costs(other));
                let division = divide(budget, [costs(ray), rest]);
                let cut = division.cut[0].bits() | paid;
                paid |= division.cut[1].bits();
                budget = division.budget[1];
                let (limit, ended) = if too_deep { (Limit::Depth, ray.lanes) } else { (Limit::Asked, ray.lanes & cut) };
                self.accumulator.add_ended8(limit, ended, &ray.pixel, &ray.weight);
                let mut extra = ray.extra;
                extra.set_budget(division.budget[0]);
                let new = Spawn8 {
                    origin: ray.origin,
                    dir: ray.dir,
                    t_max: F32x8::INFINITY,
                    admits: GeometryMask::ALL,
                    weight: ray.weight,
                    pixel: &ray.pixel,
                    stack: &ray.stack,
                    lead: ray.lead,
                    passes: &ray.passes,
                    place: ray.place,
                    extra: Some(&extra),
                };
                self.queue(ray.kind, depth + 1).push8(ray.lanes & !ended, &new);
            }
        }
        self.held = held;
        self.held.clear();
    }

    /// Gathers the extras of the rays that hit a stream of surfaces, and numbers the surfaces' packets.
    pub fn carry(&mut self, chunk: &Chunk, refs: &[HitRef], surfaces: &mut [Surface8]) {
        self.extras.clear();
        for ((place, surface), refs) in surfaces.iter_mut().enumerate().zip(refs.chunks(8)) {
            surface.place = place as u32;
            let mut extra = Extra8::default();
            for k in 0..8 {
                let r = refs[k.min(refs.len() - 1)] as usize;
                extra.put(k, &chunk.extras[r >> 3], r & 7);
            }
            self.extras.push(extra);
        }
    }

    /// Returns the extras of the rays that hit `surface`, if rays carry extras.
    #[inline(always)]
    pub fn extra(&self, surface: &Surface8) -> Option<Extra8> {
        self.extras.get(surface.place as usize).copied()
    }

    /// Returns the interface of lane `k`'s material.
    #[inline(always)]
    pub fn interface(&self, surface: &Surface8, k: usize) -> &'a Interface {
        &self.scene.materials[surface.material[k] as usize].interface
    }

    /// Returns the lanes of a surface that lie in planes.
    #[cold]
    pub fn flat(&self, surface: &Surface8, lanes: u8) -> u8 {
        let Some(flats) = self.flats else { return 0 };
        let flat = |k: &usize| flats.at(surface.hit[*k].geometry, surface.hit[*k].primitive).is_some();
        set_lanes(lanes).filter(flat).fold(0, |bits, k| bits | 1 << k)
    }

    /// Returns the transition at the surface of lane `k`, or at all surfaces that coincide there. Returns `None` if the
    /// surface bounds no medium.
    pub fn transition(&mut self, surface: &Surface8, k: usize) -> Option<Transition> {
        if let Some(crossed) = self.arrivals.crossed(surface, k) {
            return Some(self.media.cross_all(surface.stack[k], crossed));
        }
        let body = self.media.body_of(surface.hit[k].geometry)?;
        Some(self.media.cross(surface.stack[k], body, surface.front.lane(k)))
    }

    /// Gathers a colour per lane from the interfaces of the materials.
    #[inline(always)]
    pub fn colours(&self, surface: &Surface8, colour: impl Fn(&Interface) -> Rgb) -> Rgb8 {
        let mut out = Vec3x8::splat(Rgb::ZERO);
        for k in 0..8 {
            out.set_lane(k, colour(self.interface(surface, k)));
        }
        out
    }

    /// Returns the transmittance of the top media over `t`, or `None` if no lane of `lanes` is in an absorbing medium.
    #[inline]
    pub fn absorbed(&self, lanes: u8, stack: &[StackId; 8], t: F32x8) -> Option<Rgb8> {
        let mut coefficient = Vec3x8::splat(Rgb::ZERO);
        let mut any = false;
        for k in set_lanes(lanes) {
            if let Some(absorption) = self.media.absorption(stack[k]) {
                coefficient.set_lane(k, absorption);
                any = true;
            }
        }
        any.then(|| transmittance(coefficient, t))
    }
}

/// Returns true if some medium disperses white light, or if the pipeline assumes that one may.
#[must_use]
pub fn disperses(scene: &Scene, options: &Options) -> bool {
    options.effects.pipeline == Pipeline::All || scene.media.iter().any(Medium::disperses)
}
