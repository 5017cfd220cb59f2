//! Reference renderer: the same picture in scalar `f64`, one ray at a time.
//!
//! It follows the description in `src/README.md` ("What a ray does") and the table of shares in
//! `src/scene/material.rs`. It shares with the eight-wide renderer only definitions that must agree: the formulas of
//! [`crate::optics`] (here in `f64`) and the scene. It makes reference pictures and evaluates single pixels.
//! [`Prepared::radiance_at`] and [`Prepared::radiance_along`] accept any point of the film and any ray.

mod bodies;
mod branch;
mod camera;
mod colour;
mod condition;
mod direct;
mod disperse;
mod divide;
mod images;
mod light;
mod media;
mod mirrored;
mod polarisation;
mod split;
mod surface;
mod tally;
mod trace;

use std::sync::atomic::Ordering::Relaxed;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::ceiling::Ceiling;
use super::maps::{Taken, Taker};
use super::pattern::LampPoints;
use super::planar::{self, PlanarCounts};
use super::record::{Off, Recorder, Tree};
use super::shine::Shine;
use super::{FilmRay, Limit, Observer, Options, Outcome, Reflection, Seen, StreamCounts, TouchingFound};
use crate::accel::BuildStats;
use crate::accel::reference::{Hit64, Ray64, Reference};
use crate::effects::{self, Effect};
use crate::geometry::contact::Contacts;
use crate::image::Film;
use crate::optics::{FresnelModel, RefractionModel, Spectrum};
use crate::scene::{Bodies, Material, Scene};
use crate::system::threads;
use crate::systems::maps::Proxy;
use crate::systems::planar::Mirrors;
use crate::{Error, Result};
use bodies::Bodies64;
use images::Virtual64;
use media::{Filled, MediumStack};
pub use tally::Tally;
use trace::Tracer;

/// Scene prepared for tracing.
#[derive(Debug)]
pub struct Prepared<'a> {
    scene: &'a Scene,
    accel: Reference,
    /// Bodies of transparent objects.
    bodies: Bodies,
    /// Touching surfaces.
    contacts: Contacts,
    touching: TouchingFound,
    fresnel: FresnelModel,
    refraction: RefractionModel,
    reflection: Reflection,
    /// Planar mirrors in which cameras are mirrored, if that is requested, and the largest number of consecutive ones.
    mirrors: Option<Mirrors>,
    mirror_levels: u32,
    /// Maps that reflectors show, if any were taken, and the stand-in for their surroundings.
    maps: Option<Taken>,
    /// Virtual scenes of reflectors, if any were made.
    images: Option<Virtual64>,
    /// Maps of bodies that refracted light is looked up in, if any were taken.
    refracting: Option<Bodies64>,
    /// Planes that raise what lies behind them, if any are asked for.
    flats: Option<Mirrors>,
    proxy: Proxy,
    /// Object that camera rays pass.
    past: Option<u32>,
    /// True if light ends where it would be totally reflected.
    total_is_lost: bool,
    /// Tolls of rays of weight 1, if a proven cut-off is requested, or the reason why there are none.
    tolls: std::result::Result<Option<Ceiling>, String>,
    /// Largest number of reflections and refractions along a path.
    max_depth: u32,
    /// Medium stack of camera rays.
    stack: MediumStack,
    /// Sample points on area lamps.
    points: LampPoints,
    /// Sources beside lamps that light surfaces.
    shine: Shine,
    /// Wavelengths of a pixel's samples.
    spectrum: Spectrum,
}

impl<'a> Prepared<'a> {
    /// Prepares a scene with a Fresnel formula and otherwise default options; see [`Prepared::with`].
    #[must_use]
    pub fn new(scene: &'a Scene, fresnel: FresnelModel) -> Self {
        Self::with(scene, &Options { fresnel, ..Options::default() })
    }

