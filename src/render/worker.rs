//! Worker of one thread: renders tiles of camera rays and all their secondary rays.

use std::ops::Range;

use glam::Vec3;

use super::camera::{Lens, sample_offset};
use super::ceiling::Ceiling;
use super::class::{BINS, bin_of};
use super::extra::Extra8;
use super::images::Found;
use super::media::StackId;
use super::options::{Observer, Options};
use super::outcome::{RayKind, Seen, Stage};
use super::past;
use super::queue::{Chunk, State8};
use super::shading::Shading;
use super::soft::{SoftStage, SoftStages};
use super::split::lane_bits;
use super::stages::{BinStages, STREAM, Stages};
use super::surface::{HitRef, Surface8};
use super::tile::{Block, PixelPacket, Tile};
use crate::accel::{Coherence, Intersector};
use crate::geometry::contact::Contacts;
use crate::geometry::{Hit8, Ray8};
use crate::scene::{Bodies, Scene};
use crate::simd::{F32x8, Mask8, Vec3x8, set_lanes};
use crate::{Error, Result};

/// Packets traced at a time. Bounds memory: a queue never holds more than the children of two chunks.
const CHUNK_PACKETS: usize = 1024;

/// Packets of camera rays traced together.
const CAMERA_PACKETS: usize = 320;

/// Number of blocks of 8 by 8 pixels, and of samples of each pixel, that are traced together.
struct AtOnce {
    blocks: usize,
    samples: u32,
}

/// Bodies that rays can be in, and touching surfaces.
pub struct Media<'a> {
    /// The bodies of the scene's objects.
    pub bodies: &'a Bodies,
    /// The scene's touching surfaces.
    pub contacts: &'a Contacts,
    /// Bodies around the eye.
    pub eye: &'a [u32],
}

/// State of one thread, reused from tile to tile so that it allocates nothing once warm.
pub struct Worker<'a, I: Intersector> {
    pub(super) stages: &'a Stages,
    pub(super) accel: &'a I,
    pub(super) scratch: I::Scratch,
    pub(super) shading: Shading<'a>,
    pub(super) observer: &'a Observer,
    lens: Lens,
    eye_stack: StackId,
    eye_bodies: &'a [u32],
    /// Bin by object.
    pub(super) bin_of: Vec<u8>,
    /// By object: true if a ray other than a shadow ray hit it.
    met: Vec<bool>,
    /// Object that camera rays pass.
    past: Option<u32>,
    /// Number of camera rays that hit nothing.
    missed: u64,

    blocks: Vec<Block>,
    chunk: Chunk,
    hits: Vec<Hit8>,
    bins: [Vec<HitRef>; BINS],
    misses: Vec<HitRef>,
    pub(super) surfaces: Vec<Surface8>,
    pub(super) bases: Vec<super::base::Base8>,
    pub(super) shadow_chunk: Chunk,
    pub(super) shadow_hits: Vec<Hit8>,
    /// Surfaces that shadow rays pass through; the surfaces that sent the rays stay in `surfaces`.
    pub(super) shadow_surfaces: Vec<Surface8>,
    /// Full lengths of the shadow rays, while they end before their lamps.
    pub(super) shadow_ends: Vec<F32x8>,
    pub(super) shadow_refs: Vec<HitRef>,
    pub(super) blocked: Vec<Mask8>,
    /// Lanes of shadow packets whose light arrives.
    pub(super) arrived: Vec<u8>,
}

impl<'a, I: Intersector> Worker<'a, I> {
    /// Creates a worker for one render.
    pub fn new(
        scene: &'a Scene,
        accel: &'a I,
        stages: &'a Stages,
        options: &Options,
        tolls: Option<&'a Ceiling>,
        media: &Media<'a>,
        observer: &'a Observer,
    ) -> Self {
        let mut shading = Shading::new(scene, media.bodies, media.contacts, options, stages, tolls);
        let eye_stack = shading.media.stack_of(media.eye);
        let bin = |object: &crate::scene::Object| bin_of(&scene.materials[object.material as usize]) as u8;
        Self {
            stages,
            accel,
            scratch: I::Scratch::default(),
            shading,
            observer,
            lens: Lens::new(&scene.camera, scene.settings.width, scene.settings.height),
            eye_stack,
            eye_bodies: media.eye,
            bin_of: scene.objects.iter().map(bin).collect(),
            met: vec![false; scene.objects.len()],
            past: options.past,
            missed: 0,
            blocks: Vec::new(),
            chunk: Chunk::default(),
            hits: Vec::new(),
            bins: Default::default(),
            misses: Vec::new(),
            surfaces: Vec::new(),
            bases: Vec::new(),
            shadow_chunk: Chunk::default(),
            shadow_hits: Vec::new(),
            shadow_surfaces: Vec::new(),
            shadow_ends: Vec::new(),
            shadow_refs: Vec::new(),
            blocked: Vec::new(),
            arrived: Vec::new(),
        }
    }

