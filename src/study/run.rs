//! A study from start to end, or until time runs out or the user stops it.

use std::path::Path;
use std::time::Instant;

use super::condition::Condition;
use super::engine::Engine;
use super::errors::VISIBLE;
use super::journal::{Header, Journal};
use super::plan::LeftOut;
use super::report::{self, Pictured, Report};
use super::session::Session;
use super::subject::{Subject, Watch};
use super::{digest, reference, size};
use crate::accel::reference::Reference as Arbiter;
use crate::render::reference::Prepared;
use crate::scene::Scene;
use crate::system::threads;
use crate::{Error, Result};

/// Measures everything that the journal of `folder` lacks, and reports on all measurements. If the user stops it, the
/// report says that the study is unfinished.
///
/// # Errors
/// - `Error::Io` if a file cannot be read or written.
/// - `Error::Unsupported` if the folder contains another study.
/// - `Error::Limit` if the default back end is not available.
/// - `Error::Interrupted` if stopped before there is anything to report.
pub fn run(subject: &Subject, folder: &Path, fresh: bool, watch: &Watch) -> Result<Report> {
    let start = Instant::now();
    let digest = digest::of(subject);
    let mut journal = Journal::open(folder, &digest, fresh)?;
    let [width, height] = match &journal.header {
        Some(header) => [header.width, header.height],
        None => {
            (watch.say)("choosing a size");
            let [width, height] = size::choose(subject, watch.observer)?;
            journal.begin(Header { digest, width, height })?;
            [width, height]
        }
    };
    let mut scene = subject.scene.try_clone()?;
    (scene.settings.width, scene.settings.height) = (width, height);
    scene.settings = subject.default.settings(&scene.settings);
    let exact = reference::most_exact(&subject.default, &scene);
    let judge = Scene { settings: exact.settings(&scene.settings), ..scene.try_clone()? };
    Arbiter::need(&judge.geometry)?;
    let condition = Condition::new(&judge, Prepared::new(&judge, exact.fresnel), VISIBLE, watch.observer);
    let mut session = Session {
        subject,
        engine: Engine::new(&scene, subject.threads),
        condition,
        journal,
        watch: *watch,
        start,
        left_out: Vec::new(),
        late: Vec::new(),
        portion: (1.0, 1),
        default_film: None,
    };
    let finished = match session.all() {
        Ok(()) => !session.late(),
        Err(Error::Interrupted) if session.journal.find(&subject.default).is_some() => false,
        Err(e) => return Err(e),
    };
    let size = [width, height];
    let rows = report::rows(&session.journal, &subject.default, |v| (subject.repeat)(v, subject.path, size));
    let counts = scene.shape_counts();
    let mut left_out: Vec<String> = session.left_out.iter().map(LeftOut::to_string).collect();
    if !session.late.is_empty() {
        left_out.push(format!("the time limit of {:.0} s: {}", subject.limit.as_secs_f64(), session.late.join("; ")));
    }
    if watch.observer.stop.load(std::sync::atomic::Ordering::Relaxed) {
        left_out.insert(0, String::from("all that was not reached when the study was ended; the same command goes on"));
    }
    let judged = session.journal.own.is_some();
    Ok(Report {
        machine: subject.machine.clone(),
        threads: threads::count(subject.threads),
        command: subject.command.clone(),
        subject: Pictured {
            scene: subject.path.display().to_string(),
            width,
            height,
            triangles: counts.triangles,
            spheres: counts.spheres,
            planes: counts.planes,
        },
        finished: finished && judged,
        limit: subject.limit.as_secs_f64(),
        own: session.journal.own.map(|r| r.made),
        fine: session.journal.fine.map(|r| r.made),
        findings: report::findings(&rows),
        rows,
        left_out,
    })
}
