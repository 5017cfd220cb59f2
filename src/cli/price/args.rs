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

/// Measure what accuracy costs in time, for a scene.
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

Every level of each choice is timed by turns with the default; the figure is the
median of the rounds' ratios. It is compared with the f64 renderer with the
exact choices, and the sampling axis with 16 x 16 rays per pixel. Then the
product of the choices that matter is measured, as far as --limit allows. The
report names all that is left out. The folder gets report.html (one page that
needs no network), report.json and report.csv. Ctrl-C keeps finished work, and
the same command continues. A machine without other work gives narrow intervals.
With --reflections the lecture notes' systems are compared with traced pictures
of the bundled scenes; the folder gets reflections.html, reflections.json and
the scenes.
With --formulas no picture is made. Each formula is timed in eight lanes, in one
and in f64, and compared with an oracle of twice the digits of f64. The errors
are the same in every run.")]
pub(in crate::cli) struct PriceArgs {
    /// Scene (.toml) or model (.obj, .gltf, .glb, .ply, .stl)
    #[arg(required_unless_present_any = ["formulas", "reflections"], conflicts_with_all = ["formulas", "reflections"])]
    pub scene: Option<PathBuf>,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Folder for the report; created if missing
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

    /// Size of the pictures [default: as the time limit allows, at most 76800 pixels]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,

    /// N by N rays a pixel, of all but the sampling axis
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=16), default_value_t = 1)]
    pub samples: u32,

    /// Back end of the default variant [default: embree if available, else native]
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

    /// Discard the measurements of earlier runs in the folder
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
