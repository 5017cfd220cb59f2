//! `vitrum map`.

pub(super) mod args;
pub(super) mod options;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use glam::Vec3;

use self::options::Map;
use super::options::{Exposure, refuse_input};
use super::verdict::Verdict;
use super::warnings::Warnings;
use super::{backend, interrupt, metadata, output, progress};
use crate::accel::BuildQuality;
use crate::image::{self, Bits, Encoding, MOST_PIXELS};
use crate::render::Observer;
use crate::scene::{Camera, Projection};
use crate::{Error, Result};

/// Loads the scene, captures the map and writes it.
pub(super) fn run(job: &Map) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.options.threads)?;
    let (mut scene, warnings) = Warnings::survey((&job.scene, &job.reading), job.strict, &job.options, &observer)?;
    if !job.quiet {
        warnings.log();
    }
    refuse_input("-o", job.output.name(), scene.textures.iter().map(|t| Path::new(&t.name)))?;
    let eye = ((job.at - scene.origin) / scene.unit()).as_vec3();
    if !eye.is_finite() {
        return Err(Error::Usage(format!(
            "--at: ({}) lies beyond what f32 can hold in the scene; take a nearer place",
            job.at
        )));
    }
    scene.camera =
        Camera { eye, target: eye + Vec3::NEG_Z, up: Vec3::Y, projection: Projection::Map(job.kind), medium: None };
    let [width, height] = job.kind.shape(job.size);
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MOST_PIXELS {
        return Err(Error::Limit(format!(
            "--size: a map of {width} by {height} texels is too large; at most {MOST_PIXELS} texels are rendered"
        )));
    }
    [scene.settings.width, scene.settings.height] = [width, height];
    scene.settings.samples = job.samples.unwrap_or(scene.settings.samples);
    let chosen = backend::fit_for(&scene, job.backend, job.chosen, job.quiet)?;
    let traced = progress::follow(&observer, pixels, !job.quiet, || {
        backend::trace(&scene, chosen, BuildQuality::Default, &job.options, &observer, None)
    })?;
    let library = traced.library.as_deref();
    let metadata = metadata::of(&scene.settings, &job.options, chosen, library, Exposure { ev: 0.0 });
    let encoding = Encoding { format: job.format, bits: Bits::Eight, metadata };
    let encoded = image::encode(&traced.outcome.film, &encoding)?;
    job.output.write(&encoded.bytes, || !observer.stop.load(Ordering::SeqCst))?;
    if !job.quiet {
        let name = job.output.name().display();
        output::log(&format!("map        {name} ({}, {width} x {height}, from {})", job.kind.name(), job.at));
    }
    Ok(Verdict::Done)
}
