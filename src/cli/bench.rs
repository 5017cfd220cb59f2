//! `vitrum bench`.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::options::{Bench, refuse_input};
use super::{Verdict, interrupt, output, progress, view};
use crate::load::{self, LoadOptions, Loaded};
use crate::render::Observer;
use crate::trial::{self, Machine, Outcome, Subject, Watch, machine};
use crate::{Error, Result};

/// Loads, checks, times and reports.
pub(super) fn run(job: &Bench) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    let embree = match machine::embree() {
        Ok(found) => Some(found),
        Err(e) => {
            output::log(&format!("warning: EMBREE IS LEFT OUT, the native path is timed alone. {e}"));
            None
        }
    };
    let subjects: Vec<Subject> = job.scenes.iter().map(|path| subject(path, job)).collect::<Result<_>>()?;
    let watch = Watch { done: &observer.pixels_done, stop: &observer.stop };
    let steps = job.plan.steps(embree.is_some()) * subjects.len() as u64;
    let machine = Machine::this(embree);
    let outcome = progress::follow(&observer, steps, !job.quiet, || {
        interrupt::heeded(|| trial::run::run(&subjects, &job.plan, machine, &watch))
    })?;
    let report = match outcome {
        Outcome::Measured(report, noted) => {
            for finding in noted.iter().filter(|_| !job.quiet) {
                output::log(&format!("note: {finding}"));
            }
            report
        }
        Outcome::Refused(findings) => {
            for finding in findings {
                output::log(&format!("error: {finding}"));
            }
            output::log("error: the contenders do not find the same, so their speed is not compared");
            return Ok(Verdict::Negative);
        }
    };
    if let Some(page) = &job.html {
        let text = trial::html::page(&report);
        page.write(text.as_bytes(), || !observer.stop.load(Ordering::SeqCst))?;
    }
    if job.json {
        output::print_json(&report)?;
    } else if !job.quiet {
        output::print(&trial::text::tables(&report))?;
    }
    Ok(Verdict::Done)
}

/// What one file holds.
fn subject(path: &Path, job: &Bench) -> Result<Subject> {
    let Loaded { scene, .. } = load::scene(path, &LoadOptions::default())?;
    if let Some(page) = &job.html {
        refuse_input("--html", page.name(), scene.textures.iter().map(|t| Path::new(&t.name)))?;
    }
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let view = view::of(&scene);
    let subject = Subject::new(&name, scene.geometry, Some(view));
    if subject.geometry.is_empty() {
        return Err(Error::file(path, "has nothing that a hierarchy holds: no mesh and no sphere"));
    }
    Ok(subject)
}
