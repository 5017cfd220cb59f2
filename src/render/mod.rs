//! Rendering of a scene to a film: tiles of ray streams, traced and shaded eight lanes at a time.
//!
//! Each thread renders one tile at a time. A tile's camera rays are traced as one stream. Their hits are sorted into
//! bins by class of surface, and each bin runs through its stages, a stream at a time and eight lanes wide
//! (`stages.rs`). Secondary rays wait in queues by depth and kind. The deepest full queue is traced first, a chunk at a
//! time, so that memory is bounded by depth times chunk, not by 2^depth.

mod accumulate;
mod base;
mod bodies;
mod budget;
mod camera;
mod ceiling;
mod class;
mod extent;
mod extra;
mod eye;
mod first_hits;
mod images;
mod lamp;
mod light;
mod limit;
mod lookup;
mod maps;
mod media;
mod medium;
mod memory;
mod options;
mod outcome;
mod passes;
mod past;
mod pattern;
mod place;
mod planar;
mod queue;
pub mod record;
pub mod reference;
mod relief;
mod shading;
mod shadow;
mod shine;
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
pub use camera::Lens;
pub use ceiling::Ceiling;
pub use class::{SharedShading, shared_shading};
pub use first_hits::{FirstHit, first_hits};
pub use limit::Limit;
pub use memory::need;
pub use options::{Observer, Options, Reflection};
pub use outcome::{
    ImagesReport, MapsReport, MirrorLevel, Outcome, PlanarReport, RayCounts, RayKind, Seen, Stage, StreamCounts,
    TouchingFound,
};
pub use pattern::FilmRay;
pub use shortfall::{Again, Cure, Shortfall};
pub use unmatched::UnmatchedExits;

use std::cell::OnceCell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use glam::Vec3;

use crate::accel::{Coherence, Intersector, Shafts};
use crate::effects::{self, Effect, Reach};
use crate::error::{Error, Result, Unsupported};
use crate::geometry::contact::Contacts;
use crate::geometry::{Hit8, Ray, Ray8};
use crate::image::Film;
use crate::optics::RefractionModel;
use crate::scene::{Bodies, Scene};
use crate::system::threads;
use crate::systems::planar::Mirrors;
use bodies::Bodies8;
use images::{Virtual, VirtualRays};
use maps::{Taken, Taker};
use passes::Passes;
use planar::PlanarCounts;
use shine::Shine;
use stages::Stages;
use tile::Tile;
use worker::{Media, Worker};

/// Takes maps over a hierarchy.
struct ByAccel<'a, I: Intersector> {
    accel: &'a I,
    observer: &'a Observer,
}

impl<I: Intersector> Taker for ByAccel<'_, I> {
    fn picture(&self, view: &Scene, options: &Options) -> Result<Film> {
        if self.observer.stop.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        // Pixels of maps do not count as pixels of the picture.
        render(view, self.accel, options, &Observer::default()).map(|outcome| outcome.film)
    }

    fn distances(&self, from: Vec3, dirs: &[Vec3], object: u32) -> Vec<f32> {
        let rays = Ray8::pack(&dirs.iter().map(|&dir| Ray::new(from, dir)).collect::<Vec<_>>());
        let mut hits = vec![Hit8::default(); rays.len()];
        let mut scratch = I::Scratch::default();
        self.accel.closest(&rays, &mut hits, Coherence::Incoherent, &mut scratch);
        past::go_on(self.accel, &mut scratch, object, &rays, &mut hits);
        (0..dirs.len()).map(|i| hits[i / 8].t.lane(i % 8)).collect()
    }
}

/// Pixels of one rendered tile.
struct TileResult {
    /// Index in the list of tiles.
    number: usize,
    tile: Tile,
    pixels: Vec<PixelMean>,
}

/// Renders `scene` with `accel`, which must have been built from `scene.geometry`.
///
/// Leaves out the effects in `options.effects.without`, and picks the stages by what the rest of the scene needs. The
/// picture does not depend on `options.threads` or `options.tile`, to the bit.
///
/// # Errors
/// - [`Error::Interrupted`] if the observer requests a stop.
/// - [`Error::Limit`] if threads cannot be started, or the picture does not fit in memory.
/// - [`Error::Usage`] if a proven cut-off is requested for a scene that has none.
pub fn render<I: Intersector>(scene: &Scene, accel: &I, options: &Options, observer: &Observer) -> Result<Outcome> {
    Pixels::new(accel, options, observer).picture(scene)
}

