//! Whether the rays of a pixel settle its value.

use crate::cli::options::Pixel;
use crate::render::record::Tree;
use crate::render::reference::Prepared;
use crate::scene::Scene;

/// By how much a channel has to move to count, in radiance.
pub(super) const TOLERANCE: f64 = 5e-4;

/// The few ulps of `f32` that a renderer in it may be off by at each surface.
const ULPS: f64 = 8.0;

/// One camera ray's.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(super) struct Condition {
    /// The ray, from 1, row by row.
    pub sample: u32,
    /// The first of 1, 2, 4, ... ulps by which the camera ray moves and the f64 value moves by more than the tolerance;
    /// none up to `looked`.
    pub ulps: Option<f64>,
    /// How far was looked: 8 for each level of the tree.
    pub looked: f64,
}

impl Condition {
    /// Whether a few ulps of f32 move it.
    pub fn is_ill(&self) -> bool {
        self.ulps.is_some()
    }
}

/// The conditions of the rays that are shown.
pub(super) fn of(prepared: &Prepared, scene: &Scene, job: &Pixel, tree: &Tree) -> Vec<Condition> {
    let n = scene.settings.samples;
    let levels = tree.events.iter().map(|event| event.depth).max().unwrap_or(0) + 1;
    let looked = ULPS * f64::from(levels);
    let within = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    (0..n * n)
        .filter(|k| job.sample.is_none_or(|sample| sample == k + 1))
        .map(|k| {
            let (x, y) = (f64::from(job.x) + within(k % n), f64::from(job.y) + within(k / n));
            Condition { sample: k + 1, ulps: prepared.ulps_until_moved(x, y, TOLERANCE, looked), looked }
        })
        .collect()
}
