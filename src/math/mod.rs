//! Scalar helpers that every other room may use: the number trait, vectors over it, and the few elementary
//! functions whose bits must agree between one lane and eight.

pub mod double;
mod elementary;
mod real;
mod scalar;
mod trigonometry;
mod ulp;
mod vector;

pub(crate) use elementary::SQRT_HALF_BITS;
pub use elementary::{Binary32, exp, pow};
pub(crate) use real::{EXPONENT_BITS, INVERSE_BITS};
pub use real::{FUSED, LaneMask, Real};
pub use trigonometry::{acos, asin, sin_cos};
pub use ulp::{next_down, next_up, ulp};
pub use vector::Vector3;

/// Unit roundoff of `f32`: half the distance from 1 to the next larger number, 2^-24.
pub const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound `n u / (1 - n u)` on the relative error of `n` successive roundings in `f32`
/// (Higham 2002, lemma 3.1, with `u` = 2^-24).
#[must_use]
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}
