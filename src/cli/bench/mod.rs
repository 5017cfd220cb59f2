//! `vitrum bench`.

pub(super) mod args;
pub(super) mod options;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use self::options::Bench;
use super::options::refuse_input;
use super::verdict::Verdict;
use super::{interrupt, output, progress, view};
use crate::accel::embree;
use crate::load::Loaded;
use crate::load::shapes::{self, Wave};
use crate::measure::Machine;
use crate::render::Observer;
use crate::scene::Scene;
use crate::trial::frames::FramePlan;
use crate::trial::{self, BenchSubject, Outcome, Watch};
use crate::{Error, Result};

/// Loads the scenes, compares the contenders, times them and reports.
pub(super) fn run(job: &Bench) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    let embree = match embree::installed() {
        Ok(found) => Some(found),
        Err(e) => {
            output::log(&format!("warning: EMBREE IS LEFT OUT, the native path is timed alone. {e}"));
            None
        }
    };
    let machine = Machine::this(embree);
    if job.frames {
        return frames(job, machine, &observer);
    }
    let subjects: Vec<BenchSubject> = if job.sweep.is_empty() {
        job.scenes.iter().map(|path| subject(path, job)).collect::<Result<_>>()?
    } else {
        job.sweep.iter().map(|&triangles| landscape(triangles)).collect()
    };
    let watch = Watch { done: &observer.pixels_done, stop: &observer.stop };
    let steps = job.plan.steps(machine.embree.is_some()) * subjects.len() as u64;
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
    let go_on = || !observer.stop.load(Ordering::SeqCst);
    if let Some(page) = &job.html {
        page.write(trial::html::page(&report).as_bytes(), go_on)?;
    }
    if let Some(picture) = &job.plot {
        picture.write(trial::plot::svg(&report).as_bytes(), go_on)?;
    }
    if job.json {
        output::print_json(&report)?;
    } else if !job.quiet {
        output::print(&trial::text::tables(&report))?;
    }
    Ok(Verdict::Done)
}

/// Reads the shapes of one file.
fn subject(path: &Path, job: &Bench) -> Result<BenchSubject> {
    let Loaded { scene, .. } = job.reading.load(path, false)?;
    if let Some(page) = &job.html {
        refuse_input("--html", page.name(), scene.textures.iter().map(|t| Path::new(&t.name)))?;
    }
    let view = view::of(&scene);
    let subject = BenchSubject::new(&name_of(path), scene.geometry, Some(view));
    if subject.geometry.is_empty() {
        return Err(Error::file(path, "has nothing that a hierarchy holds: no mesh and no sphere"));
    }
    Ok(subject)
}

/// Times whole pictures.
fn frames(job: &Bench, machine: Machine, observer: &Observer) -> Result<Verdict> {
    let load = |path: &PathBuf| -> Result<(String, Scene)> {
        let Loaded { mut scene, .. } = job.reading.load(path, false)?;
        scene.settings.samples = 1;
        Ok((name_of(path), scene))
    };
    let scenes: Vec<_> = job.scenes.iter().map(load).collect::<Result<_>>()?;
    let plan = FramePlan { threads: job.plan.threads.clone(), rounds: job.plan.rounds, bvh: job.plan.bvh };
    let pixels = scenes.iter().map(|(_, s)| u64::from(s.settings.width) * u64::from(s.settings.height)).sum::<u64>();
    let steps = pixels * plan.pictures(machine.embree.is_some());
    let report = progress::follow(observer, steps, !job.quiet, || {
        interrupt::heeded(|| trial::frames::run(&scenes, &plan, machine, observer))
    })?;
    if job.json {
        output::print_json(&report)?;
    } else if !job.quiet {
        output::print(&trial::frames::table(&report))?;
    }
    Ok(Verdict::Done)
}

/// Creates a landscape of waves with about `triangles` triangles: two for each square of a square grid.
fn landscape(triangles: u32) -> BenchSubject {
    let edge = (f64::from(triangles) / 2.0).sqrt().round() as u32;
    let wave = |amplitude, wavelength, direction| Wave { amplitude, wavelength, direction, phase: 40.0 };
    let waves = [wave(0.08, 0.9, 20.0), wave(0.05, 0.47, 75.0), wave(0.02, 0.19, 130.0)];
    let mesh = shapes::heightfield([2.0, 2.0], &waves, 0.0, None, edge).expect("only a solid can be too thin");
    BenchSubject::of_mesh(&format!("landscape-{}", 2 * edge * edge), mesh)
}

fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}