/// Renders the whole picture of a scene from which effects have already been left out.
fn picture<I: Intersector>(
    scene: &Scene,
    accel: &I,
    facts: &SceneFacts,
    options: &Options,
    observer: &Observer,
) -> Result<Outcome> {
    let settings = &scene.settings;
    let tiles = Tile::cover(settings.width, settings.height, options.tile.max(1));
    memory::need_with(settings, options.thread_count().min(tiles.len()))?;
    let done = |tile: &Tile| observer.pixels_done.fetch_add(tile.pixels() as u64, Ordering::Relaxed);
    let parts = render_tiles(scene, accel, facts, options, observer, &tiles, &|tile| _ = done(tile))?;

    let mut film = Film::new(settings.width, settings.height);
    let mut truncated = Film::new(settings.width, settings.height);
    let mut limits = vec![None; film.pixels.len()];
    let mut counts = ThreadCounts::default();
    for (results, part) in parts {
        counts.merge(&part);
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
        rays: counts.rays,
        non_finite: counts.non_finite,
        clamped: counts.clamped,
        unmatched_exits: counts.unmatched_exits.total(),
        unmatched_objects: counts.unmatched_exits.worst_first(),
        streams: counts.streams,
        touching: facts.touching,
        seen: counts.seen,
        planar: facts.mirrors.as_ref().map(|mirrors| counts.planar.of_mirrors(mirrors)),
        maps: facts.maps.as_ref().map(|taken| taken.report(counts.without_map)),
        images: facts.images.as_ref().map(|images| images::report(&images.images, counts.without_image)),
        body_maps: facts.refracting.as_ref().map(|bodies| bodies.report(counts.without_body_map)),
    })
}

/// Renderer for one scene, which may be called again for selected pixels and under other limits.
pub struct Pixels<'a, I: Intersector> {
    accel: &'a I,
    options: &'a Options,
    observer: &'a Observer,
    facts: OnceCell<SceneFacts<'a>>,
}

impl<'a, I: Intersector> Pixels<'a, I> {
    /// Creates the renderer from the arguments of [`render`]. Does no work yet.
    #[must_use]
    pub fn new(accel: &'a I, options: &'a Options, observer: &'a Observer) -> Self {
        Self { accel, options, observer, facts: OnceCell::new() }
    }

    /// Renders the whole picture, as [`render`] does. Later calls share the facts found before its first ray.
    ///
    /// # Errors
    /// Fails as [`render`] does.
    pub fn picture(&self, scene: &Scene) -> Result<Outcome> {
        let scene = &*effects::without(scene, self.options.effects.without);
        picture(scene, self.accel, self.facts(scene)?, self.options, self.observer)
    }

    fn facts(&self, scene: &Scene) -> Result<&SceneFacts<'a>> {
        let &Self { accel, options, observer, .. } = self;
        match self.facts.get() {
            Some(facts) => Ok(facts),
            None => {
                let facts = SceneFacts::of(scene, accel, options).with_shafts(scene, accel)?;
                planar::possible(scene, facts.mirrors.as_ref())?;
                planar::raisable(scene, facts.flats.as_ref())?;
                let facts = facts.with_maps(Taken::of(scene, options, &ByAccel { accel, observer })?);
                let facts = facts.with_images(scene, options)?;
                let bodies = Taken::of_bodies(scene, options, &ByAccel { accel, observer })?;
                let facts = facts.with_bodies(scene, options, bodies)?;
                Ok(self.facts.get_or_init(|| facts))
            }
        }
    }

    /// Renders the pixels `which`, given by column and row from 0 at the upper left, as [`render`] does, to the bit.
    /// Returns them with the number of rays traced. Later calls must pass the same scene, except for the size, the rays a
    /// pixel, the depth limit and the weight cut-off.
    ///
    /// # Errors
    /// Fails as [`render`] does.
    pub fn render(&self, scene: &Scene, which: &[[u32; 2]]) -> Result<Again> {
        let &Self { accel, options, observer, .. } = self;
        let scene = &*effects::without(scene, options.effects.without);
        let tiles: Vec<Tile> = which.iter().map(|&[x, y]| Tile { x, y, width: 1, height: 1 }).collect();
        let parts = render_tiles(scene, accel, self.facts(scene)?, options, observer, &tiles, &|_| ())?;
        let mut again = Again { pixels: vec![PixelMean::default(); which.len()], rays: 0 };
        for (results, counts) in parts {
            again.rays += counts.rays.total();
            results.iter().for_each(|result| again.pixels[result.number] = result.pixels[0]);
        }
        Ok(again)
    }
}

