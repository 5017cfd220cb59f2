//! Arguments that choose formulas of light transport.

use clap::Args;

use super::numbers::above_minus_one;
use crate::cli::choice::{about, about_with, levels};
use crate::optics::{FresnelModel, RefractionModel};
use crate::scene::{LightsFrom, ShadowRule};

/// Options of `render` and `pixel`.
#[derive(Clone, Copy, Debug, Args)]
pub(in crate::cli) struct OpticsArgs {
    #[arg(long, help = about::<FresnelModel>(), value_parser = levels::<FresnelModel>(), help_heading = "Light")]
    pub fresnel: Option<FresnelModel>,

    #[arg(long, help = about::<RefractionModel>(), value_parser = levels::<RefractionModel>(), help_heading = "Light")]
    pub refraction: Option<RefractionModel>,

    /// Constant of `--refraction oliveira`; same as `--refraction oliveira=C`
    #[arg(long, value_name = "C", value_parser = above_minus_one, allow_negative_numbers = true, help_heading = "Light")]
    pub oliveira: Option<f64>,

    #[arg(long, help = about_with::<ShadowRule>("as in the scene"), value_parser = levels::<ShadowRule>(), help_heading = "Light")]
    pub shadows: Option<ShadowRule>,

    #[arg(long, help = about_with::<LightsFrom>("as in the scene"), value_parser = levels::<LightsFrom>(), help_heading = "Light")]
    pub lights_from: Option<LightsFrom>,
}
