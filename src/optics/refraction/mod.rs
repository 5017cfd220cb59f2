//! The refracted direction by the stable form and by every formula of the lecture notes. Each is a type, so that a
//! shading stage contains only one of them, and timings are those of the formula.
//!
//! Misprints of the notes are corrected and described at each formula. None of the notes tests for total reflection;
//! all functions here report it as a mask. Their errors, measured against a double-double oracle, are in
//! `tests/optics`.

mod algebraic;
mod oliveira;
mod trigonometric;

pub use algebraic::{Bec, Heckbert, SlidesVector};
pub use oliveira::Oliveira;
pub use trigonometric::Trigonometric;

use super::boundary::{Boundary, Crossing};
use crate::math::{LaneMask, Real, Vector3};

crate::choice! {
    /// Formula for the direction of refracted light.
    ///
    /// A formula is a type in this folder and a line of this list. The renderers, the command line, reports and the
    /// studies read the list.
    pub enum RefractionModel("refraction", default(Stable), visitor(RefractionVisitor, RefractionFormula)) {
        /// No refraction: light goes straight on.
        "straight" => StraightThrough by StraightThrough,
        /// Oliveira's approximation.
        "oliveira" => Oliveira(formula: Oliveira = Oliveira::GLASS) by formula,
        /// Snell's law by Bec's method.
        "bec" => Bec by Bec,
        /// Snell's law by Heckbert's method.
        "heckbert" => Heckbert by Heckbert,
        /// Snell's law in the vector form of the lighting slides.
        "slides" => SlidesVector by SlidesVector,
        /// Snell's law by arc sine and arc cosine.
        "trigonometric" => Trigonometric by Trigonometric,
        /// Snell's law in a form without cancellation at any ratio of indices.
        "stable" => Stable by Stable,
    }
}

/// A refracted direction, if there is one.
#[derive(Clone, Copy, Debug)]
pub struct Refracted<R: Real> {
    /// Direction of travel beyond the boundary, of unit length for unit arguments. In lanes with `total` it is finite
    /// but has no meaning.
    pub direction: Vector3<R>,
    /// True if this formula has no refracted direction. Close to the critical angle (1e-7 rad) rounding lets formulas
    /// disagree with each other and with [`Crossing::total`].
    pub total: R::Mask,
}

/// Refraction formula as a type, so that a shading stage is compiled for it and holds no branch.
pub trait RefractionFormula: Copy + Default + Send + Sync + 'static {
    /// Returns the formula of `model` if it is of this type, else the default.
    #[must_use]
    fn of(model: RefractionModel) -> Self {
        let _ = model;
        Self::default()
    }

    /// Returns the refracted direction of `incident` at `normal`, with `at = boundary.cross(-(incident . normal))`. The
    /// notes' formulas use only the cosine of it, so that their time includes their own square root.
    fn refract<R: Real>(
        self,
        boundary: &Boundary<R>,
        incident: Vector3<R>,
        normal: Vector3<R>,
        at: &Crossing<R>,
    ) -> Refracted<R>;
}

/// `t = eta (i + kc / (c + b) n)`, see [`Boundary::refract`]. It does not cancel at any index ratio, and Fresnel needs
/// the same square root. Between equal indices it is `incident` to the bit.
///
/// Errors: 2e-7 rad on the way into any denser medium, index ratios one ulp from 1 included.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stable;

impl RefractionFormula for Stable {
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

/// The direction of incidence, as if there were no boundary. Never total.
#[derive(Clone, Copy, Debug, Default)]
pub struct StraightThrough;

impl RefractionFormula for StraightThrough {
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
