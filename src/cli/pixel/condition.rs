//! Condition of a pixel: the change of its value when its camera rays move by a few ulps.

use super::options::Pixel;
use crate::render::record::Tree;
use crate::render::reference::Prepared;
use crate::scene::Scene;

/// Change of a channel that counts, in radiance.
pub(super) const TOLERANCE: f64 = 5e-4;

/// Error of an `f32` renderer at each surface, in ulps.
const ULPS: f64 = 8.0;

/// Condition of one camera ray.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(super) struct Condition {
    /// Number of the ray, from 1, row by row.
    pub sample: u32,
    /// Smallest movement of the camera ray, among 1, 2, 4, ... ulps up to `looked`, at which the f64 value changes by
    /// more than the tolerance. `None` if none does.
    pub ulps: Option<f64>,
    /// Largest movement that was tested, in ulps: 8 for each level of the tree.
    pub looked: f64,
}

impl Condition {
    /// Returns true if a few ulps of f32 change the value.
    pub fn is_ill(&self) -> bool {
        self.ulps.is_some()
    }
}

/// Computes the conditions of the rays that are shown.
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
