//! Promise: the choices of a render that have a price do what they say, in every renderer.

use crate::support;

#[cfg(feature = "cli")]
mod command;
mod cutoff;
mod formula;
mod polarisation;
mod random;
mod reflection;
mod triangles;

use vitrum::render::{Observer, Options, Outcome, reference};
use vitrum::scene::Scene;

/// Every renderer's outcome, with its name.
fn outcomes(scene: &Scene, options: &Options) -> Vec<(&'static str, Outcome)> {
    let by_reference = reference::render(scene, options, &Observer::default()).expect("nobody interrupts a test");
    let mut all = vec![("reference", by_reference), ("native", support::scenes::native(scene, options))];
    if let Some(accel) = support::backends::embree(vitrum::accel::Backend::Embree, &scene.geometry) {
        let outcome = vitrum::render::render(scene, &accel, options, &Observer::default()).expect("as above");
        all.push(("embree", outcome));
    }
    all
}
