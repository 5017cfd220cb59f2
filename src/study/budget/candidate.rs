//! Combinations of choices measured on a small picture.

use serde::Serialize;

use crate::study::variant::Variant;

/// Combination of choices measured on the small picture.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Choices.
    pub variant: Variant,
    /// Predicted seconds for the whole picture, from the median run.
    pub seconds: f64,
    /// Predicted seconds from the slowest run, as on a machine with other work.
    pub slowest: f64,
    /// Largest difference of a channel from `f64` in the small picture, excluding ill-conditioned pixels.
    pub max: f64,
    /// Root of the mean squared difference.
    pub rmse: f64,
}
