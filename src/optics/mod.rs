//! Light at a boundary: pure functions of numbers, written once over [`crate::math::Real`] and used with `f32`, eight
//! lanes and `f64`.
//!
//! Conventions of all functions: `incident` points along travel. `normal` is a unit vector that faces the incident
//! side, so `cos_i = -(incident . normal) >= 0`. `eta = n1 / n2` is incident over transmitted index, and `cos_t >= 0`.

mod absorb;
mod boundary;
mod conductor;
mod disperse;
mod fresnel;
mod mueller;
mod normal;
mod observer;
pub mod oracle;
mod planar;
mod polarised;
mod reflect;
mod refraction;
mod schlick;
mod spectrum;

pub use absorb::{absorption_from_colour, transmittance};
pub use boundary::{Boundary, Crossing};
pub use conductor::{conductor_at_normal, conductor_exact, conductor_schlick};
pub use disperse::{LINE_C, LINE_D, LINE_F, abbe_number, cauchy_from_abbe};
pub use fresnel::{AtNormal, Exact, FresnelFormula, FresnelModel, FresnelVisitor, Schlick, thin_reflectance};
pub use mueller::{Diattenuation, Mueller, PlaneOfIncidence, any_across, made_across};
pub use normal::{below_surface, consistent_normal};
pub use observer::{colour_matching, daylight, linear_srgb, white_at};
pub use planar::PlanarReflection;
pub use polarised::{Polarised, polarised, polarised_as_printed};
pub use reflect::reflect;
pub use refraction::{
    Bec, Heckbert, MapOne, MapTwo, Oliveira, Raised, Refracted, RefractionFormula, RefractionModel, RefractionVisitor,
    SlidesVector, Stable, StraightThrough, Trigonometric,
};
pub use spectrum::{Bands, FEWEST_BANDS, SEPARATION, Spectrum, VISIBLE};
