//! Time and accuracy of single formulas: nanoseconds per evaluation, and errors against an oracle with twice the digits
//! of `f64`, over ranges of media and angles.
//!
//! The errors are the same in every run, because rays are drawn from a fixed seed. Times are those of this machine.

mod csv;
mod evaluate;
mod formula;
mod fresnel;
mod ranges;
mod reciprocal;
mod reflection;
mod refraction;
mod text;
mod timing;
mod triangle;

pub use csv::csv;
pub use formula::{Errors, Formula, FormulaKind, FormulaPlan, Noted, Off};
pub use text::text;
pub use timing::Time;

use crate::Error;

/// Measures every formula of the groups in `plan`. `done` is called after each group; it returns false to end the work.
///
/// # Errors
/// `Interrupted` if `done` returns false.
pub fn measure(plan: &FormulaPlan, mut done: impl FnMut() -> bool) -> crate::Result<Vec<Formula>> {
    let mut formulas = Vec::new();
    for kind in &plan.kinds {
        formulas.extend(match kind {
            FormulaKind::Refraction => refraction::measure(plan),
            FormulaKind::Fresnel => fresnel::measure(plan),
            FormulaKind::Reflection => reflection::measure(plan),
            FormulaKind::Reciprocal => reciprocal::measure(plan),
            FormulaKind::Triangle => triangle::measure(plan),
        });
        if !done() {
            return Err(Error::Interrupted);
        }
    }
    Ok(formulas)
}
