//! From the choice of a back end to the picture it makes.

use std::time::{Duration, Instant};

use super::interrupt;
use super::options::Backend;
use crate::accel::{BuildStats, Intersector as _, Unbounded, native::Native};
use crate::render::{self, Observer, Options, Outcome};
use crate::scene::Scene;
use crate::{Error, Result};

/// A picture and what it took.
pub(super) struct Traced {
    pub outcome: Outcome,
    /// What was built; none where the back end builds as part of its render.
    pub build: Option<BuildStats>,
    pub build_time: Duration,
    pub render_time: Duration,
}

/// Builds what `backend` needs and renders.
///
/// # Errors
/// `Interrupted`; a limit, where threads cannot be started.
pub(super) fn trace(scene: &Scene, backend: Backend, options: &Options, observer: &Observer) -> Result<Traced> {
    // Trees are built by rayon's own threads.
    rayon::ThreadPoolBuilder::new()
        .num_threads(options.thread_count())
        .build_global()
        .map_err(|e| Error::Limit(format!("cannot start {} threads: {e}", options.thread_count())))?;
    let start = Instant::now();
    match backend {
        Backend::Native => {
            let accel = Unbounded::new(Native::build(&scene.geometry), &scene.geometry);
            let build_time = start.elapsed();
            let outcome = interrupt::heeded(|| render::render(scene, &accel, options, observer))?;
            let render_time = start.elapsed() - build_time;
            Ok(Traced { outcome, build: Some(accel.build_stats()), build_time, render_time })
        }
        Backend::Reference => {
            let outcome = interrupt::heeded(|| render::reference::render(scene, options, observer))?;
            Ok(Traced { outcome, build: None, build_time: Duration::ZERO, render_time: start.elapsed() })
        }
    }
}
