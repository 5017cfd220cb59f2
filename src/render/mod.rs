//! From scene to film: tiles of ray streams, traced, shaded eight at a time, and their secondary rays queued.
//!
//! One thread renders one tile at a time. A tile's camera rays are traced as one stream; what they meet is sorted by
//! kind of surface into bins, and each bin goes through the stages it calls for, a stream at a time, eight lanes wide
//! (`stages.rs`); the rays that follow wait in queues by depth and kind, and the deepest
//! queue is taken first, a chunk at a time, so that memory is bounded by depth times chunk and not by 2^depth.

mod accumulate;
mod base;
mod budget;
mod camera;
mod ceiling;
mod class;
mod extent;
mod extra;
mod eye;
mod lamp;
mod light;
mod limit;
mod lookup;
mod media;
mod medium;
mod options;
mod outcome;
mod passes;
mod pattern;
mod place;
mod planar;
mod queue;
pub mod record;
pub mod reference;
mod room;
mod shading;
mod shadow;
mod shortfall;
mod sky;
mod soft;
mod split;
mod stages;
mod surface;
mod through;
mod tile;
mod touch;
mod unmatched;
mod worker;

pub use accumulate::PixelMean;
pub use ceiling::Ceiling;
pub use class::{SharedShading, shared_shading};
pub use limit::Limit;
pub use options::{Observer, Options, Reflection};
pub use outcome::{MirrorLevel, Outcome, PlanarReport, RayCounts, RayKind, Seen, Stage, StreamCounts, TouchingFound};
pub use pattern::FilmRay;
pub use room::need;
pub use shortfall::{Again, Cure, Shortfall};
pub use unmatched::UnmatchedExits;

use std::cell::OnceCell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use crate::accel::{Intersector, Shafts};
use crate::effects::{self, Effect, Reach};
use crate::geometry::contact::Contacts;
use crate::image::Film;
use crate::scene::{Bodies, Scene};
use crate::system::threads;
use crate::systems::planar::Mirrors;
use crate::{Error, Result};
use passes::Passes;
use planar::PlanarCounts;
use stages::Stages;
use tile::Tile;
use worker::{Media, Worker};

/// What one tile came to.
struct TileResult {
    /// Its place in the list of tiles.
    number: usize,
    tile: Tile,
    pixels: Vec<PixelMean>,
}

/// Renders `scene` with `accel`, which was built from `scene.geometry`.
///
/// Effects in `options.effects.without` are left out; what the rest calls for picks the stages.
///
/// The picture depends on neither `options.threads` nor `options.tile`, to the bit.
///
/// # Errors
/// [`Error::Interrupted`] when the observer said stop; [`Error::Limit`] when threads could not be started or there is no
/// memory for the picture; [`Error::Usage`] where a proven cut-off is asked for and cannot be had.
pub fn render<I: Intersector>(scene: &Scene, accel: &I, options: &Options, observer: &Observer) -> Result<Outcome> {
    let scene = &*effects::without(scene, options.effects.without);
    let settings = &scene.settings;
    let tiles = Tile::cover(settings.width, settings.height, options.tile.max(1));
    room::need_with(settings, options.thread_count().min(tiles.len()))?;
    let done = |tile: &Tile| observer.pixels_done.fetch_add(tile.pixels() as u64, Ordering::Relaxed);
    let ready = Ready::of(scene, accel, options).with_shafts(scene, accel);
    planar::possible(scene, options, ready.mirrors.as_ref())?;
    let parts = each(scene, accel, &ready, options, observer, &tiles, &|tile| _ = done(tile))?;

    let mut film = Film::new(settings.width, settings.height);
    let mut truncated = Film::new(settings.width, settings.height);
    let mut limits = vec![None; film.pixels.len()];
    let mut tally = Tally::default();
    for (results, part) in parts {
        tally.merge(&part);
        for TileResult { tile, pixels, .. } in results {
            for (row, line) in pixels.chunks(tile.width as usize).enumerate() {
                let start = (tile.y as usize + row) * settings.width as usize + tile.x as usize;
                for (i, pixel) in line.iter().enumerate() {
                    film.pixels[start + i] = pixel.radiance;
                    truncated.pixels[start + i] = pixel.truncated;
                    limits[start + i] = pixel.limit;
                }
            }
        }
    }
    Ok(Outcome {
        film,
        truncated,
        limits,
        shortfall: None,
        rays: tally.rays,
        non_finite: tally.non_finite,
        clamped: tally.clamped,
        unmatched_exits: tally.unmatched_exits.total(),
        unmatched_objects: tally.unmatched_exits.worst_first(),
        streams: tally.streams,
        touching: ready.touching,
        seen: tally.seen,
        planar: ready.mirrors.map(|mirrors| tally.planar.of_mirrors(&mirrors)),
    })
}