/// Facts of a scene computed before its first ray, independent of its limits.
struct SceneFacts<'a> {
    bodies: Bodies,
    contacts: Contacts,
    touching: TouchingFound,
    /// Bodies around the eye, outermost first.
    eye: Vec<u32>,
    /// Finder of occluders between a point and a lamp. `None` if all samples of lamps get shadow rays.
    shafts: Option<Shafts<'a>>,
    /// Sources beside lamps that light surfaces.
    shine: Shine,
    /// Planar mirrors, where a camera is mirrored in them.
    mirrors: Option<Mirrors>,
    /// Maps that reflectors show, if any are asked for.
    maps: Option<Taken>,
    /// Planes that raise what lies behind them, if any are asked for.
    flats: Option<Mirrors>,
    /// Virtual scenes of reflectors, if any are asked for.
    images: Option<Virtual>,
    /// Maps of bodies that refracted light is looked up in, if any are asked for.
    refracting: Option<Bodies8>,
    /// Object that camera rays pass.
    past: Option<u32>,
}

impl<'a> SceneFacts<'a> {
    /// Computes the facts of `scene`, from which effects have already been left out.
    fn of<I: Intersector>(scene: &Scene, accel: &I, options: &Options) -> Self {
        let bodies = Bodies::of(scene);
        let (contacts, touching) = contacts(scene, options);
        let mut eye = eye::bodies_around(scene, accel, &bodies, &contacts);
        if let Some(passed) = options.past.and_then(|object| bodies.of_object(object)) {
            eye.retain(|&body| body != passed);
        }
        let mirrors = planar::mirrors(scene, options);
        let flats = (options.bending() == RefractionModel::Raised).then(|| Mirrors::of(scene));
        Self {
            bodies,
            contacts,
            touching,
            eye,
            shafts: None,
            shine: Shine::of(scene),
            mirrors,
            maps: None,
            flats,
            images: None,
            refracting: None,
            past: options.past,
        }
    }

    /// Adds the shafts if the scene's area lamps need them.
    fn with_shafts<I: Intersector>(self, scene: &Scene, accel: &'a I) -> Result<Self> {
        let shafts = soft::looks_through_shafts(scene).then(|| Shafts::new(accel, &scene.geometry)).transpose()?;
        Ok(Self { shafts, ..self })
    }

    /// The same with maps.
    fn with_maps(self, maps: Option<Taken>) -> Self {
        Self { maps, ..self }
    }

    /// The same with virtual scenes, where they are asked for and rays carry nothing that would be lost there.
    fn with_images(self, scene: &Scene, options: &Options) -> Result<Self> {
        let asked = options.reflection == Reflection::Virtual && !options.carries();
        let images = asked.then(|| Virtual::of(scene)).transpose()?;
        Ok(Self { images, ..self })
    }

    /// Adds maps of bodies.
    fn with_bodies(self, scene: &Scene, options: &Options, taken: Option<Taken>) -> Result<Self> {
        let refracting = taken.map(|taken| Bodies8::new(scene, options.bending(), taken)).transpose()?;
        Ok(Self { refracting, ..self })
    }

    /// Picks the stages that the scene needs.
    fn stages(&self, scene: &Scene, options: &Options) -> Stages {
        let media: Vec<u32> = self.eye.iter().map(|&body| self.bodies.medium(body)).collect();
        // What an object hides is no matter of rays that pass it.
        let reach = if self.past.is_some() { Reach::everything(scene) } else { Reach::of(scene) };
        Stages::of(scene, &reach, &media, !self.contacts.is_empty(), options)
    }

    fn media(&self) -> Media<'_> {
        Media { bodies: &self.bodies, contacts: &self.contacts, eye: &self.eye }
    }
}

