//! The refracted direction by the stable form and by every formula of the lecture notes, each a type, so that a shading
//! stage holds one of them and what is timed is the formula.
//!
//! What the notes misprint is corrected here and said at the formula. None of them guards against total reflection;
//! all of these report it as a mask. Their errors, measured against a double-double oracle, are in `tests/optics.rs`.

mod algebraic;
mod mapped;
mod oliveira;
mod raised;
mod trigonometric;

pub use algebraic::{Bec, Heckbert, SlidesVector};
pub use mapped::{MapOne, MapTwo};
pub use oliveira::Oliveira;
pub use raised::Raised;
pub use trigonometric::Trigonometric;

use super::{Boundary, Crossing};
use crate::math::{LaneMask, Real, Vector3};

crate::choice! {
    /// Formula for the direction of refracted light.
    ///
    /// A formula is its file in this folder and its line in this list. The renderers, the command line, reports and the studies take it
    /// from here.
    pub enum RefractionModel("refraction", default(Stable), visitor(RefractionVisitor, RefractionFormula)) {
        /// No refraction: light goes straight on.
        "straight" => StraightThrough by StraightThrough,
        /// Lookup in a cube map of a body's surroundings after one bend; Snell's law elsewhere.
        "map-one" => MapOne by MapOne,
        /// Lookup in such a map after two bends, with the thickness from the body's back side; Snell's law elsewhere.
        "map-two" => MapTwo by MapTwo,
        /// Raised objects behind planar surfaces, each at its depth times the ratio of indices; Snell's law at curved ones.
        "raised" => Raised by Raised,
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

/// Refraction formula as a type, so that a shading stage is compiled for it and holds no branch.
pub trait RefractionFormula: Copy + Default + Send + Sync + 'static {
    /// True if it is for planar surfaces alone; curved ones then refract by [`Stable`].
    const FLAT_ONLY: bool = false;

    /// Number of interfaces of a body after which a map of its surroundings is looked up; 0 if none is.
    const MAPPED: u32 = 0;

    /// The formula of `model`, where it is one of this type.
    #[must_use]
    fn of(model: RefractionModel) -> Self {
        let _ = model;
        Self::default()
    }

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
