//! Validation of choices that several commands have.

use crate::optics::{Oliveira, RefractionModel};
use crate::{Error, Result};

/// Returns the refraction formula with its constant.
///
/// # Errors
/// Usage if a constant is given for another formula.
pub(in crate::cli) fn refraction(formula: Option<RefractionModel>, c: Option<f64>) -> Result<RefractionModel> {
    match (formula.unwrap_or_default(), c) {
        (formula, None) => Ok(formula),
        (RefractionModel::Oliveira(_), Some(c)) => Ok(RefractionModel::Oliveira(Oliveira { c })),
        (_, Some(c)) => Err(Error::Usage(format!(
            "--oliveira {c}: only that formula has a constant; add --refraction oliveira, or leave it out"
        ))),
    }
}

/// Error of `--bvh` for renderers that have no hierarchy; `who_have` names them and ends in "have" or "has".
pub(in crate::cli) fn no_hierarchy(who_have: &str) -> Error {
    Error::Usage(format!("--bvh: {who_have} no hierarchy to build; leave it out"))
}
