//! `vitrum parity`.

pub(super) mod args;
mod contenders;
pub(super) mod options;
mod pixels;
mod report;
mod single;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use self::options::Parity;
use super::verdict::Verdict;
use super::warnings::Warnings;
use super::{backend, interrupt, output, progress, view};
use crate::accel::reference::Reference;
use crate::optics::FresnelModel;
use crate::render::reference::Prepared;
use crate::render::{self, Observer};
use crate::trial::parity::{Records, Set, judge, sets};
use crate::{Error, Result};
use contenders::Contenders;
use pixels::Pixels;
use report::{Facts, Report};
use single::Single;

/// Loads the scene, traces with every contender, judges and reports. The result is negative if the native path is wrong
/// anywhere.
pub(super) fn run(job: &Parity) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.threads)?;
    let options = render::Options { threads: job.threads, ..render::Options::default() };
    let (mut scene, warnings) = Warnings::survey((&job.scene, &job.reading), job.strict, &options, &observer)?;
    job.picture.fit(&mut scene.settings)?;
    // One ray through the middle of each pixel, so that its value belongs to one ray.
    scene.settings.samples = 1;

    // Twice: for the rays, and for the pictures.
    Reference::need(&scene.geometry)?;
    let reference = Reference::build(&scene.geometry);
    if let Some(ray) = &job.ray {
        let single = Single::of(job, &scene, &reference, ray)?;
        if job.json {
            output::print_json(&single)?;
        } else {
            output::print(&(single.text() + "\n"))?;
        }
        return Ok(if single.passed() { Verdict::Done } else { Verdict::Negative });
    }
    let contenders = Contenders::build(&scene, job.bvh, options.thread_count())?;
    let sets = sets(&reference, &scene.geometry, &view::of(&scene), job.rays);
    Reference::need(&scene.geometry)?;
    let prepared = Prepared::new(&scene, FresnelModel::Exact);

    let rays: usize = sets.iter().map(|set| set.rays.len()).sum();
    let films = contenders.names().len() + 1;
    let size = u64::from(scene.settings.width) * u64::from(scene.settings.height);
    let (records, pixels) = progress::follow(&observer, rays as u64 + size * films as u64, !job.quiet, || {
        interrupt::heeded(|| -> Result<(Vec<Vec<Records>>, Vec<Pixels>)> {
            let records = sets.iter().map(|set| judged(&reference, &contenders, set, &observer));
            let records = records.collect::<Result<_>>()?;
            let truth = render::render(&scene, &reference, &options, &observer)?.film;
            let films = contenders.films(&scene, &options, &observer)?;
            Ok((records, pixels::compare(&prepared, &truth, &films, &observer)?))
        })
    })?;

    if !job.quiet {
        warnings.log();
    }
    let facts = Facts {
        job,
        scene: &scene,
        warnings: &warnings,
        contenders: &contenders,
        sets: &sets,
        records: &records,
        pixels: &pixels,
    };
    let report = Report::of(&facts);
    if job.json {
        output::print_json(&report)?;
    } else {
        output::print(&(report.text() + "\n"))?;
    }
    Ok(if report.passed() { Verdict::Done } else { Verdict::Negative })
}

/// Returns judged answers of every contender to one set.
fn judged(reference: &Reference, contenders: &Contenders, set: &Set, observer: &Observer) -> Result<Vec<Records>> {
    let answers = contenders.ask(set);
    let done = |rays| {
        observer.pixels_done.fetch_add(rays, Ordering::Relaxed);
    };
    judge(reference, set, &answers, &observer.stop, done).ok_or(Error::Interrupted)
}
