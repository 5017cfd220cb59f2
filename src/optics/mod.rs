//! Light at a boundary: pure functions of numbers, written once over [`crate::math::Real`] and used as `f32`, as
//! eight lanes and as `f64`.
//!
//! Conventions, here and everywhere: `incident` points along travel; `normal` is a unit vector that faces the
//! incident side, so that `cos_i = -(incident . normal) >= 0`; `eta = n1 / n2`, incident over transmitted;
//! `cos_t >= 0`.

mod absorb;
mod boundary;
mod fresnel;
mod normal;
mod reflect;

pub use absorb::{absorption_from_colour, transmittance};
pub use boundary::{Boundary, Crossing};
pub use fresnel::{
    AtNormal, Exact, FresnelFormula, FresnelModel, Schlick, conductor_exact, conductor_schlick, thin_reflectance,
};
pub use normal::{below_surface, consistent_normal};
pub use reflect::reflect;