    /// Builds the hierarchy and finds the media around the eye. The caller must first remove effects that the options
    /// leave out of the scene's data ([`effects::without`]).
    #[must_use]
    pub fn with(scene: &'a Scene, options: &Options) -> Self {
        let &Options { fresnel, reflection, mirror_levels, .. } = options;
        let mirrors = planar::mirrors(scene, options);
        let refraction = options.bending();
        let total_is_lost = options.effects.without.has(Effect::TotalInternalReflection);
        let accel = Reference::build(&scene.geometry);
        let bodies = Bodies::of(scene);
        let (contacts, touching) = super::contacts(scene, options);
        let mut stack = media::around_the_eye(scene, &accel, Filled { media: &scene.media, bodies: &bodies });
        if let Some(passed) = options.past.and_then(|object| bodies.of_object(object)) {
            stack.remove(passed);
        }
        let settings = &scene.settings;
        let points = LampPoints::new(&settings.lamps);
        let spectrum = Spectrum::new(settings.wavelengths, settings.samples);
        let tolls = Ceiling::asked(scene, options).map_err(|reason| reason.to_string());
        Self {
            scene,
            accel,
            bodies,
            contacts,
            touching,
            fresnel,
            refraction,
            reflection,
            mirrors,
            mirror_levels,
            maps: None,
            images: None,
            refracting: None,
            flats: (refraction == RefractionModel::Raised).then(|| Mirrors::of(scene)),
            proxy: options.proxy,
            past: options.past,
            total_is_lost,
            tolls,
            max_depth: settings.max_depth,
            stack,
            points,
            shine: Shine::of(scene),
            spectrum,
        }
    }

    /// Prepares as [`Prepared::with`] does, and makes the maps and virtual scenes that the options ask for.
    ///
    /// # Errors
    /// - [`Error::Usage`] if no reflector or body of the scene can have any.
    /// - Errors of the renderer that captures maps.
    pub fn complete(scene: &'a Scene, options: &Options, observer: &Observer) -> Result<Self> {
        let mut prepared = Self::with(scene, options);
        let taker = ByReference { accel: &prepared.accel, observer };
        let maps = Taken::of(scene, options, &taker)?;
        let bodies = Taken::of_bodies(scene, options, &taker)?;
        let images = (options.reflection == Reflection::Virtual && !options.carries())
            .then(|| Virtual64::of(scene))
            .transpose()?;
        let refracting = bodies.map(|taken| Bodies64::new(scene, options.bending(), taken));
        (prepared.maps, prepared.images, prepared.refracting) = (maps, images, refracting);
        Ok(prepared)
    }

    /// Replaces the scene's depth limit.
    #[must_use]
    pub fn with_depth(self, max_depth: u32) -> Self {
        Self { max_depth, ..self }
    }

    /// Returns statistics of the build.
    #[must_use]
    pub fn build_stats(&self) -> BuildStats {
        self.accel.stats()
    }

