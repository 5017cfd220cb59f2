//! What the stages of one thread share: the scene, the sums of its pixels and the rays that wait. Knows no accelerator.

use super::accumulate::Accumulator;
use super::media::{MediaTable, StackId};
use super::options::Options;
use super::outcome::{RayCounts, RayKind, StreamCounts};
use super::pattern::LampPoints;
use super::queue::{Queue, Rgb8, Spawn8};
use super::soft::Probes;
use super::split::mirrored::{self, ReflectStage};
use super::surface::Surface8;
use super::tile::Tile;
use crate::effects::{Effect, Pipeline};
use crate::geometry::GeometryMask;
use crate::math::Real;
use crate::optics::{Oliveira, Spectrum, transmittance};
use crate::scene::{Interface, Medium, Rgb, Scene};
use crate::simd::{F32x8, Vec3x8};

/// Everything a stage reads and writes, kept from tile to tile.
#[derive(Debug)]
pub struct Shading<'a> {
    pub scene: &'a Scene,
    pub media: MediaTable<'a>,
    /// The constant of the one refraction formula that has any.
    pub oliveira: Oliveira,
    /// What becomes of reflected light.
    pub reflect: ReflectStage,
    /// What stops a shadow ray at once.
    pub shadow_admits: GeometryMask,
    /// How often a ray may reflect or refract.
    pub max_depth: usize,
    /// The weight below which rays end.
    pub cutoff: f32,
    pub accumulator: Accumulator,
    pub counts: RayCounts,
    pub unmatched_exits: u64,
    pub streams: StreamCounts,
    /// Whether light ends where it would be reflected totally.
    pub total_is_lost: bool,
    /// By depth; reflected and transmitted rays apart, since they part ways.
    queues: Vec<[Queue; 2]>,
    pub shadows: Queue,
    /// Where lamps with an extent are sampled.
    pub points: LampPoints,
    pub probes: Probes,
    /// The tile whose pixels these are, and which of their camera rays is under way.
    pub tile: Tile,
    pub sample: u32,
}

impl<'a> Shading<'a> {
    /// Nothing summed and nothing queued.
    pub fn new(scene: &'a Scene, options: &Options, shadow_admits: GeometryMask) -> Self {
        let settings = &scene.settings;
        let media = if disperses(scene, options) {
            MediaTable::dispersing(&scene.media, Spectrum::new(settings.wavelengths, settings.samples))
        } else {
            MediaTable::new(&scene.media)
        };
        Self {
            scene,
            media,
            oliveira: options.oliveira,
            reflect: mirrored::pick(options.reflection, scene),
            shadow_admits,
            max_depth: scene.settings.max_depth as usize,
            cutoff: scene.settings.cutoff,
            accumulator: Accumulator::default(),
            counts: RayCounts::default(),
            unmatched_exits: 0,
            streams: StreamCounts::default(),
            total_is_lost: options.effects.without.has(Effect::TotalInternalReflection),
            queues: Vec::new(),
            shadows: Queue::default(),
            points: LampPoints::new(&scene.settings.lamps),
            probes: Probes::default(),
            tile: Tile { x: 0, y: 0, width: 1, height: 1 },
            sample: 0,
        }
    }

    /// Column and row in the picture of a pixel of the tile.
    #[inline]
    pub fn film_pixel(&self, pixel: u32) -> [u32; 2] {
        [self.tile.x + pixel % self.tile.width, self.tile.y + pixel / self.tile.width]
    }

    /// The queue for rays of one kind at one depth.
    pub fn queue(&mut self, kind: RayKind, depth: usize) -> &mut Queue {
        if self.queues.len() <= depth {
            self.queues.resize_with(depth + 1, Default::default);
        }
        &mut self.queues[depth][usize::from(kind == RayKind::Transmitted)]
    }

    /// The deepest queue that holds anything: taking from it first keeps the others short.
    pub fn deepest(&self) -> Option<(usize, RayKind)> {
        self.queues.iter().enumerate().rev().find_map(|(depth, [reflected, transmitted])| {
            if transmitted.len() > reflected.len() {
                Some((depth, RayKind::Transmitted))
            } else if !reflected.is_empty() {
                Some((depth, RayKind::Reflected))
            } else {
                None
            }
        })
    }

    /// Queues secondary rays of a hit at `depth`, but for those that the depth limit or the cut-off ends.
    pub fn spawn(&mut self, lanes: u8, new: &Spawn8, kind: RayKind, depth: usize) {
        // Of a wavelength, a channel may weigh less than nothing.
        let heaviest = new.weight.abs().max_component();
        let carrying = lanes & !heaviest.eq(F32x8::ZERO).bits();
        let too_deep = depth >= self.max_depth;
        // A NaN weight compares false and lives on, to be counted where it lands.
        let light = heaviest.lt(F32x8::from(self.cutoff)).bits();
        let ended = if too_deep { carrying } else { carrying & light };
        self.accumulator.add_truncated8(ended, new.pixel, &new.weight);
        self.queue(kind, depth + 1).push8(carrying & !ended, new);
    }

    /// The interface of each lane's material.
    #[inline(always)]
    pub fn interface(&self, surface: &Surface8, k: usize) -> &'a Interface {
        &self.scene.materials[surface.material[k] as usize].interface
    }

    /// A colour per lane from its material's interface.
    #[inline(always)]
    pub fn colours(&self, surface: &Surface8, colour: impl Fn(&Interface) -> Rgb) -> Rgb8 {
        let mut out = Vec3x8::splat(Rgb::ZERO);
        for k in 0..8 {
            out.set_lane(k, colour(self.interface(surface, k)));
        }
        out
    }

    /// What the media on top of the stacks leave of light over `t`; `None` where none of `lanes` is in a medium that
    /// absorbs.
    #[inline]
    pub fn absorbed(&self, lanes: u8, stack: &[StackId; 8], t: F32x8) -> Option<Rgb8> {
        let mut coefficient = Vec3x8::splat(Rgb::ZERO);
        let mut any = false;
        for k in super::accumulate::set_lanes(lanes) {
            if let Some(absorption) = self.media.absorption(stack[k]) {
                coefficient.set_lane(k, absorption);
                any = true;
            }
        }
        any.then(|| transmittance(coefficient, t))
    }
}

/// Whether white light divides into wavelengths anywhere, or is asked whether it does.
#[must_use]
pub fn disperses(scene: &Scene, options: &Options) -> bool {
    options.effects.pipeline == Pipeline::All || scene.media.iter().any(Medium::disperses)
}
