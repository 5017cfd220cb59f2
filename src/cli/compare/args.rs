//! Arguments of `vitrum compare`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::numbers::{not_negative, share};

/// Compare two pictures of the same size.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum compare ours.exr theirs.exr
  vitrum compare ours.png theirs.png --tolerance 0.0005 --allow-share 0.001
  vitrum compare ours.exr theirs.exr --diff difference.png

Differences are of linear light; PSNR and SSIM are of the pictures as a screen
shows them. Exits 1 when more pixels than allowed exceed a given --tolerance.")]
pub(in crate::cli) struct CompareArgs {
    /// A picture: PNG, OpenEXR, Radiance HDR, PFM or JPEG
    pub a: PathBuf,

    /// Another one
    pub b: PathBuf,

    /// Largest difference of a channel that passes [default: 1/255, for the count alone]
    #[arg(long, value_name = "LIGHT", value_parser = not_negative, allow_negative_numbers = true)]
    pub tolerance: Option<f64>,

    /// Share of pixels that may exceed the tolerance, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true, requires = "tolerance", default_value_t = 0.0)]
    pub allow_share: f64,

    /// Picture of the absolute differences to write
    #[arg(long, value_name = "FILE")]
    pub diff: Option<PathBuf>,

    /// Factor on the differences in that picture [default: the largest becomes 1]
    #[arg(long, value_name = "FACTOR", value_parser = not_negative, allow_negative_numbers = true, requires = "diff")]
    pub diff_scale: Option<f64>,

    /// Take the codes of PNG and JPEG as linear light, whatever the files say
    #[arg(long)]
    pub linear: bool,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// Print nothing but errors; the exit code tells
    #[arg(short, long, conflicts_with = "json")]
    pub quiet: bool,
}
