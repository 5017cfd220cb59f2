//! Reference pictures.

use serde::{Deserialize, Serialize};

use super::axis::{Precision, Spheres};
use super::variant::Variant;
use crate::image::Film;
use crate::optics::{FresnelModel, RefractionModel};
use crate::render::Reflection;
use crate::scene::Scene;
use crate::simd::ReciprocalModel;

/// Smallest depth limit of the exact choices.
const DEPTH: u32 = 64;

/// Largest cut-off of the exact choices.
const CUTOFF: f32 = 1.0 / 65536.0;

/// Edge of the grid of rays per pixel in the reference of the sampling axis.
pub const FINE: u32 = 16;

/// Reference picture with its origin.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Picture.
    pub film: Film,
    /// Origin of the picture.
    pub made: Made,
}

/// Origin of a reference picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Choices.
    pub variant: Variant,
    /// Wall time, in seconds.
    pub seconds: f64,
    /// Mean weight that its own depth limit and cut-off removed.
    pub cut: f64,
    /// Largest weight that they removed from a pixel's channel.
    pub cut_most: f64,
    /// File in the study's folder.
    pub film: String,
}

/// Returns the exact choices: `f64`, the Fresnel equations, Snell's law, traced reflections, exact spheres, a depth
/// limit of at least 64 and a cut-off of at most 1/65536. Rays per pixel and shadow rule are those of `default`. Light
/// is unpolarised unless `default` has polarisation.
#[must_use]
pub fn exact(default: &Variant) -> Variant {
    Variant {
        fresnel: match default.fresnel {
            FresnelModel::Polarised => FresnelModel::Polarised,
            _ => FresnelModel::Exact,
        },
        refraction: RefractionModel::Stable,
        reflection: Reflection::Traced,
        spheres: Spheres::Exact,
        depth: default.depth.max(DEPTH),
        cutoff: if default.proven.is_some() { CUTOFF } else { default.cutoff.min(CUTOFF) },
        proven: None,
        triangles: None,
        reciprocal: ReciprocalModel::Exact,
        precision: Precision::Double,
        ..*default
    }
}

/// Returns the exact choices with polarisation carried along paths, if no medium of the scene disperses light.
#[must_use]
pub fn most_exact(default: &Variant, scene: &Scene) -> Variant {
    let disperses = scene.media.iter().any(crate::scene::Medium::disperses);
    Variant { fresnel: if disperses { FresnelModel::Exact } else { FresnelModel::Polarised }, ..exact(default) }
}

/// Names the choices that determine a reference's own error: precision, Fresnel formula, depth limit, cut-off.
#[must_use]
pub fn named(reference: &Variant) -> String {
    let light = if reference.fresnel == FresnelModel::Polarised { "polarised" } else { "unpolarised" };
    let Variant { precision, depth, cutoff, .. } = reference;
    let precision = if *precision == Precision::Double { "f64" } else { "f32" };
    format!("{precision}, {light}, depth {depth}, cut-off 1/{:.0}", 1.0 / cutoff)
}

/// Returns the variants for 16 by 16 rays per pixel, the best first: the choices of `exact` in `f64`, the same in
/// `f32`, and the default ones.
#[must_use]
pub fn fine(default: &Variant, exact: &Variant) -> [Variant; 3] {
    let single = Variant { precision: Precision::Single, ..*exact };
    [*exact, single, *default].map(|v| Variant { samples: FINE, ..v })
}
