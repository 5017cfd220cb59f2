//! `vitrum price --reflections`.

pub(super) mod options;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use self::options::Reflections;
use super::verdict::Verdict;
use super::{backend, interrupt, output, repeat};
use crate::accel::embree;
use crate::load::{self, LoadOptions};
use crate::measure::Machine;
use crate::measure::table::aligned;
use crate::render::Observer;
use crate::study::reflections::bundled::{SCENES, SYSTEMS};
use crate::study::reflections::{self as study, Row, curves};
use crate::system::files;
use crate::{Error, Result};

/// Writes the bundled scenes, runs every system on them, and writes the page.
pub(super) fn run(job: &Reflections) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.plan.threads)?;
    let scenes = job.folder.join("scenes");
    files::create_folder(&scenes)?;
    for scene in SCENES {
        output::save(&scenes.join(scene.name), scene.text.as_bytes())?;
    }
    let mut rows = Vec::new();
    for system in &SYSTEMS {
        for name in system.scenes {
            if !job.quiet {
                output::log(&format!("{}: {name}", system.name));
            }
            let file = scenes.join(name);
            let scene = load::scene(&file, &LoadOptions::default())?.scene;
            rows.push(study::row(system, scene, &file.display().to_string(), &job.plan, &observer)?);
        }
    }
    let curves = curves(job.plan.threads, &observer)?;
    if observer.stop.load(Ordering::SeqCst) {
        return Err(Error::Interrupted);
    }
    let done = study::Reflections {
        machine: Machine::this(embree::installed().ok()),
        backend: job.plan.backend.name(),
        command: repeat::own_command(),
        rows,
        curves,
    };
    let page = job.folder.join("reflections.html");
    output::save(&page, study::page(&done)?.as_bytes())?;
    output::save_json(&job.folder.join("reflections.json"), &done)?;
    if job.json {
        output::print_json(&done)?;
    } else if !job.quiet {
        output::print(&text(&done.rows))?;
        output::log(&format!("\n{}", page.display()));
    }
    Ok(Verdict::Done)
}

fn text(rows: &[Row]) -> String {
    let head = ["system", "scene", "time", "interval", "rmse", "largest", "off by 1/255"].map(String::from).to_vec();
    let line = |row: &Row| {
        let [low, high] = row.ratio.interval;
        let scene = Path::new(&row.scene).file_name().map_or_else(String::new, |name| name.display().to_string());
        vec![
            row.system.to_owned(),
            scene,
            format!("{:.2}", row.ratio.median),
            format!("{low:.2}-{high:.2}"),
            format!("{:.2e}", row.errors.rmse),
            format!("{:.3}", row.errors.max),
            format!("{:.2} %", 100.0 * row.errors.visible),
        ]
    };
    let lines: Vec<Vec<String>> = std::iter::once(head).chain(rows.iter().map(line)).collect();
    String::from("time over the traced picture's, error against it\n\n") + &aligned(&lines)
}
