//! Words for reasons that the library gives without the names of flags.

use crate::Error;
use crate::error::{NEGATIVE_CHANNELS, ONE_WHITE_RAY, Unsupported};

/// Returns the message of an error, with the flags that cause or cure it.
pub(super) fn message(error: &Error) -> String {
    match error {
        Error::Unsupported(reason) => reworded(reason),
        _ => error.to_string(),
    }
}

fn reworded(reason: &Unsupported) -> String {
    let dispersing = |flag: &str, medium: &str, why: &str| {
        format!(
            "{flag} does not work in scenes whose media disperse light, as `{medium}` does: {why}; add --no-dispersion or \
             leave the option out"
        )
    };
    match reason {
        Unsupported::ProofWithDispersion { medium } => dispersing("--cutoff-error", medium, NEGATIVE_CHANNELS),
        Unsupported::PolarisationWithDispersion { medium } => dispersing("--fresnel polarised", medium, ONE_WHITE_RAY),
        Unsupported::LightTouchesSurface { .. } | Unsupported::UnboundedLight | Unsupported::SampledLight => {
            format!("--cutoff-error: {reason}; or take --cutoff instead")
        }
        Unsupported::RecordOfCarried => format!("{reason}; take another --fresnel, or leave out --cutoff-error"),
        Unsupported::BoundBelowRounding { bound, .. } => format!("--max-error {bound:e}: {reason}"),
        Unsupported::AnotherStudy { .. } => format!("{reason}, or add --fresh to forget it"),
    }
}
