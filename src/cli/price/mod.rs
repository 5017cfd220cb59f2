//! `vitrum price`.

pub(super) mod args;
pub(super) mod options;

use std::path::Path;
use std::sync::Arc;

use self::options::Price;
use super::verdict::Verdict;
use super::{backend, interrupt, output, progress, repeat};
use crate::accel::embree;
use crate::image::{self, Bits, Destination, Encoding, Film, Format, ReadOptions};
use crate::measure::Machine;
use crate::render::Observer;
use crate::study::html::{self, Pair, References};
use crate::study::{self, Report, Subject, Variant, Watch};
use crate::system::files;
use crate::{Error, Result};

/// Loads the scene, runs the study, writes and reports.
pub(super) fn run(job: Price) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.threads)?;
    let mut scene = job.reading.load(&job.scene, false)?.scene;
    scene.settings.samples = job.samples;
    let subject = Subject {
        scene: &scene,
        path: &job.scene,
        default: Variant { bvh: job.bvh, ..Variant::of(&scene.settings, job.backend) },
        size: job.size,
        threads: job.threads,
        axes: job.axes.clone(),
        limit: job.limit,
        runs: job.runs,
        combine: job.combine,
        command: repeat::own_command(),
        repeat: repeat::command,
        machine: Machine::this(embree::installed().ok()),
    };
    let report = progress::session(job.limit, !job.quiet, |say| {
        interrupt::heeded(|| {
            let report = study::run::run(&subject, &job.folder, job.fresh, &Watch { observer: &observer, say });
            interrupt::wait_for_the_end();
            report
        })
    })?;
    write(&job, &report)?;
    if job.json {
        output::print_json(&report)?;
    } else if !job.quiet {
        output::print(&study::text::report(&report))?;
        output::log(&format!("\n{}", job.folder.join("report.html").display()));
    }
    if observer.stop.load(std::sync::atomic::Ordering::SeqCst) {
        output::log("what was done is kept; the same command goes on");
        return Err(Error::Interrupted);
    }
    Ok(Verdict::Done)
}

/// Writes the report in its forms, and the pictures if requested.
fn write(job: &Price, report: &Report) -> Result<()> {
    output::save_json(&job.folder.join("report.json"), report)?;
    output::save(&job.folder.join("report.csv"), study::csv::table(report).as_bytes())?;
    output::save(&job.folder.join("report.html"), page(&job.folder, report)?.as_bytes())?;
    if job.pictures {
        pictures(&job.folder, report)?;
    }
    Ok(())
}

/// Returns the page with the pictures that the study keeps.
fn page(folder: &Path, report: &Report) -> Result<String> {
    let film = |name: &String| kept(folder, name).ok();
    let references = References {
        own: report.own.as_ref().and_then(|made| film(&made.film)),
        fine: report.fine.as_ref().and_then(|made| film(&made.film)),
    };
    let pairs: Vec<Option<Pair>> = report
        .rows
        .iter()
        .map(|row| {
            let beside = if row.own.is_some() { &references.own } else { &references.fine };
            Some(Pair { film: film(&row.film)?, reference: beside.clone() })
        })
        .collect();
    html::page(report, &pairs, &references)
}

fn kept(folder: &Path, name: &str) -> Result<Film> {
    Ok(image::read(&folder.join("study").join(name), &ReadOptions::default())?.film)
}

/// Writes a PNG and an EXR of each variant.
fn pictures(folder: &Path, report: &Report) -> Result<()> {
    let to = folder.join("pictures");
    files::create_folder(&to)?;
    let references = [("reference", &report.own), ("reference 16x16", &report.fine)];
    let references =
        references.into_iter().filter_map(|(name, made)| made.as_ref().map(|m| (name, &m.film, &m.variant)));
    for (name, film, variant) in report.rows.iter().map(|r| (r.name.as_str(), &r.film, &r.levels)).chain(references) {
        let film = kept(folder, film)?;
        let name: String =
            name.replace(", ", "_").chars().map(|c| if c.is_alphanumeric() || c == '_' { c } else { '-' }).collect();
        let metadata = vec![(String::from("vitrum:options"), repeat::options(variant))];
        for (extension, format) in [("png", Format::Png), ("exr", Format::Exr)] {
            let encoding = Encoding { format, bits: Bits::Eight, metadata: metadata.clone() };
            let file = Destination::new(&to.join(format!("{name}.{extension}")))?;
            file.write(&image::encode(&film, &encoding)?.bytes, || true)?;
        }
    }
    Ok(())
}
