//! How a boundary divides light, for one ray.

use glam::DVec3;

use crate::math::Vector3;
use crate::optics::{AtNormal, Boundary, Crossing, Exact, FresnelFormula, FresnelModel, Schlick};
use crate::scene::FresnelRule;

/// Reflectance of a dielectric boundary by the chosen formula.
pub(super) fn reflectance(model: FresnelModel, boundary: &Boundary<f64>, at: &Crossing<f64>) -> f64 {
    match model {
        FresnelModel::Exact => Exact::dielectric(boundary, at),
        FresnelModel::Schlick => Schlick::dielectric(boundary, at),
        FresnelModel::Off => AtNormal::dielectric(boundary, at),
    }
}

/// Reflectance of a metal by the chosen formula.
pub(super) fn of_metal(model: FresnelModel, cos_i: f64, eta: DVec3, k: DVec3) -> DVec3 {
    let (eta, k): (Vector3<f64>, Vector3<f64>) = (eta.into(), k.into());
    match model {
        FresnelModel::Exact => Exact::conductor_rgb(cos_i, eta, k),
        FresnelModel::Schlick => Schlick::conductor_rgb(cos_i, eta, k),
        FresnelModel::Off => AtNormal::conductor_rgb(cos_i, eta, k),
    }
    .into()
}

/// The reflected share: a fixed one where the rule says so and reflection is not total.
pub(super) fn share(rule: FresnelRule, total: bool, fresnel: f64) -> DVec3 {
    match rule {
        FresnelRule::Fixed(share) if !total => share.as_dvec3(),
        _ => DVec3::splat(fresnel),
    }
}
