//! The refracted direction by the stable form and by every formula of the lecture notes. Each is a type, so that a
//! shading stage contains only one of them, and timings are those of the formula.
//!
//! Misprints of the notes are corrected and described at each formula. None of the notes tests for total reflection;
//! all functions here report it as a mask. Their errors, measured against a double-double oracle, are in
//! `tests/optics`.

mod algebraic;
mod formula;
mod oliveira;
mod stable;
mod trigonometric;

pub use algebraic::{Bec, Heckbert, SlidesVector};
pub use formula::{Refracted, RefractionFormula};
pub use oliveira::Oliveira;
pub use stable::{Stable, StraightThrough};
pub use trigonometric::Trigonometric;

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
