//! `vitrum pixel`: aligns the ray trees of two renderers and reports them.

mod align;
pub(super) mod args;
mod condition;
mod findings;
mod json;
pub(super) mod options;
mod quantity;
mod svg;
mod text;

use std::path::Path;
use std::sync::Arc;

use self::options::Pixel;
use super::backend;
use super::options::refuse_input;
use super::verdict::Verdict;
use super::{interrupt, output};
use crate::accel::reference::Reference;
use crate::accel::{Accel, BuildOptions};
use crate::load::Loaded;
use crate::render::reference::Prepared;
use crate::render::{self, Observer};
use crate::scene::Scene;
use crate::{Error, Result};
use findings::{Findings, Side};

/// Traces the pixel with both renderers, and reports.
pub(super) fn run(job: &Pixel) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.options.threads)?;
    let Loaded { mut scene, .. } = job.reading.load(&job.scene, false)?;
    job.overrides.apply(&mut scene.settings)?;
    check(job, &scene)?;
    if let Some(svg) = &job.svg {
        refuse_input("--svg", svg.name(), scene.textures.iter().map(|t| Path::new(&t.name)))?;
    }

    let narrow = interrupt::heeded(|| narrow(job, &scene, &observer))?;
    Reference::need(&scene.geometry)?;
    let prepared = Prepared::with(&scene, &job.options);
    let (tally, tree) = prepared.recorded(job.x, job.y);
    let wide = Side { radiance: tally.radiance.to_array(), truncated: tally.truncated.to_array(), tree };
    for (side, name) in [(&narrow, "f32"), (&wide, "f64")] {
        if side.tree.left_out > 0 {
            return Err(Error::Limit(format!(
                "more than {} rays follow from this pixel in {name}; take a smaller --depth or a larger --cutoff",
                side.tree.events.len()
            )));
        }
    }
    let rows = align::rows(&narrow.tree, &wide.tree, job.sample);
    let conditions = condition::of(&prepared, &scene, job, &wide.tree);
    let findings = Findings { job, scene: &scene, narrow, wide, rows, conditions };
    if let Some(svg) = &job.svg {
        svg.write(svg::draw(&findings).as_bytes(), || true)?;
    }
    if job.json {
        output::print_json(&json::report(&findings))?;
    } else {
        output::print(&text::report(&findings))?;
    }
    Ok(Verdict::Done)
}

/// Checks that the pixel and the sample exist.
///
/// # Errors
/// Usage if one does not.
fn check(job: &Pixel, scene: &Scene) -> Result<()> {
    let settings = &scene.settings;
    for (value, name, end) in [(job.x, "X", settings.width), (job.y, "Y", settings.height)] {
        if value >= end {
            return Err(Error::Usage(format!(
                "{name} {value}: the picture has {} by {} pixels, so that {name} is 0 to {}",
                settings.width,
                settings.height,
                end - 1
            )));
        }
    }
    let samples = settings.samples * settings.samples;
    match job.sample {
        Some(k) if k > samples => {
            Err(Error::Usage(format!("--sample {k}: a pixel has {samples} here; --samples N makes them N by N")))
        }
        _ => Ok(()),
    }
}

/// Traces the pixel with the renderer that makes pictures.
fn narrow(job: &Pixel, scene: &Scene, observer: &Observer) -> Result<Side> {
    let accel = Accel::build(job.backend, &scene.geometry, BuildOptions { threads: 1, ..BuildOptions::default() })?;
    let (radiance, truncated, tree) = render::recorded(scene, &accel, &job.options, observer, (job.x, job.y))?;
    Ok(Side { radiance: radiance.map(f64::from), truncated: truncated.map(f64::from), tree })
}
