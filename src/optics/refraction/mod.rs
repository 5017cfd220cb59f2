//! The refracted direction by the stable form and by every formula of the lecture notes, each a type, so that a shading
//! stage holds one of them and what is timed is the formula.
//!
//! What the notes misprint is corrected here and said at the formula. None of them guards against total reflection;
//! all of these report it as a mask. Their errors, measured against a double-double oracle, are in `tests/optics.rs`.

mod algebraic;
mod oliveira;
mod trigonometric;

pub use algebraic::{Bec, Heckbert, SlidesVector};
pub use oliveira::Oliveira;
pub use trigonometric::Trigonometric;

use super::{Boundary, Crossing};
use crate::math::{LaneMask, Real, Vector3};

/// The choice between the formulas, where it is still data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RefractionModel {
    /// `eta (i + kc / (cos_i + b) n)`: see [`Stable`].
    #[default]
    Stable,
    /// Snell's law with arc cosine and arc sine: see [`Trigonometric`].
    Trigonometric,
    /// Heckbert's method: see [`Heckbert`].
    Heckbert,
    /// Bec's method: see [`Bec`].
    Bec,
    /// The slides' vector form: see [`SlidesVector`].
    SlidesVector,
    /// Oliveira's approximation: see [`Oliveira`].
    Oliveira,
    /// No bending at all: see [`StraightThrough`].
    StraightThrough,
}

/// A refracted direction, where there is one.
#[derive(Clone, Copy, Debug)]
pub struct Refracted<R: Real> {
    /// Direction of travel beyond the boundary, of unit length for unit arguments. Where `total` is true it is finite
    /// and nobody's direction.
    pub direction: Vector3<R>,
    /// Where this formula knows no refracted direction. Close to the critical angle (1e-7 rad) rounding lets formulas
    /// disagree with each other and with [`Crossing::total`].
    pub total: R::Mask,
}

/// The choice between the formulas as a type. All but [`Oliveira`] are unit types.
pub trait RefractionFormula: Copy + Send + Sync + 'static {
    /// The data form of this choice.
    const MODEL: RefractionModel;

    /// The refracted direction of `incident` at `normal`, of which `at` is `boundary.cross(-(incident . normal))`. The
    /// notes' formulas take only the cosine from it, so that their own square root is part of their price.
    fn refract<R: Real>(
        self,
        boundary: &Boundary<R>,
        incident: Vector3<R>,
        normal: Vector3<R>,
        at: &Crossing<R>,
    ) -> Refracted<R>;
}

/// `t = eta (i + kc / (c + b) n)`, [`Boundary::refract`]: no cancellation at any index ratio, and the square root is
/// the one that Fresnel needs as well. `incident` to the bit between equal indices.
///
/// Errors: 2e-7 rad on the way into any denser medium, index ratios one ulp from 1 included.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stable;

impl RefractionFormula for Stable {
    const MODEL: RefractionModel = RefractionModel::Stable;

    #[inline(always)]
    fn refract<R: Real>(
        self,
        boundary: &Boundary<R>,
        incident: Vector3<R>,
        normal: Vector3<R>,
        at: &Crossing<R>,
    ) -> Refracted<R> {
        Refracted { direction: boundary.refract(incident, normal, at), total: at.total }
    }
}

/// The way light would go if nothing bent it: what is saved by drawing no refraction at all. Never total.
#[derive(Clone, Copy, Debug, Default)]
pub struct StraightThrough;

impl RefractionFormula for StraightThrough {
    const MODEL: RefractionModel = RefractionModel::StraightThrough;

    #[inline(always)]
    fn refract<R: Real>(
        self,
        _boundary: &Boundary<R>,
        incident: Vector3<R>,
        _normal: Vector3<R>,
        _at: &Crossing<R>,
    ) -> Refracted<R> {
        Refracted { direction: incident, total: R::Mask::splat(false) }
    }
}