    /// Returns the objects that the worker's rays hit so far, and whether lamp light reached any.
    pub fn seen(&self) -> Seen {
        Seen { objects: self.met.clone(), missed: self.missed, lit: self.shading.accumulator.lit != 0 }
    }

    /// Renders one tile into the accumulator, part by part, so that memory does not grow with the number of samples.
    ///
    /// # Errors
    /// Returns [`Error::Interrupted`] once the observer requests a stop.
    pub fn tile(&mut self, tile: &Tile) -> Result<()> {
        self.shading.accumulator.reset(tile.pixels());
        self.shading.tile = *tile;
        let samples = self.shading.scene.settings.samples.pow(2);
        let at_once = self.at_once(samples);
        let mut blocks = std::mem::take(&mut self.blocks);
        tile.blocks(&mut blocks);
        for part in blocks.chunks(at_once.blocks) {
            for first in (0..samples).step_by(at_once.samples as usize) {
                self.part(tile, part, first..samples.min(first + at_once.samples))?;
            }
        }
        self.blocks = blocks;
        Ok(())
    }

    /// Traces samples `samples` of all pixels in `blocks`, with all their secondary rays.
    fn part(&mut self, tile: &Tile, blocks: &[Block], samples: Range<u32>) -> Result<()> {
        let first = samples.start;
        self.begin(first);
        let mut chunk = std::mem::take(&mut self.chunk);
        chunk.clear();
        self.camera_rays(tile, blocks, samples, &mut chunk);
        self.step(&mut chunk, 0, RayKind::Camera)?;
        if self.shading.passes.is_on() {
            self.mirrored(tile, first, &mut chunk)?;
        }
        if self.shading.virtual_rays.is_on() {
            self.in_virtual_scenes()?;
        }
        while let Some((depth, kind)) = self.shading.next_queue(8 * CHUNK_PACKETS) {
            chunk.clear();
            self.shading.queue(kind, depth).take(CHUNK_PACKETS, &mut chunk);
            self.step(&mut chunk, depth, kind)?;
        }
        self.chunk = chunk;
        self.shading.touching.clear();
        Ok(())
    }

    /// Traces the rays of the camera's mirror images, pass by pass, and of their secondary rays as many as fill whole
    /// streams.
    fn mirrored(&mut self, tile: &Tile, sample: u32, chunk: &mut Chunk) -> Result<()> {
        let n = self.shading.scene.settings.samples;
        let offset = (sample_offset(sample % n, n), sample_offset(sample / n, n));
        let mut pass = 1;
        while let Some(level) = self.shading.passes.enter(pass) {
            chunk.clear();
            if self.shading.passes.rays(self.shading.scene, tile, offset, CHUNK_PACKETS, chunk) {
                self.step(chunk, level, RayKind::Reflected)?;
                self.shading.passes.leave();
                while let Some((depth, kind)) = self.shading.full_queue(8 * CHUNK_PACKETS) {
                    chunk.clear();
                    self.shading.queue(kind, depth).take(CHUNK_PACKETS, chunk);
                    self.step(chunk, depth, kind)?;
                }
            } else {
                pass += 1;
            }
        }
        self.shading.passes.leave();
        Ok(())
    }

    /// Shades what rays of the eye show that go on in virtual scenes.
    fn in_virtual_scenes(&mut self) -> Result<()> {
        let mut found = Found::default();
        loop {
            found.clear();
            let Shading { virtual_rays, own_scratch, scene, .. } = &mut self.shading;
            if !virtual_rays.take(scene, CHUNK_PACKETS, own_scratch.get_or_insert_default(), &mut found) {
                return Ok(());
            }
            self.shading.counts.add(RayKind::Reflected, 1, found.shown.len());
            let mut hits = std::mem::take(&mut self.hits);
            hits.clone_from(&found.hits);
            self.shade_chunk(&mut found.shown, hits, 1, RayKind::Reflected, Coherence::Coherent)?;
            if !found.unknown.rays.is_empty() {
                self.step(&mut found.unknown, 1, RayKind::Reflected)?;
            }
        }
    }

