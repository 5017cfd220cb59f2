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
mod lookup;
mod media;
mod medium;
mod options;
mod outcome;
mod pattern;
mod place;
mod queue;
pub mod record;
pub mod reference;
mod room;
mod shading;
mod shadow;
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

pub use ceiling::Ceiling;
pub use class::{SharedShading, shared_shading};
pub use options::{Observer, Options, Reflection};
pub use outcome::{Outcome, RayCounts, RayKind, Seen, Stage, StreamCounts, TouchingFound};
pub use pattern::FilmRay;
pub use room::need;
pub use unmatched::UnmatchedExits;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use crate::accel::{Intersector, Shafts};
use crate::effects::{self, Effect, Reach};
use crate::geometry::contact::Contacts;
use crate::image::Film;
use crate::scene::{Bodies, Scene};
use crate::system::threads;
use crate::{Error, Result};
use stages::Stages;
use tile::Tile;
use worker::{Media, Worker};

/// What one tile came to.
struct TileResult {
    tile: Tile,
    pixels: Vec<([f32; 3], [f32; 3])>,
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
    let tolls = Ceiling::asked(scene, options)?;
    let settings = &scene.settings;
    let tiles = Tile::cover(settings.width, settings.height, options.tile.max(1));
    let (bodies, (contacts, touching)) = (Bodies::of(scene), contacts(scene, options));
    let eye_bodies = eye::bodies_around(scene, accel, &bodies, &contacts);
    let stages = stages(scene, &eye_bodies, &bodies, &contacts, options);
    let shafts = soft::looks_through_shafts(scene).then(|| Shafts::new(accel, &scene.geometry));
    let next = AtomicUsize::new(0);

    let work = || -> Result<(Vec<TileResult>, Tally)> {
        let media = Media { bodies: &bodies, contacts: &contacts, eye: &eye_bodies };
        let mut worker = Worker::new(scene, accel, &stages, options, tolls.as_ref(), &media, observer);
        worker.shading.shafts = shafts.as_ref();
        let mut results = Vec::new();
        while let Some(&tile) = tiles.get(next.fetch_add(1, Ordering::Relaxed)) {
            worker.tile(&tile)?;
            let samples = settings.samples * settings.samples;
            let pixels = (0..tile.pixels()).map(|i| worker.shading.accumulator.mean(i, samples)).collect();
            results.push(TileResult { tile, pixels });
            observer.pixels_done.fetch_add(tile.pixels() as u64, Ordering::Relaxed);
        }
        Ok((results, Tally::of(&worker)))
    };

    let count = options.thread_count().min(tiles.len());
    threads::need(count - 1)?;
    room::need_with(settings, count)?;
    let parts: Vec<_> = std::thread::scope(|scope| {
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
    })?;

    let mut film = Film::new(settings.width, settings.height);
    let mut truncated = Film::new(settings.width, settings.height);
    let mut tally = Tally::default();
    for (results, part) in parts {
        tally.merge(&part);
        for TileResult { tile, pixels } in results {
            for (row, line) in pixels.chunks(tile.width as usize).enumerate() {
                let start = (tile.y as usize + row) * settings.width as usize + tile.x as usize;
                for (i, &(radiance, lost)) in line.iter().enumerate() {
                    film.pixels[start + i] = radiance;
                    truncated.pixels[start + i] = lost;
                }
            }
        }
    }
    Ok(Outcome {
        film,
        truncated,
        rays: tally.rays,
        non_finite: tally.non_finite,
        clamped: tally.clamped,
        unmatched_exits: tally.unmatched_exits.total(),
        unmatched_objects: tally.unmatched_exits.worst_first(),
        streams: tally.streams,
        touching,
        seen: tally.seen,
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
    let (bodies, (contacts, _)) = (Bodies::of(scene), contacts(scene, options));
    let eye_bodies = eye::bodies_around(scene, accel, &bodies, &contacts);
    let stages = stages(scene, &eye_bodies, &bodies, &contacts, options);
    if stages.carries {
        return Err(Error::Usage(String::from(
            "the rays of a pixel are written down in eight lanes neither with polarisation nor under a proven cut-off; \
             take another --fresnel",
        )));
    }
    let media = Media { bodies: &bodies, contacts: &contacts, eye: &eye_bodies };
    let mut worker = Worker::new(scene, accel, &stages, options, None, &media, observer);
    let tree = record::record(&mut worker, &Tile { x, y, width: 1, height: 1 })?;
    let samples = scene.settings.samples * scene.settings.samples;
    let (radiance, truncated) = worker.shading.accumulator.mean(0, samples);
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

/// The functions that a scene calls for.
fn stages(scene: &Scene, eye_bodies: &[u32], bodies: &Bodies, contacts: &Contacts, options: &Options) -> Stages {
    let eye_media: Vec<u32> = eye_bodies.iter().map(|&body| bodies.medium(body)).collect();
    Stages::of(scene, &Reach::of(scene), &eye_media, !contacts.is_empty(), options)
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
        }
    }

    fn merge(&mut self, o: &Self) {
        self.rays.merge(&o.rays);
        self.non_finite += o.non_finite;
        self.clamped += o.clamped;
        self.unmatched_exits.merge(&o.unmatched_exits);
        self.streams.merge(&o.streams);
        self.seen.merge(&o.seen);
    }
}