/// Renders pixels of one scene time and again, under one set of limits or another.
pub struct Pixels<'a, I: Intersector> {
    accel: &'a I,
    options: &'a Options,
    observer: &'a Observer,
    ready: OnceCell<Ready<'a>>,
}

impl<'a, I: Intersector> Pixels<'a, I> {
    /// With what [`render`] would be called with. Nothing is done yet.
    #[must_use]
    pub fn new(accel: &'a I, options: &'a Options, observer: &'a Observer) -> Self {
        Self { accel, options, observer, ready: OnceCell::new() }
    }

    /// Some pixels of the picture that [`render`] makes, by column and row from 0 at the upper left, to the bit; and how
    /// many rays they took. The scene must be that of earlier calls, but for the depth limit and the weight cut-off.
    ///
    /// # Errors
    /// As [`render`].
    pub fn render(&self, scene: &Scene, which: &[[u32; 2]]) -> Result<Again> {
        let &Self { accel, options, observer, .. } = self;
        let scene = &*effects::without(scene, options.effects.without);
        let tiles: Vec<Tile> = which.iter().map(|&[x, y]| Tile { x, y, width: 1, height: 1 }).collect();
        let ready = self.ready.get_or_init(|| Ready::of(scene, accel, options).with_shafts(scene, accel));
        let parts = each(scene, accel, ready, options, observer, &tiles, &|_| ())?;
        let mut again = Again { pixels: vec![PixelMean::default(); which.len()], rays: 0 };
        for (results, tally) in parts {
            again.rays += tally.rays.total();
            results.iter().for_each(|result| again.pixels[result.number] = result.pixels[0]);
        }
        Ok(again)
    }
}

/// Facts of a scene that are found before its first ray. Limits do not matter to them.
struct Ready<'a> {
    bodies: Bodies,
    contacts: Contacts,
    touching: TouchingFound,
    /// Bodies around the eye, the outermost first.
    eye: Vec<u32>,
    /// Finds what lies between a place and a lamp; none where all points of lamps get shadow rays.
    shafts: Option<Shafts<'a>>,
    /// Planar mirrors, where a camera is mirrored in them.
    mirrors: Option<Mirrors>,
}

impl<'a> Ready<'a> {
    /// Of a scene from which nothing is left to be left out.
    fn of<I: Intersector>(scene: &Scene, accel: &I, options: &Options) -> Self {
        let bodies = Bodies::of(scene);
        let (contacts, touching) = contacts(scene, options);
        let eye = eye::bodies_around(scene, accel, &bodies, &contacts);
        let mirrors = (options.reflection == Reflection::Planar).then(|| Mirrors::of(scene));
        Self { bodies, contacts, touching, eye, shafts: None, mirrors }
    }

    /// The same with shafts where the scene calls for them.
    fn with_shafts<I: Intersector>(self, scene: &Scene, accel: &'a I) -> Self {
        let shafts = soft::looks_through_shafts(scene).then(|| Shafts::new(accel, &scene.geometry));
        Self { shafts, ..self }
    }

    /// The functions that the scene calls for.
    fn stages(&self, scene: &Scene, options: &Options) -> Stages {
        let media: Vec<u32> = self.eye.iter().map(|&body| self.bodies.medium(body)).collect();
        Stages::of(scene, &Reach::of(scene), &media, !self.contacts.is_empty(), options)
    }

    fn media(&self) -> Media<'_> {
        Media { bodies: &self.bodies, contacts: &self.contacts, eye: &self.eye }
    }
}

