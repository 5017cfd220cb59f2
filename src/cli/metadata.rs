//! What a picture file says of its own making: what decided its pixels, and nothing that varies from run to run.

use super::backend::Renderer;
use super::options::Exposure;
use crate::optics::{FresnelModel, RefractionModel};
use crate::render::{Options, Reflection};
use crate::scene::{Settings, ShadowRule};
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
        ("vitrum:fresnel", fresnel_name(options.fresnel).into()),
        ("vitrum:refraction", refraction_name(options)),
        ("vitrum:reflection", reflection_name(options.reflection).into()),
        ("vitrum:shadows", shadows_name(settings.shadows).into()),
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

/// The triangle test and the reciprocal, where they were chosen.
fn walk_names(backend: Renderer) -> Option<[(&'static str, String); 2]> {
    let Renderer::Walk(triangles, reciprocal) = backend else { return None };
    let [triangles, reciprocal] = [triangles.name(), reciprocal.name()].map(String::from);
    Some([("vitrum:triangles", triangles), ("vitrum:reciprocal", reciprocal)])
}

/// The name of a Fresnel formula, as the command line has it.
pub(super) fn fresnel_name(model: FresnelModel) -> &'static str {
    match model {
        FresnelModel::Exact => "exact",
        FresnelModel::Polarised => "polarised",
        FresnelModel::Schlick => "schlick",
        FresnelModel::Off => "off",
    }
}

/// The effects left out, with commas between.
fn without_names(options: &Options) -> String {
    options.effects.without.iter().map(|e| e.name()).collect::<Vec<_>>().join(",")
}

/// The name of a refraction formula, as the command line has it, with its constant where it has one.
pub(super) fn refraction_name(options: &Options) -> String {
    match options.refraction {
        RefractionModel::Stable => "stable".into(),
        RefractionModel::Trigonometric => "trigonometric".into(),
        RefractionModel::Heckbert => "heckbert".into(),
        RefractionModel::Bec => "bec".into(),
        RefractionModel::SlidesVector => "slides".into(),
        RefractionModel::Oliveira => format!("oliveira {}", options.oliveira.c),
        RefractionModel::StraightThrough => "straight".into(),
    }
}

/// What becomes of reflected light, as the command line has it.
pub(super) fn reflection_name(reflection: Reflection) -> &'static str {
    match reflection {
        Reflection::Traced => "traced",
        Reflection::Environment => "environment",
        Reflection::None => "none",
    }
}

/// The name of a shadow rule, as the command line has it.
pub(super) fn shadows_name(rule: ShadowRule) -> &'static str {
    match rule {
        ShadowRule::Opaque => "opaque",
        ShadowRule::Straight => "straight",
    }
}