    /// Returns origin and unit direction of the camera ray through column `x` and row `y` of the film. Both are in
    /// pixels from the upper left corner, so pixel (i, j) is centred at (i + 0.5, j + 0.5).
    #[must_use]
    pub fn camera_ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        camera::ray(&self.scene.camera, &self.scene.settings, x, y)
    }

    /// Returns the radiance at a point of the film, by one ray; the point is as in [`Prepared::camera_ray`].
    #[must_use]
    pub fn radiance_at(&self, x: f64, y: f64) -> [f64; 3] {
        let (origin, dir) = self.camera_ray(x, y);
        self.trace_for(film_ray(x, y), origin, dir).radiance.to_array()
    }

    /// Returns the radiance that arrives at `origin` from the unit direction `dir`, by one ray of depth 0 that starts
    /// in the medium around the eye. Dispersion divides it as a pixel's first ray.
    #[must_use]
    pub fn radiance_along(&self, origin: DVec3, dir: DVec3) -> [f64; 3] {
        self.trace(origin, dir).radiance.to_array()
    }

    /// Returns [`Prepared::radiance_along`] with all counts.
    #[must_use]
    pub fn trace(&self, origin: DVec3, dir: DVec3) -> Tally {
        self.trace_for(FilmRay::default(), origin, dir)
    }

    /// Traces as [`Prepared::trace`] does, with lamps sampled as for the camera ray `film`.
    #[must_use]
    pub fn trace_for(&self, film: FilmRay, origin: DVec3, dir: DVec3) -> Tally {
        self.trace_turned(film, origin, dir, DVec3::ZERO)
    }

    /// Traces as [`Prepared::trace_for`] does, with `shadows_turned` added to the unit direction of every shadow ray. A
    /// shadow that then differs lies within rounding of an edge.
    #[must_use]
    pub fn trace_turned(&self, film: FilmRay, origin: DVec3, dir: DVec3, shadows_turned: DVec3) -> Tally {
        Tracer::trace(self, film, (origin, dir), shadows_turned, &mut Off)
    }

    /// Renders a pixel, by column and row from 0 at the upper left: the mean over its rays, each sampled as [`render`]
    /// samples it.
    #[must_use]
    pub fn tally_of(&self, column: u32, row: u32) -> Tally {
        self.pixel(column, row, &mut Off)
    }

    /// Renders a pixel, by column and row from 0 at the upper left, and records all of its rays.
    #[must_use]
    pub fn recorded(&self, column: u32, row: u32) -> (Tally, Tree) {
        let mut tree = Tree::default();
        let tally = self.pixel(column, row, &mut tree);
        (tally, tree)
    }

    /// Traces one ray through a point of the film, as in [`Prepared::camera_ray`], and records all of its rays.
    #[must_use]
    pub fn recorded_at(&self, x: f64, y: f64) -> Tree {
        let mut tree = Tree::default();
        Tracer::trace(self, film_ray(x, y), self.camera_ray(x, y), DVec3::ZERO, &mut tree);
        tree
    }

    /// Returns the mean over a pixel's regular grid of samples.
    fn pixel<L: Recorder>(&self, column: u32, row: u32, record: &mut L) -> Tally {
        let n = self.scene.settings.samples.max(1);
        let within = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let share = 1.0 / (f64::from(n) * f64::from(n));
        let mut mean = Tally::default();
        for j in 0..n {
            for i in 0..n {
                let (origin, dir) = self.camera_ray(f64::from(column) + within(i), f64::from(row) + within(j));
                let film = FilmRay { pixel: [column, row], sample: j * n + i };
                mean.merge(&Tracer::trace(self, film, (origin, dir), DVec3::ZERO, record), share);
            }
        }
        mean
    }

    /// Returns the media of the scene and the bodies they fill.
    fn filled(&self) -> Filled<'_> {
        Filled { media: &self.scene.media, bodies: &self.bodies }
    }

    fn material(&self, geometry: u32) -> &'a Material {
        &self.scene.materials[self.scene.objects[geometry as usize].material as usize]
    }

    /// Returns the index of a medium at a wavelength in nanometres, or for white light.
    fn ior(&self, medium: u32, nm: Option<f64>) -> f64 {
        let medium = &self.scene.media[medium as usize];
        nm.map_or(medium.ior, |nm| medium.index_at(nm))
    }
}

/// Returns the first camera ray of the pixel that contains a point of the film.
fn film_ray(x: f64, y: f64) -> FilmRay {
    FilmRay { pixel: [x, y].map(|at| at.floor().max(0.0) as u32), sample: 0 }
}

/// Takes maps in `f64`.
struct ByReference<'a> {
    accel: &'a Reference,
    observer: &'a Observer,
}

impl Taker for ByReference<'_> {
    fn picture(&self, view: &Scene, options: &Options) -> Result<Film> {
        if self.observer.stop.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        render(view, options, &Observer::default()).map(|outcome| outcome.film)
    }

    fn distances(&self, from: Vec3, dirs: &[Vec3], object: u32) -> Vec<f32> {
        let ray = |dir: &Vec3| Ray64::new(from.as_dvec3(), dir.as_dvec3());
        dirs.iter().map(|dir| past(self.accel, &ray(dir), object).t as f32).collect()
    }
}

