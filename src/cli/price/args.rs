//! Arguments of `vitrum price`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, value_parser};

use crate::accel::BuildQuality;
use crate::cli::args::ModelArgs;
use crate::cli::args::numbers::duration;
use crate::cli::args::reflections::ReflectionsArgs;
use crate::cli::backend::Renderer;
use crate::cli::choice::{about, levels};
use crate::cli::formulas::args::FormulasArgs;
use crate::study::Axis;

/// Show what accuracy costs in time, for a scene of yours.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum price scenes/glass.toml -o glass-price
  vitrum price bunny.obj -o bunny-price --limit 90s --size 320x240
  vitrum price scenes/prism.toml -o prism-price --axes fresnel,depth --pictures
  vitrum price scenes/goblet.toml -o goblet-price --json > goblet.json
  vitrum price --reflections -o reflections
  vitrum price --formulas
  vitrum price --formulas --of refraction,fresnel --count 200000
  vitrum price --formulas --csv > formulas.csv

Every level of each choice is timed beside the default (they take turns; the
figure is the median of the rounds' ratios) and held against the f64 renderer
with the exact choices; the sampling axis against 16 x 16 rays a pixel. Then
the product of the choices that mattered, as far as --limit allows; what is
left out is said. The folder gets report.html (one page that needs no network),
report.json and report.csv. Ctrl-C keeps what is done, and the same command
goes on. A quiet machine gives narrow intervals.
With --reflections the lecture notes' systems run on the bundled scenes, beside
traced pictures; the folder gets reflections.html, reflections.json and scenes.
With --formulas no picture is made: each formula is timed in eight lanes, in one
and in f64, and held against an oracle of twice the digits of f64; the errors
are the same in every run.")]
pub(in crate::cli) struct PriceArgs {
    /// Scene (.toml) or model (.obj)
    #[arg(required_unless_present_any = ["formulas", "reflections"], conflicts_with_all = ["formulas", "reflections"])]
    pub scene: Option<PathBuf>,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Folder for the report; made where it is missing
    #[arg(short, long, value_name = "DIR", required_unless_present = "formulas", conflicts_with = "formulas")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub formulas: FormulasArgs,

    #[command(flatten)]
    pub reflections: ReflectionsArgs,

    /// Time that one run may take: 90s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "5m")]
    pub limit: Duration,

    /// Choices to study [default: all]
    #[arg(long, value_name = "AXIS,...", value_delimiter = ',',
        value_parser = levels::<Axis>())]
    pub axes: Vec<Axis>,

    /// Size of the pictures [default: what the time limit bears, at most 76800 pixels]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,

    /// N by N rays a pixel, of all but the sampling axis
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=16), default_value_t = 1)]
    pub samples: u32,

    /// The default back end [default: embree where it is there, else native]
    #[arg(long, value_enum)]
    pub backend: Option<Renderer>,

    #[arg(long, help = about::<BuildQuality>(), value_parser = levels::<BuildQuality>())]
    pub bvh: Option<BuildQuality>,

    /// Timed runs of each variant at most
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 15)]
    pub runs: u32,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// One choice at a time, no combinations
    #[arg(long)]
    pub single: bool,

    /// Forget what is in the folder from an earlier run
    #[arg(long)]
    pub fresh: bool,

    /// Write a PNG and an EXR of each variant into the folder
    #[arg(long)]
    pub pictures: bool,

    /// Print the report as JSON instead of tables
    #[arg(long)]
    pub json: bool,

    /// No progress bar and no tables
    #[arg(short, long)]
    pub quiet: bool,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || String::from("not a size; write columns x rows, such as 320x240");
    let (w, h) = text.split_once('x').ok_or_else(wrong)?;
    match (w.parse(), h.parse()) {
        (Ok(w @ 8..=8192), Ok(h @ 8..=8192)) => Ok([w, h]),
        (Ok(_), Ok(_)) => Err(String::from("8 to 8192 columns and rows can be studied")),
        _ => Err(wrong()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_or_refused() {
        assert_eq!(size("320x240"), Ok([320, 240]));
        assert!(size("320").is_err() && size("4x4").is_err() && size("320x").is_err());
    }
}
