//! The notes' systems on the bundled scenes (`vitrum price --reflections`): each beside the traced picture, with its error,
//! its time, and the places where it fails.

pub mod bundled;
mod curves;
mod page;

pub use curves::{Curves, curves};
pub use page::page;

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::errors::{Errors, off};
use crate::accel::{Accel, Backend, BuildOptions};
use crate::image::Film;
use crate::measure::{Figure, Machine};
use crate::render::{Observer, Options, Outcome, first_hits, render};
use crate::scene::Scene;
use crate::{Error, Result};
use bundled::System;

/// Difference between neighbours from which a pixel of the traced picture lies at an edge.
const EDGE: f64 = 0.05;

/// Objects that a row names as the places of its error.
const PLACES: usize = 3;

/// Rounds of a row that are timed even if they take long.
const FEWEST_ROUNDS: usize = 3;

/// Time of a row's rounds after which no further one begins.
const ENOUGH: Duration = Duration::from_secs(6);

/// One system on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the system.
    pub system: &'static str,
    /// File of the scene.
    pub scene: String,
    /// Command that repeats the picture.
    pub command: String,
    /// Its time over that of the traced picture, with all that it prepares.
    pub ratio: Figure,
    /// Seconds of the traced picture, median.
    pub traced_seconds: f64,
    /// Share of its time that the capture of maps took; 0 for other systems.
    pub capture: f64,
    /// Errors against the traced picture.
    pub errors: Errors,
    /// Share of the squared error in pixels at edges of the traced picture.
    pub at_edges: f64,
    /// Objects of most of the squared error, by the first hit of a pixel, each with its share.
    pub places: Vec<(String, f64)>,
    /// Counts of the render.
    pub counts: Vec<String>,
    /// Reason why it fails where it does.
    pub why: &'static str,
    #[serde(skip)]
    films: [Film; 2],
}

/// The study.
#[derive(Clone, Debug, Serialize)]
pub struct Reflections {
    /// Machine that it ran on.
    pub machine: Machine,
    /// Back end of all pictures.
    pub backend: &'static str,
    /// Command that started it.
    pub command: String,
    /// All rows, a system after the other.
    pub rows: Vec<Row>,
    /// Errors by distance, angle and tessellation.
    pub curves: Curves,
}

/// Settings of a study.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Back end of all pictures.
    pub backend: Backend,
    /// Columns and rows of each picture.
    pub size: [u32; 2],
    /// N by N rays a pixel.
    pub samples: u32,
    /// Timed rounds of each row, at least one.
    pub runs: usize,
    /// Worker threads; 0 means one a processor.
    pub threads: usize,
    /// Command that repeats a system's picture of a scene.
    pub repeat: fn(&System, &str, &Self) -> String,
}

