//! The refracted direction by the stable form and by every formula of the lecture notes. Each is a type, so that a
//! shading stage contains only one of them, and timings are those of the formula.
//!
//! Misprints of the notes are corrected and described at each formula. None of the notes tests for total reflection;
//! all functions here report it as a mask. Their errors, measured against a double-double oracle, are in
//! `tests/optics`.

mod algebraic;
mod formula;
mod mapped;
mod oliveira;
mod raised;
mod stable;
mod trigonometric;

pub use algebraic::{Bec, Heckbert, SlidesVector};
pub use formula::{Refracted, RefractionFormula};
pub use mapped::{MapOne, MapTwo};
pub use oliveira::Oliveira;
pub use raised::Raised;
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

impl RefractionModel {
    /// Returns true if light that enters a body ends in a map of its surroundings.
    #[must_use]
    pub fn is_mapped(self) -> bool {
        struct IsMapped;
        impl RefractionVisitor for IsMapped {
            type Output = bool;

            fn visit<F: RefractionFormula>(self, _: F) -> bool {
                F::MAPPED
            }
        }
        self.dispatch(IsMapped)
    }
}