/// Returns the nearest hit on anything but `object`.
fn past(accel: &Reference, ray: &Ray64, object: u32) -> Hit64 {
    let mut ray = *ray;
    loop {
        let hit = accel.closest(&ray);
        if !hit.is_hit() || hit.geometry != object {
            return hit;
        }
        ray.t_min = hit.t;
    }
}

/// One row of the picture.
struct Row {
    radiance: Vec<[f32; 3]>,
    truncated: Vec<[f32; 3]>,
    limits: Vec<Option<Limit>>,
    /// Counts; radiance and weight are in the pixels.
    counts: Tally,
}

/// Renders the whole picture, rows in parallel. The bytes do not depend on the number of threads.
///
/// # Errors
/// - [`Error::Interrupted`] soon after `observer.stop` is set.
/// - [`Error::Limit`] if threads or memory for the picture are not available.
/// - [`Error::Usage`] if a proven cut-off is requested for a scene that has none.
pub fn render(scene: &Scene, options: &Options, observer: &Observer) -> Result<Outcome> {
    super::memory::need(&scene.settings)?;
    let scene = &*effects::without(scene, options.effects.without);
    Reference::need(&scene.geometry)?;
    picture(&Prepared::complete(scene, options, observer)?, options, observer)
}

/// Renders a prepared scene as [`render`] does, with the formulas it was prepared with.
///
/// # Errors
/// Fails as [`render`] does.
pub fn picture(prepared: &Prepared, options: &Options, observer: &Observer) -> Result<Outcome> {
    if let Err(reason) = &prepared.tolls {
        return Err(Error::Usage(reason.clone()));
    }
    let mirrors = prepared.mirrors.as_ref();
    planar::possible(prepared.scene, mirrors)?;
    planar::raisable(prepared.scene, prepared.flats.as_ref())?;
    let pool = threads::pool(options.thread_count())?;
    let settings = &prepared.scene.settings;
    let (width, height) = (settings.width, settings.height);
    let rows: Vec<Row> =
        pool.install(|| (0..height).into_par_iter().map(|y| row(prepared, width, y, observer)).collect::<Result<_>>())?;

    let mut film = Film { width, height, pixels: Vec::new() };
    let mut truncated = Film { width, height, pixels: Vec::new() };
    let mut limits = Vec::new();
    let mut counts = Tally::default();
    for row in rows {
        film.pixels.extend(row.radiance);
        truncated.pixels.extend(row.truncated);
        limits.extend(row.limits);
        counts.merge(&row.counts, 0.0);
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
        streams: StreamCounts::default(),
        touching: prepared.touching,
        seen: Seen {
            objects: (0..prepared.scene.objects.len() as u32).map(|o| counts.met.contains(&o)).collect(),
            missed: counts.missed,
            lit: counts.lit,
        },
        body_maps: prepared.refracting.as_ref().map(|bodies| bodies.report(counts.without_body_map)),
        images: prepared.images.as_ref().map(|images| images.report(counts.without_image)),
        maps: prepared.maps.as_ref().map(|taken| taken.report(counts.without_map)),
        planar: mirrors.map(|mirrors| PlanarCounts::default().of_mirrors(mirrors)),
    })
}

fn row(prepared: &Prepared, width: u32, y: u32, observer: &Observer) -> Result<Row> {
    let mut row = Row { radiance: Vec::new(), truncated: Vec::new(), limits: Vec::new(), counts: Tally::default() };
    for x in 0..width {
        if observer.stop.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        let pixel = prepared.pixel(x, y, &mut Off);
        row.radiance.push(pixel.radiance.as_vec3().to_array());
        row.truncated.push(pixel.truncated.as_vec3().to_array());
        row.limits.push(pixel.limit());
        row.counts.merge(&pixel, 0.0);
        observer.pixels_done.fetch_add(1, Relaxed);
    }
    Ok(row)
}