/// Renders tiles of a scene from which nothing is left to be left out: one list of results, and what was counted, for each
/// thread.
fn each<I: Intersector>(
    scene: &Scene,
    accel: &I,
    ready: &Ready,
    options: &Options,
    observer: &Observer,
    tiles: &[Tile],
    done: &(dyn Fn(&Tile) + Sync),
) -> Result<Vec<(Vec<TileResult>, Tally)>> {
    let tolls = Ceiling::asked(scene, options)?;
    let (stages, media) = (ready.stages(scene, options), ready.media());
    let next = AtomicUsize::new(0);
    let samples = scene.settings.samples * scene.settings.samples;

    let work = || -> Result<(Vec<TileResult>, Tally)> {
        let mut worker = Worker::new(scene, accel, &stages, options, tolls.as_ref(), &media, observer);
        worker.shading.shafts = ready.shafts.as_ref();
        if let Some(mirrors) = &ready.mirrors {
            worker.shading.passes = Passes::new(mirrors, options.mirror_levels);
        }
        let mut results = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(&tile) = tiles.get(number) else { break };
            worker.tile(&tile)?;
            let pixels = (0..tile.pixels()).map(|i| worker.shading.accumulator.mean(i, samples)).collect();
            results.push(TileResult { number, tile, pixels });
            done(&tile);
        }
        Ok((results, Tally::of(&worker)))
    };

    let count = options.thread_count().min(tiles.len());
    threads::need(count.saturating_sub(1))?;
    std::thread::scope(|scope| {
        let spawned: Result<Vec<_>> = (1..count)
            .map(|_| threads::worker().spawn_scoped(scope, work).map_err(|e| threads::refused(count, &e)))
            .collect();
        if spawned.is_err() {
            observer.stop.store(true, Ordering::Relaxed);
        }
        // The calling thread works too.
        let mine = work();
        let mut parts: Vec<_> = spawned?.into_iter().map(|t| t.join().expect("a worker does not panic")).collect();
        parts.push(mine);
        parts.into_iter().collect::<Result<Vec<_>>>()
    })
}

/// One pixel of the picture that [`render`] makes (columns and rows from 0, at the upper left), with every ray that came
/// of it written down: radiance and truncated weight as the picture has them, to the bit.
///
/// # Errors
/// [`Error::Interrupted`] when the observer said stop; [`Error::Usage`] where rays carry polarisation or budgets.
pub fn recorded<I: Intersector>(
    scene: &Scene,
    accel: &I,
    options: &Options,
    observer: &Observer,
    (x, y): (u32, u32),
) -> Result<([f32; 3], [f32; 3], record::Tree)> {
    let scene = &*effects::without(scene, options.effects.without);
    let ready = Ready::of(scene, accel, options);
    let (stages, media) = (ready.stages(scene, options), ready.media());
    if stages.carries {
        return Err(Error::Usage(String::from(
            "the rays of a pixel are written down in eight lanes neither with polarisation nor under a proven cut-off; \
             take another --fresnel",
        )));
    }
    let mut worker = Worker::new(scene, accel, &stages, options, None, &media, observer);
    let tree = record::record(&mut worker, &Tile { x, y, width: 1, height: 1 })?;
    let samples = scene.settings.samples * scene.settings.samples;
    let PixelMean { radiance, truncated, .. } = worker.shading.accumulator.mean(0, samples);
    Ok((radiance, truncated, tree))
}

/// The touching surfaces of a scene, unless they are left out.
fn contacts(scene: &Scene, options: &Options) -> (Contacts, TouchingFound) {
    if options.effects.without.has(Effect::Touching) {
        return Default::default();
    }
    let start = Instant::now();
    let contacts = effects::contacts(scene);
    let found = TouchingFound { pairs: contacts.pairs().len(), time: start.elapsed() };
    (contacts, found)
}

/// What a thread counted.
#[derive(Default)]
struct Tally {
    rays: RayCounts,
    non_finite: u64,
    clamped: u64,
    unmatched_exits: UnmatchedExits,
    streams: StreamCounts,
    seen: Seen,
    planar: PlanarCounts,
}

impl Tally {
    fn of<I: Intersector>(worker: &Worker<I>) -> Self {
        Self {
            rays: worker.shading.counts.clone(),
            non_finite: worker.shading.accumulator.non_finite,
            clamped: worker.shading.accumulator.clamped,
            unmatched_exits: worker.shading.unmatched_exits.clone(),
            streams: worker.shading.streams,
            seen: worker.seen(),
            planar: PlanarCounts::of(&worker.shading.passes),
        }
    }

    fn merge(&mut self, o: &Self) {
        self.rays.merge(&o.rays);
        self.non_finite += o.non_finite;
        self.clamped += o.clamped;
        self.unmatched_exits.merge(&o.unmatched_exits);
        self.streams.merge(&o.streams);
        self.seen.merge(&o.seen);
        self.planar.merge(&o.planar);
    }
}
