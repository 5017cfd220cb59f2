//! Arguments that replace settings of the scene.

use clap::{Args, value_parser};

use super::numbers::cutoff;

#[derive(Clone, Copy, Debug, Args)]
pub(in crate::cli) struct SettingsArgs {
    /// Columns of the picture
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536), help_heading = "Picture")]
    pub width: Option<u32>,

    /// Rows of the picture
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536), help_heading = "Picture")]
    pub height: Option<u32>,

    /// N by N rays a pixel; 1 is its centre
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024), help_heading = "Picture")]
    pub samples: Option<u32>,

    /// Largest number of reflections and refractions of a ray
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(0..=4096), help_heading = "Light")]
    pub depth: Option<u32>,

    /// End rays whose weight is below this, 0 to 1
    #[arg(long, value_name = "WEIGHT", value_parser = cutoff, allow_negative_numbers = true, help_heading = "Light")]
    pub cutoff: Option<f32>,

    /// Wavelengths that white light divides into where a medium disperses it
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(7..=64), help_heading = "Light")]
    pub wavelengths: Option<u32>,
}