    /// Returns the number of camera rays to trace together: all samples of a pixel, and as many pixels as make long
    /// streams. No more than that, since pixels near each other share cached nodes. Area lamps and dispersion need the
    /// sample index, so samples are then traced one index at a time.
    fn at_once(&self, samples: u32) -> AtOnce {
        let passes = self.shading.passes.is_on() || self.shading.virtual_rays.is_on();
        let numbered =
            passes || self.shading.media.disperses() || self.stages.bins.iter().flatten().any(|b| !b.lamps.is_empty());
        if numbered {
            return AtOnce { blocks: usize::MAX, samples: 1 };
        }
        let samples = samples.clamp(1, (CHUNK_PACKETS / 8) as u32);
        AtOnce { blocks: (CAMERA_PACKETS / 8 / samples as usize).max(1), samples }
    }

    /// Starts sample `sample`; if sample indices do not matter, it stands for itself and the ones traced with it.
    pub(super) fn begin(&mut self, sample: u32) {
        self.shading.sample = sample;
        if self.shading.passes.is_on() {
            self.shading.passes.begin();
        }
        self.shading.media.begin_sample(sample);
        self.eye_stack = self.shading.media.stack_of(self.eye_bodies);
    }

    /// Fills the chunk with camera rays: for each block, one ray per pixel and sample in `samples`.
    pub(super) fn camera_rays(&self, tile: &Tile, blocks: &[Block], samples: Range<u32>, chunk: &mut Chunk) {
        let n = self.shading.scene.settings.samples;
        for block in blocks {
            for sample in samples.clone() {
                let (dx, dy) = (sample_offset(sample % n, n), sample_offset(sample / n, n));
                block.iter().for_each(|packet| self.camera_packet(tile, packet, dx, dy, chunk));
            }
        }
    }

    /// Adds the rays through a packet of pixels, offset by (`dx`, `dy`) within each pixel, except for pixels outside
    /// the tile.
    #[inline]
    fn camera_packet(&self, tile: &Tile, packet: &PixelPacket, dx: F32x8, dy: F32x8, chunk: &mut Chunk) {
        let at = |k: usize| packet.pixel(tile, k);
        let active = lane_bits(|k| at(k).is_some());
        if active == 0 {
            return;
        }
        let x = F32x8::from_fn(|k| packet.x(k) as f32) + dx;
        let y = F32x8::from_fn(|k| packet.y(k) as f32) + dy;
        let (origin, dir) = self.lens.rays8(x, y);
        chunk.rays.push(Ray8 { origin, dir, active, ..Ray8::default() });
        chunk.states.push(State8 {
            weight: Vec3x8::splat(Vec3::ONE),
            pixel: std::array::from_fn(|k| at(k).unwrap_or(0)),
            stack: [self.eye_stack; 8],
            lead: F32x8::ZERO,
            passes: [0; 8],
        });
        if self.shading.carries {
            chunk.extras.push(Extra8::fresh(dir));
        }
    }

    /// Traces a chunk, sorts its hits into bins, and runs each bin through its stages.
    fn step(&mut self, chunk: &mut Chunk, depth: usize, kind: RayKind) -> Result<()> {
        if self.observer.stop.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        self.shading.counts.add(kind, depth, chunk.len());
        let coherent = depth == 0 || self.shading.passes.is_camera();
        let coherence = if coherent { Coherence::Coherent } else { Coherence::Incoherent };
        let mut hits = std::mem::take(&mut self.hits);
        hits.clear();
        hits.resize(chunk.rays.len(), Hit8::default());
        if self.stages.touching {
            self.shading.arrivals.hold_back(chunk);
        }
        self.accel.closest(&chunk.rays, &mut hits, coherence, &mut self.scratch);
        if let Some(object) = self.past.filter(|_| kind == RayKind::Camera) {
            past::go_on(self.accel, &mut self.scratch, object, &chunk.rays, &mut hits);
        }
        self.shade_chunk(chunk, hits, depth, kind, coherence)
    }

