//! What pictures are held against.

use serde::{Deserialize, Serialize};

use super::axis::{Precision, Spheres};
use super::variant::Variant;
use crate::image::Film;
use crate::optics::{FresnelModel, RefractionModel};
use crate::render::Reflection;
use crate::scene::Scene;
use crate::simd::ReciprocalModel;

/// Depth limit of the exact choices, at least.
const DEPTH: u32 = 64;

/// Cut-off of the exact choices, at most.
const CUTOFF: f32 = 1.0 / 65536.0;

/// Rays a pixel, squared, of what the sampling axis is judged against.
pub const FINE: u32 = 16;

/// A reference picture and where it is from.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The picture.
    pub film: Film,
    /// What it is.
    pub made: Made,
}

/// How a reference was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Its choices.
    pub variant: Variant,
    /// Wall time, in seconds.
    pub seconds: f64,
    /// Mean weight that even its depth limit and cut-off took.
    pub cut: f64,
    /// The most that they took of a pixel's channel.
    pub cut_most: f64,
    /// Its file in the study's folder.
    pub film: String,
}

/// The exact choices, for light that is not polarised unless `default` says so, with the rays a pixel and the shadow rule of `default`: `f64`, the
/// Fresnel equations, Snell's law, traced reflections, exact spheres, a depth limit of at least 64 and a cut-off of at
/// most 1/65536.
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

/// The same with both polarisations carried along the path, where no medium of the scene disperses light.
#[must_use]
pub fn most_exact(default: &Variant, scene: &Scene) -> Variant {
    let disperses = scene.media.iter().any(crate::scene::Medium::disperses);
    Variant { fresnel: if disperses { FresnelModel::Exact } else { FresnelModel::Polarised }, ..exact(default) }
}

/// Names of the choices of a reference that set its own error: precision, Fresnel formula, depth limit, cut-off.
#[must_use]
pub fn named(reference: &Variant) -> String {
    let light = if reference.fresnel == FresnelModel::Polarised { "polarised" } else { "unpolarised" };
    let Variant { precision, depth, cutoff, .. } = reference;
    let precision = if *precision == Precision::Double { "f64" } else { "f32" };
    format!("{precision}, {light}, depth {depth}, cut-off 1/{:.0}", 1.0 / cutoff)
}

/// What 16 by 16 rays a pixel may be made by, the best first: the choices of `exact` in `f64`, the same in `f32`, the
/// default ones.
#[must_use]
pub fn fine(default: &Variant, exact: &Variant) -> [Variant; 3] {
    let single = Variant { precision: Precision::Single, ..*exact };
    [*exact, single, *default].map(|v| Variant { samples: FINE, ..v })
}
