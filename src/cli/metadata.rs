//! Metadata of a picture file: the options that decided its pixels. Nothing varies from run to run.

use super::backend::Renderer;
use super::options::Exposure;
use crate::render::Options;
use crate::scene::Settings;
use crate::simd::level;

/// Names and values for a picture file.
pub(super) fn of(
    settings: &Settings,
    options: &Options,
    backend: Renderer,
    library: Option<&str>,
    exposure: Exposure,
) -> Vec<(String, String)> {
    [
        ("Software", format!("Vitrum {}", env!("CARGO_PKG_VERSION"))),
        ("vitrum:backend", backend.name().into()),
        ("vitrum:simd", level::BUILT.into()),
        ("vitrum:samples", settings.samples.to_string()),
        ("vitrum:depth", settings.max_depth.to_string()),
        ("vitrum:cutoff", options.cutoff_error.map_or(settings.cutoff.to_string(), |_| String::from("0"))),
        ("vitrum:wavelengths", settings.wavelengths.to_string()),
        ("vitrum:fresnel", options.fresnel.to_string()),
        ("vitrum:refraction", options.refraction.to_string()),
        ("vitrum:reflection", options.reflection.to_string()),
        ("vitrum:shadows", settings.shadows.to_string()),
        ("vitrum:lights-from", settings.lights_from.to_string()),
        ("vitrum:exposure", exposure.ev.to_string()),
    ]
    .into_iter()
    .chain((!options.effects.without.is_empty()).then(|| ("vitrum:without", without_names(options))))
    .chain(options.cutoff_error.map(|error| ("vitrum:cutoff-error", error.to_string())))
    .chain(walk_names(backend).into_iter().flatten())
    .chain(library.map(|version| ("vitrum:library", version.to_owned())))
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

/// Triangle test and reciprocal, if they were chosen.
fn walk_names(backend: Renderer) -> Option<[(&'static str, String); 2]> {
    let Renderer::Walk(triangles, reciprocal) = backend else { return None };
    let [triangles, reciprocal] = [triangles.name(), reciprocal.name()].map(String::from);
    Some([("vitrum:triangles", triangles), ("vitrum:reciprocal", reciprocal)])
}

/// Effects left out, separated by commas.
fn without_names(options: &Options) -> String {
    options.effects.without.iter().map(|e| e.name()).collect::<Vec<_>>().join(",")
}