/// Compares one system with the traced picture of a scene from `file`.
///
/// # Errors
/// - [`Error::Interrupted`] if the observer requests a stop.
/// - Errors of the renderer.
pub fn row(system: &System, mut scene: Scene, file: &str, plan: &Plan, observer: &Observer) -> Result<Row> {
    let settings = &mut scene.settings;
    ([settings.width, settings.height], settings.samples) = (plan.size, plan.samples);
    let build = BuildOptions { threads: plan.threads, ..BuildOptions::default() };
    let accel = Accel::build(plan.backend, &scene.geometry, build)?;
    let options = system.options(plan.threads);
    let plain = Options { threads: plan.threads, ..Options::default() };
    let timed = |options: &Options| -> Result<(Outcome, f64)> {
        let start = Instant::now();
        let outcome = render(&scene, &accel, options, observer)?;
        Ok((outcome, start.elapsed().as_secs_f64()))
    };
    // The first round warms up and is not counted.
    let ((outcome, _), (traced, _)) = (timed(&options)?, timed(&plain)?);
    let (mut ratios, mut seconds) = (Vec::new(), Vec::new());
    let start = Instant::now();
    for round in 0..plan.runs.max(1) {
        if round >= FEWEST_ROUNDS && start.elapsed() > ENOUGH {
            break;
        }
        if observer.stop.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        // They take turns at going first.
        let (own, other) = if round % 2 == 0 {
            let own = timed(&options)?.1;
            (own, timed(&plain)?.1)
        } else {
            let other = timed(&plain)?.1;
            (timed(&options)?.1, other)
        };
        ratios.push(own / other);
        seconds.push(other);
    }
    let (ratio, traced_seconds) = (Figure::of(&ratios), Figure::of(&seconds).median);
    let taken = [&outcome.maps, &outcome.body_maps].into_iter().flatten().map(|maps| maps.time.as_secs_f64());
    let taken = taken.fold(0.0, |sum, seconds| sum + seconds);
    let capture = (taken / (ratio.median * traced_seconds)).min(1.0);
    let errors = Errors::of(&outcome.film, &traced.film, None)?;
    let (at_edges, places) = places(&scene, &accel, &outcome.film, &traced.film)?;
    let counts = counts(&outcome);
    Ok(Row {
        system: system.name,
        scene: file.to_owned(),
        command: (plan.repeat)(system, file, plan),
        ratio,
        traced_seconds,
        capture,
        errors,
        at_edges,
        places,
        counts,
        why: system.why,
        films: [outcome.film, traced.film],
    })
}

/// Returns the share of the squared error at edges, and the objects with most of it.
fn places(scene: &Scene, accel: &Accel, film: &Film, traced: &Film) -> Result<(f64, Vec<(String, f64)>)> {
    let (width, height) = (traced.width as usize, traced.height as usize);
    let hits = first_hits(scene, accel)?;
    let (mut edges, mut all) = (0.0, 0.0);
    let mut by_object = vec![0.0; scene.objects.len() + 1];
    for (p, hit) in hits.iter().enumerate() {
        let square = off(film.pixels[p], traced.pixels[p]).powi(2);
        all += square;
        by_object[hit.object.map_or(scene.objects.len(), |o| o as usize)] += square;
        let (x, y) = (p % width, p / width);
        let around = [
            (x > 0, p.wrapping_sub(1)),
            (x + 1 < width, p + 1),
            (y > 0, p.wrapping_sub(width)),
            (y + 1 < height, p + width),
        ];
        let edge = around.iter().any(|&(there, q)| there && off(traced.pixels[p], traced.pixels[q]) > EDGE);
        edges += if edge { square } else { 0.0 };
    }
    if all == 0.0 {
        return Ok((0.0, Vec::new()));
    }
    let name =
        |o: usize| scene.objects.get(o).map_or_else(|| String::from("environment"), |object| object.name.clone());
    let mut places: Vec<(String, f64)> = by_object.iter().enumerate().map(|(o, sum)| (name(o), sum / all)).collect();
    places.sort_by(|a, b| b.1.total_cmp(&a.1));
    places.retain(|(_, share)| *share > 0.005);
    places.truncate(PLACES);
    Ok((edges / all, places))
}

/// Returns the counts of a render that belong to its system.
fn counts(outcome: &Outcome) -> Vec<String> {
    let mut counts = Vec::new();
    if let Some(planar) = &outcome.planar {
        counts.push(format!(
            "{} planes, {} levels, {} reflections in or through other things traced",
            planar.mirrors,
            planar.levels.len(),
            planar.elsewhere
        ));
    }
    for maps in [&outcome.maps, &outcome.body_maps].into_iter().flatten() {
        counts.push(format!("{} maps, {} rays traced for want of a map", maps.maps.list.len(), maps.traced));
    }
    if let Some(images) = &outcome.images {
        let points = images.points;
        counts.push(format!(
            "{} triangles, {} of {} points seen, {} without a reflection point, {} with several, {} inside a reflector; {} \
             triangles left out, {} reflections traced",
            images.triangles,
            points.seen,
            points.all,
            points.none,
            points.several,
            points.inside,
            images.left_out,
            images.traced
        ));
    }
    counts
}
