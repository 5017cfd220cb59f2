//! `vitrum render`.

pub(super) mod args;
mod budget;
pub(super) mod options;
mod picture;
mod summary;
mod systems;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use self::options::Render;
use self::picture::picture;
use self::summary::{Facts, Seconds, Summary};
use super::backend::{self, Traced};
use super::options::{Exposure, refuse_input};
use super::unmatched::Unmatched;
use super::verdict::Verdict;
use super::warnings::{self, Warnings};
use super::{interrupt, metadata, output};
use crate::image::{self, Encoding, Film};
use crate::load::{self, LoadOptions, LoadReport, Loaded};
use crate::notices;
use crate::render::Observer;
use crate::scene::Scene;
use crate::study::spheres::with_spheres;
use crate::study::{Axis, Spheres};
use crate::{Error, Result};

/// Loads the scene, renders, writes and reports.
pub(super) fn run(mut job: Render) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.options.threads)?;

    let start = Instant::now();
    let files = LoadOptions { camera: job.camera.clone(), ..job.reading.options(&job.scene, job.strict)? };
    let Loaded { mut scene, report } = load::scene(&job.scene, &files)?;
    job.overrides.apply(&mut scene.settings)?;
    refuse_input("-o", job.output.name(), scene.textures.iter().map(|t| Path::new(&t.name)))?;
    let load_time = start.elapsed();

    let notices = notices::of_scene(&facts(&job, &scene, &report));
    if job.strict {
        warnings::refuse(&notices)?;
    }
    job.backend = backend::fit_for(&scene, job.backend, job.fixed.contains(&Axis::Backend), job.quiet)?;
    let (mut traced, spent) = match job.wish {
        Some(wish) => {
            let (traced, spent) = budget::render(&mut job, &mut scene, wish, &observer)?;
            (traced, Some(spent))
        }
        None => {
            if job.spheres != Spheres::Exact {
                scene = with_spheres(&scene, job.spheres);
            }
            (picture(&job, &scene, &observer)?, None)
        }
    };
    let found = notices::of_picture(&facts(&job, &scene, &report), &traced.outcome);
    if job.strict {
        warnings::refuse(&found)?;
        refuse_losses(&job.scene, &traced, &Unmatched::of(&traced.outcome, &scene, &report, job.backend))?;
    }
    let warnings = Warnings::new(&report, [notices, found].concat());

    let start = Instant::now();
    expose(&mut traced.outcome.film, job.exposure);
    let clipped = interrupt::heeded(|| write(&job, &scene, &traced, &observer))?;
    let write_time = start.elapsed();

    let verdict = if spent.as_ref().is_none_or(|s| s.kept) { Verdict::Done } else { Verdict::Negative };
    if job.quiet && !job.json {
        return Ok(verdict);
    }
    let summary = Summary::of(&Facts {
        job: &job,
        scene: &scene,
        report: &report,
        warnings: &warnings,
        traced: &traced,
        clipped,
        budget: spent.as_ref(),
        seconds: Seconds {
            load: load_time.as_secs_f64(),
            build: traced.build_time.as_secs_f64(),
            render: traced.render_time.as_secs_f64(),
            write: write_time.as_secs_f64(),
        },
    });
    if !job.quiet {
        output::log(&summary.text());
    }
    if job.json {
        output::print_json(&summary)?;
    }
    Ok(verdict)
}

fn facts<'a>(job: &'a Render, scene: &'a Scene, report: &'a LoadReport) -> notices::Facts<'a> {
    notices::Facts { file: &job.scene, scene, report, options: &job.options }
}

/// Loss for which the worst object is named.
const NEVER_ENTERED: &str = "rays left a medium that they never entered";

/// Under `--strict`, refuses losses of the picture that its settings do not explain.
fn refuse_losses(scene: &Path, traced: &Traced, unmatched: &Unmatched) -> Result<()> {
    let outcome = &traced.outcome;
    let dropped = traced.build.map_or(0, |b| b.dropped as u64);
    for (count, what) in [
        (dropped, "primitives cannot be hit (not finite, too large or without area) and were dropped"),
        (outcome.non_finite, "contributions to the picture are not finite and were left out"),
        (outcome.clamped, "contributions to the picture are too large and were clamped"),
        (unmatched.exits, NEVER_ENTERED),
    ] {
        if count > 0 {
            let worst = unmatched.worst().filter(|_| what == NEVER_ENTERED).map_or(String::new(), |w| format!(", {w}"));
            return Err(Error::file(scene, format!("{count} {what}{worst}; --strict allows none")));
        }
    }
    Ok(())
}

fn expose(film: &mut Film, exposure: Exposure) {
    if exposure.ev != 0.0 {
        let factor = exposure.factor();
        film.pixels.as_flattened_mut().iter_mut().for_each(|x| *x *= factor);
    }
}

fn write(job: &Render, scene: &Scene, traced: &Traced, observer: &Observer) -> Result<image::Clipped> {
    let library = traced.library.as_deref();
    let metadata = metadata::of(&scene.settings, &job.options, job.backend, library, job.exposure);
    let encoded = image::encode(&traced.outcome.film, &Encoding { format: job.format, bits: job.bits, metadata })?;
    job.output.write(&encoded.bytes, || !observer.stop.load(Ordering::SeqCst))?;
    Ok(encoded.clipped)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::accel::BuildStats;
    use crate::render::{Outcome, RayCounts, Seen, StreamCounts, TouchingFound};

    #[test]
    fn strict_lets_nothing_pass_that_was_dropped_clamped_or_left_unmatched() {
        let traced = |dropped, non_finite, clamped, unmatched_exits| Traced {
            outcome: Outcome {
                film: Film::default(),
                truncated: Film::default(),
                limits: Vec::new(),
                shortfall: None,
                rays: RayCounts::default(),
                non_finite,
                clamped,
                unmatched_exits,
                unmatched_objects: Vec::new(),
                streams: StreamCounts::default(),
                seen: Seen::default(),
                touching: TouchingFound::default(),
                planar: None,
                maps: None,
                images: None,
                body_maps: None,
            },
            build: Some(BuildStats { dropped, ..BuildStats::default() }),
            build_time: Duration::ZERO,
            render_time: Duration::ZERO,
            library: None,
            lanes: None,
        };
        let refused = |traced: &Traced| {
            let unmatched = Unmatched { exits: traced.outcome.unmatched_exits, objects: Vec::new() };
            refuse_losses(Path::new("a.toml"), traced, &unmatched).map_err(|e| (e.exit_code(), e.to_string()))
        };
        assert_eq!(refused(&traced(0, 0, 0, 0)), Ok(()));
        for (lossy, word) in [
            (traced(7, 0, 0, 0), "7 primitives"),
            (traced(0, 7, 0, 0), "not finite"),
            (traced(0, 0, 7, 0), "clamped"),
            (traced(0, 0, 0, 7), "never entered"),
        ] {
            let (code, message) = refused(&lossy).unwrap_err();
            assert_eq!(code, 2);
            assert!(message.starts_with("a.toml: 7 ") && message.contains(word), "{message}");
        }
    }
}