    /// Sorts the hits of a chunk into bins, and runs each bin through its stages.
    fn shade_chunk(
        &mut self,
        chunk: &mut Chunk,
        mut hits: Vec<Hit8>,
        depth: usize,
        kind: RayKind,
        coherence: Coherence,
    ) -> Result<()> {
        if self.stages.touching {
            self.arrive(chunk, &mut hits);
        }

        let stages = self.stages;
        if let Some(medium) = stages.medium {
            self.shading.streams.count(Stage::Medium);
            medium(&self.shading, chunk, &hits);
        }
        self.sort(chunk, &hits);
        if kind == RayKind::Camera {
            self.missed += self.misses.len() as u64;
        }
        if let Some(miss) = stages.miss.filter(|_| !self.misses.is_empty()) {
            self.shading.streams.count(Stage::Miss);
            miss(&mut self.shading, chunk, &self.misses);
        }
        for (bin, stages) in stages.bins.iter().enumerate() {
            let Some(stages) = stages else { continue };
            let refs = std::mem::take(&mut self.bins[bin]);
            for stream in refs.chunks(STREAM) {
                self.shading.streams.count(Stage::Gather);
                (stages.gather)(self.shading.scene, chunk, &hits, stream, &mut self.surfaces);
                if self.shading.carries {
                    self.shading.carry(chunk, stream, &mut self.surfaces);
                }
                if self.stages.touching {
                    self.mark(stream);
                }
                self.shade(stages, depth, coherence);
            }
            self.bins[bin] = refs;
        }
        self.flush_shadows(depth, coherence);
        self.hits = hits;
        Ok(())
    }

    /// Moves the hits of a chunk to the layers that count where surfaces touch.
    pub(super) fn arrive(&mut self, chunk: &mut Chunk, hits: &mut [Hit8]) {
        let mut arrivals = std::mem::take(&mut self.shading.arrivals);
        arrivals.arrive(&mut self.shading, chunk, hits);
        self.shading.arrivals = arrivals;
    }

    /// Sets the layer data of a stream's surfaces where surfaces touch.
    pub(super) fn mark(&mut self, stream: &[HitRef]) {
        let Shading { touching, arrivals, .. } = &mut self.shading;
        arrivals.mark(touching, stream, &mut self.surfaces);
    }

    /// Runs the surfaces of a stream through the stages of their bin.
    fn shade(&mut self, stages: &BinStages, depth: usize, coherence: Coherence) {
        if let Some((stage, split)) = stages.split {
            self.shading.streams.count(stage);
            split(&mut self.shading, &mut self.surfaces, depth);
            self.shading.settle(depth);
        }
        let Some(base) = stages.base else { return };
        self.shading.streams.count(Stage::Base);
        base(&mut self.shading, &self.surfaces, &mut self.bases);
        for &(light, shine) in &stages.lights {
            self.shading.streams.count(Stage::Light);
            shine(&mut self.shading, light, &self.surfaces, &self.bases);
        }
        for &(lamp, soft) in &stages.lamps {
            self.shading.streams.count(Stage::Lamp);
            self.shine_softly(lamp, &soft, depth, coherence);
        }
        if self.shading.shadows.len() >= CHUNK_PACKETS * 8 {
            self.flush_shadows(depth, coherence);
        }
    }

    /// Adds an area lamp's light to the surfaces of a stream, and queues the shadow rays it needs.
    fn shine_softly(&mut self, lamp: usize, soft: &SoftStages, depth: usize, coherence: Coherence) {
        let bases = self.bases.len();
        for part in (0..bases).step_by(soft.surfaces).map(|from| from..bases.min(from + soft.surfaces)) {
            let run = |worker: &mut Self, stage: SoftStage| {
                stage(&mut worker.shading, lamp, &worker.surfaces[part.clone()], &worker.bases[part.clone()], depth);
            };
            if !soft.shadows {
                run(self, soft.unoccluded);
                continue;
            }
            run(self, soft.shadowed);
            if self.shading.shadows.len() >= CHUNK_PACKETS * 8 {
                self.flush_shadows(depth, coherence);
            }
        }
    }

    fn sort(&mut self, chunk: &Chunk, hits: &[Hit8]) {
        self.misses.clear();
        self.bins.iter_mut().for_each(Vec::clear);
        for (packet, (ray, hit)) in chunk.rays.iter().zip(hits).enumerate() {
            let first = (packet * 8) as HitRef;
            // Neighbouring rays mostly hit the same object.
            if ray.active == u8::MAX && hit.geometry == [hit.geometry[0]; 8] {
                let refs: [HitRef; 8] = std::array::from_fn(|lane| first + lane as HitRef);
                self.hits_on(hit.geometry[0]).extend_from_slice(&refs);
            } else {
                for lane in set_lanes(ray.active) {
                    self.hits_on(hit.geometry[lane]).push(first + lane as HitRef);
                }
            }
        }
    }

    /// Returns the list of hits for an object's bin, or the list of misses if `object` is none.
    #[inline(always)]
    fn hits_on(&mut self, object: u32) -> &mut Vec<HitRef> {
        match self.bin_of.get(object as usize) {
            Some(&bin) => {
                self.met[object as usize] = true;
                &mut self.bins[bin as usize]
            }
            None => &mut self.misses,
        }
    }
}