/// Renders `tiles` of a scene from which effects have already been left out. Returns each thread's results and counts.
fn render_tiles<I: Intersector>(
    scene: &Scene,
    accel: &I,
    facts: &SceneFacts,
    options: &Options,
    observer: &Observer,
    tiles: &[Tile],
    done: &(dyn Fn(&Tile) + Sync),
) -> Result<Vec<(Vec<TileResult>, ThreadCounts)>> {
    let tolls = Ceiling::asked(scene, options)?;
    let (stages, media) = (facts.stages(scene, options), facts.media());
    let next = AtomicUsize::new(0);
    let samples = scene.settings.samples * scene.settings.samples;

    let work = || -> Result<(Vec<TileResult>, ThreadCounts)> {
        let mut worker = Worker::new(scene, accel, &stages, options, tolls.as_ref(), &media, observer);
        worker.shading.shafts = facts.shafts.as_ref();
        worker.shading.shine = Some(&facts.shine);
        if let Some(mirrors) = &facts.mirrors {
            worker.shading.passes = Passes::new(mirrors, options.mirror_levels);
        }
        if let Some(images) = &facts.images {
            worker.shading.virtual_rays = VirtualRays::new(images);
        }
        worker.shading.flats = facts.flats.as_ref();
        worker.shading.bodies = facts.refracting.as_ref();
        worker.shading.maps = facts.maps.as_ref().map(|taken| &*taken.maps);
        let mut results = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(&tile) = tiles.get(number) else { break };
            worker.tile(&tile)?;
            let pixels = (0..tile.pixels()).map(|i| worker.shading.accumulator.mean(i, samples)).collect();
            results.push(TileResult { number, tile, pixels });
            done(&tile);
        }
        Ok((results, ThreadCounts::of(&worker)))
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
        // The calling thread renders, too.
        let mine = work();
        let mut parts: Vec<_> = spawned?.into_iter().map(|t| t.join().expect("a worker does not panic")).collect();
        parts.push(mine);
        parts.into_iter().collect::<Result<Vec<_>>>()
    })
}

/// Renders one pixel, given by column and row from 0 at the upper left, and records all of its rays. Radiance and
/// truncated weight equal those of [`render`], to the bit.
///
/// # Errors
/// - [`Error::Interrupted`] if the observer requests a stop.
/// - [`Error::Unsupported`] if rays carry polarisation or budgets.
pub fn recorded<I: Intersector>(
    scene: &Scene,
    accel: &I,
    options: &Options,
    observer: &Observer,
    (x, y): (u32, u32),
) -> Result<([f32; 3], [f32; 3], record::Tree)> {
    let scene = &*effects::without(scene, options.effects.without);
    let facts = SceneFacts::of(scene, accel, options);
    let (stages, media) = (facts.stages(scene, options), facts.media());
    if stages.carries {
        return Err(Unsupported::RecordOfCarried.into());
    }
    let mut worker = Worker::new(scene, accel, &stages, options, None, &media, observer);
    worker.shading.shine = Some(&facts.shine);
    worker.shading.flats = facts.flats.as_ref();
    let tree = record::record(&mut worker, &Tile { x, y, width: 1, height: 1 })?;
    let samples = scene.settings.samples * scene.settings.samples;
    let PixelMean { radiance, truncated, .. } = worker.shading.accumulator.mean(0, samples);
    Ok((radiance, truncated, tree))
}

/// Finds the touching surfaces of a scene, unless that effect is left out.
fn contacts(scene: &Scene, options: &Options) -> (Contacts, TouchingFound) {
    if options.effects.without.has(Effect::Touching) {
        return Default::default();
    }
    let start = Instant::now();
    let contacts = effects::contacts(scene);
    let found = TouchingFound { pairs: contacts.pairs().len(), time: start.elapsed() };
    (contacts, found)
}

/// Counts of one thread.
#[derive(Default)]
struct ThreadCounts {
    rays: RayCounts,
    non_finite: u64,
    clamped: u64,
    unmatched_exits: UnmatchedExits,
    streams: StreamCounts,
    seen: Seen,
    planar: PlanarCounts,
    without_map: u64,
    without_image: u64,
    without_body_map: u64,
}

impl ThreadCounts {
    fn of<I: Intersector>(worker: &Worker<I>) -> Self {
        Self {
            rays: worker.shading.counts.clone(),
            non_finite: worker.shading.accumulator.non_finite,
            clamped: worker.shading.accumulator.clamped,
            unmatched_exits: worker.shading.unmatched_exits.clone(),
            streams: worker.shading.streams,
            seen: worker.seen(),
            planar: PlanarCounts::of(&worker.shading.passes),
            without_map: worker.shading.without_map,
            without_image: worker.shading.virtual_rays.traced,
            without_body_map: worker.shading.without_body_map,
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
        self.without_map += o.without_map;
        self.without_image += o.without_image;
        self.without_body_map += o.without_body_map;
    }
}
