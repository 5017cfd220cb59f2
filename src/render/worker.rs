//! One thread's share of a render: tiles of camera rays, and everything that follows from them.

use glam::Vec3;

use super::accumulate::{Accumulator, set_lanes};
use super::camera::{Lens, sample_offset};
use super::lookup::environment8;
use super::media::{MediaTable, StackId};
use super::options::Observer;
use super::outcome::{RayCounts, RayKind};
use super::queue::{Chunk, Queue};
use super::shade::{Class, lane_bits};
use super::surface::{HitRef, Surface8};
use super::tile::Tile;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit8, Ray8};
use crate::optics::FresnelFormula;
use crate::scene::{Rgb, Scene, ShadowRule};
use crate::simd::{F32x8, Mask8, Vec3x8};
use crate::{Error, Result};

/// Surfaces that are not there which a ray may pass in a row.
pub const MOST_PASSES: u16 = 256;

/// Packets traced at a time. Bounds memory: a queue never holds more than the children of two chunks.
const CHUNK_PACKETS: usize = 128;

/// Everything a thread needs, kept from tile to tile so that nothing is allocated once it is warm.
pub struct Worker<'a, I: Intersector> {
    pub(super) scene: &'a Scene,
    pub(super) accel: &'a I,
    observer: &'a Observer,
    lens: Lens,
    classes: Vec<Class>,
    pub(super) has_base: Vec<bool>,
    pub(super) media: MediaTable<'a>,
    eye_stack: StackId,
    pub(super) shadow_admits: GeometryMask,
    pub(super) march_shadows: bool,

    pub(super) accumulator: Accumulator,
    pub(super) counts: RayCounts,
    pub(super) unmatched_exits: u64,

    /// By depth; reflected and transmitted rays apart, since they part ways.
    queues: Vec<[Queue; 2]>,
    pub(super) shadows: Queue,
    chunk: Chunk,
    hits: Vec<Hit8>,
    bins: [Vec<HitRef>; Class::COUNT],
    misses: Vec<HitRef>,
    pub(super) shadow_chunk: Chunk,
    pub(super) shadow_hits: Vec<Hit8>,
    /// Lengths of the shadow rays, while they are cut short of their lamps.
    pub(super) shadow_ends: Vec<F32x8>,
    pub(super) shadow_refs: Vec<HitRef>,
    pub(super) blocked: Vec<Mask8>,
    /// Lanes of shadow packets whose light arrives.
    pub(super) arrived: Vec<u8>,
    pub(super) scratch: I::Scratch,
}

impl<'a, I: Intersector> Worker<'a, I> {
    /// A worker for one render; `eye_media` are the media around the eye, in the order they were entered.
    pub fn new(scene: &'a Scene, accel: &'a I, eye_media: &[u32], observer: &'a Observer) -> Self {
        let mut media = MediaTable::new(&scene.media);
        let eye_stack = media.stack_of(eye_media);
        let transmissive = scene.geometry.iter().any(|g| g.mask.meets(GeometryMask::TRANSMISSIVE));
        let absorbing = scene.media.iter().any(|m| m.absorption != Rgb::ZERO);
        let march_shadows = (transmissive || absorbing) && scene.settings.shadows == ShadowRule::Straight;
        Self {
            scene,
            accel,
            observer,
            lens: Lens::new(&scene.camera, scene.settings.width, scene.settings.height),
            classes: scene.objects.iter().map(|o| Class::of(&scene.materials[o.material as usize])).collect(),
            has_base: scene.materials.iter().map(super::direct::has_base).collect(),
            media,
            eye_stack,
            shadow_admits: if march_shadows { GeometryMask::OPAQUE } else { GeometryMask::ALL },
            march_shadows,
            accumulator: Accumulator::default(),
            counts: RayCounts::default(),
            unmatched_exits: 0,
            queues: Vec::new(),
            shadows: Queue::default(),
            chunk: Chunk::default(),
            hits: Vec::new(),
            bins: Default::default(),
            misses: Vec::new(),
            shadow_chunk: Chunk::default(),
            shadow_hits: Vec::new(),
            shadow_ends: Vec::new(),
            shadow_refs: Vec::new(),
            blocked: Vec::new(),
            arrived: Vec::new(),
            scratch: I::Scratch::default(),
        }
    }

    /// Renders one tile into the accumulator, sample by sample, so that memory does not grow with their number.
    ///
    /// # Errors
    /// [`Error::Interrupted`] once the observer says stop.
    pub fn tile<F: FresnelFormula>(&mut self, tile: &Tile) -> Result<()> {
        self.accumulator.reset(tile.pixels());
        let n = self.scene.settings.samples;
        for sample in 0..n * n {
            let mut chunk = std::mem::take(&mut self.chunk);
            chunk.clear();
            self.camera_rays(tile, sample % n, sample / n, &mut chunk);
            self.step::<F>(&mut chunk, 0, RayKind::Camera)?;
            while let Some((depth, kind)) = self.deepest() {
                chunk.clear();
                self.queue(kind, depth).take(CHUNK_PACKETS, &mut chunk);
                self.step::<F>(&mut chunk, depth, kind)?;
            }
            self.chunk = chunk;
        }
        Ok(())
    }

