//! Choices that several commands have, as the rooms that make them know them.

use crate::accel::BuildQuality;
use crate::cli::args::{BvhArg, FresnelArg, RefractionArg, ShadowsArg};
use crate::optics::{FresnelModel, Oliveira, RefractionModel};
use crate::scene::ShadowRule;
use crate::{Error, Result};

impl From<FresnelArg> for FresnelModel {
    fn from(arg: FresnelArg) -> Self {
        match arg {
            FresnelArg::Exact => Self::Exact,
            FresnelArg::Polarised => Self::Polarised,
            FresnelArg::Schlick => Self::Schlick,
            FresnelArg::Off => Self::Off,
        }
    }
}

impl From<ShadowsArg> for ShadowRule {
    fn from(arg: ShadowsArg) -> Self {
        match arg {
            ShadowsArg::Opaque => Self::Opaque,
            ShadowsArg::Straight => Self::Straight,
        }
    }
}

impl From<RefractionArg> for RefractionModel {
    fn from(arg: RefractionArg) -> Self {
        match arg {
            RefractionArg::Stable => Self::Stable,
            RefractionArg::Trigonometric => Self::Trigonometric,
            RefractionArg::Heckbert => Self::Heckbert,
            RefractionArg::Bec => Self::Bec,
            RefractionArg::Slides => Self::SlidesVector,
            RefractionArg::Oliveira => Self::Oliveira,
            RefractionArg::Straight => Self::StraightThrough,
        }
    }
}

/// The constant of Oliveira's formula.
///
/// # Errors
/// Usage, where it is given for another formula.
pub(super) fn oliveira(formula: RefractionArg, c: Option<f64>) -> Result<Oliveira> {
    match (formula, c) {
        (_, None) => Ok(Oliveira::GLASS),
        (RefractionArg::Oliveira, Some(c)) => Ok(Oliveira { c }),
        (_, Some(c)) => Err(Error::Usage(format!(
            "--oliveira {c}: only that formula has a constant; add --refraction oliveira, or leave it out"
        ))),
    }
}

/// Why `--bvh` is refused for those who "have" or "has" none.
pub(super) fn no_hierarchy(who_have: &str) -> Error {
    Error::Usage(format!("--bvh: {who_have} no hierarchy to build; leave it out"))
}

pub(super) fn quality(arg: Option<BvhArg>) -> BuildQuality {
    match arg {
        Some(BvhArg::Fast) => BuildQuality::Fast,
        None | Some(BvhArg::Default) => BuildQuality::Default,
        Some(BvhArg::High) => BuildQuality::High,
    }
}
