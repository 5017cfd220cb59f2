//! The trait of the formulas.

use crate::math::{Real, Vector3};
use crate::optics::boundary::{Boundary, Crossing};

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
    /// True if it is for planar surfaces alone; curved ones then refract by the stable form.
    const FLAT_ONLY: bool = false;

    /// True if light that enters a body ends in a map of its surroundings.
    const MAPPED: bool = false;

    /// Returns the formula with its constant, if it has one and `constant` is given, else the default.
    #[must_use]
    fn with_constant(constant: Option<f64>) -> Self {
        let _ = constant;
        Self::default()
    }

    /// Returns the refracted direction of `incident` at `normal`, with `at = boundary.cross(-(incident . normal))`. The
    /// notes' formulas use only the cosine of it, so that their time includes their own square root. Formulas without one of
    /// their own refract by the stable form ([`Boundary::refract`]).
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