    /// Fills the chunk with one camera ray for each pixel of the tile: packets of 4 by 2 pixels, in blocks of 8 by 8.
    fn camera_rays(&self, tile: &Tile, sample_x: u32, sample_y: u32, chunk: &mut Chunk) {
        let n = self.scene.settings.samples;
        let (dx, dy) = (sample_offset(sample_x, n), sample_offset(sample_y, n));
        for block in tile.packets() {
            let at = |k: usize| block.pixel(tile, k);
            let active = lane_bits(|k| at(k).is_some());
            if active == 0 {
                continue;
            }
            let x = F32x8::from_fn(|k| block.x(k) as f32) + dx;
            let y = F32x8::from_fn(|k| block.y(k) as f32) + dy;
            let (origin, dir) = self.lens.rays8(x, y);
            chunk.rays.push(Ray8 { origin, dir, active, ..Ray8::default() });
            chunk.states.push(super::queue::State8 {
                weight: Vec3x8::splat(Vec3::ONE),
                pixel: std::array::from_fn(|k| at(k).unwrap_or(0)),
                stack: [self.eye_stack; 8],
                lead: F32x8::ZERO,
                passes: [0; 8],
            });
        }
    }

    /// The queue for rays of one kind at one depth.
    pub(super) fn queue(&mut self, kind: RayKind, depth: usize) -> &mut Queue {
        if self.queues.len() <= depth {
            self.queues.resize_with(depth + 1, Default::default);
        }
        &mut self.queues[depth][usize::from(kind == RayKind::Transmitted)]
    }

    /// The deepest queue that holds anything: taking from it first keeps the others short.
    fn deepest(&self) -> Option<(usize, RayKind)> {
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

    /// Traces a chunk, sorts what it met by kind of surface, and shades each kind eight at a time.
    fn step<F: FresnelFormula>(&mut self, chunk: &mut Chunk, depth: usize, kind: RayKind) -> Result<()> {
        if self.observer.stop.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        self.counts.add(kind, depth, chunk.len());
        let coherence = if depth == 0 { Coherence::Coherent } else { Coherence::Incoherent };
        let mut hits = std::mem::take(&mut self.hits);
        hits.clear();
        hits.resize(chunk.rays.len(), Hit8::default());
        self.accel.closest(&chunk.rays, &mut hits, coherence, &mut self.scratch);

        self.absorb_and_sort(chunk, &hits);
        self.shade_misses(chunk);
        for class in 0..Class::COUNT {
            let refs = std::mem::take(&mut self.bins[class]);
            for eight in refs.chunks(8) {
                let surface = Surface8::gather(self.scene, chunk, &hits, eight);
                let class = self.classes[surface.hit[0].geometry as usize];
                self.shade::<F>(class, &surface, depth);
                if self.shadows.len() >= CHUNK_PACKETS * 8 {
                    self.flush_shadows::<F>(depth, coherence);
                }
            }
            self.bins[class] = refs;
        }
        self.flush_shadows::<F>(depth, coherence);
        self.hits = hits;
        Ok(())
    }

    fn absorb_and_sort(&mut self, chunk: &mut Chunk, hits: &[Hit8]) {
        self.misses.clear();
        self.bins.iter_mut().for_each(Vec::clear);
        for (packet, (ray, hit)) in chunk.rays.iter().zip(hits).enumerate() {
            let state = &mut chunk.states[packet];
            if let Some(left) = self.absorbed(ray.active, &state.stack, hit.t + state.lead) {
                state.weight = state.weight.times(left);
            }
            for lane in set_lanes(ray.active) {
                let place = (packet * 8 + lane) as HitRef;
                match self.classes.get(hit.geometry[lane] as usize) {
                    Some(&class) => self.bins[class as usize].push(place),
                    None => self.misses.push(place),
                }
            }
        }
    }

    fn shade_misses(&mut self, chunk: &Chunk) {
        let mut from = 0;
        while from < self.misses.len() {
            // Misses of one packet are neighbours in the list and are looked up together.
            let packet = self.misses[from] as usize >> 3;
            let mut lanes = 0;
            while from < self.misses.len() && self.misses[from] as usize >> 3 == packet {
                lanes |= 1 << (self.misses[from] & 7);
                from += 1;
            }
            let state = &chunk.states[packet];
            let seen = environment8(&self.scene.environment, &self.scene.textures, &chunk.rays[packet].dir);
            self.accumulator.add_radiance8(lanes, &state.pixel, &seen.times(state.weight));
        }
    }
}
