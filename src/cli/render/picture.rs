//! The picture of one set of options.

use super::options::Render;
use crate::Result;
use crate::cli::backend::{self, Traced};
use crate::cli::progress;
use crate::render::Observer;
use crate::scene::Scene;

/// Renders with a progress bar. Without a budget, also searches for missing light.
pub(super) fn picture(job: &Render, scene: &Scene, observer: &Observer) -> Result<Traced> {
    let exposure = job.wish.is_none().then(|| job.exposure.factor());
    let pixels = u64::from(scene.settings.width) * u64::from(scene.settings.height);
    progress::follow(observer, pixels, !job.quiet, || {
        backend::trace(scene, job.backend, job.bvh, &job.options, observer, exposure)
    })
}
