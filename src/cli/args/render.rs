//! `vitrum render`, as typed.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum, value_parser};

use super::numbers::{above_minus_one, above_zero, bound, exposure};
use super::{BvhArg, EffectArgs, FresnelArg, RefractionArg, SettingsArgs, ShadowsArg, price};
use crate::cli::backend::Renderer;
use crate::study::Spheres;

/// Render a scene file or an OBJ model to a picture.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum render scenes/glass.toml -o glass.png
  vitrum render bunny.obj --width 800 --height 600 --samples 3
  vitrum render scenes/glass.toml -o glass.exr --depth 40 --cutoff 0
  vitrum render scenes/glass.toml -o reference.exr --backend reference
  vitrum render scenes/glass.toml -o plain.png --no-fresnel-split
  vitrum render scenes/glass.toml -o proven.png --cutoff-error 0.002
  vitrum render scenes/glass.toml -o polarised.png --fresnel polarised
  vitrum render scenes/glass.toml --quiet --json > summary.json
  vitrum render bunny.obj -o holes.png --triangles moller-trumbore
  vitrum render scenes/glass.toml --max-error 1/512
  vitrum render scenes/glass.toml --time-budget 2s

The same command gives the same bytes for any number of threads and any tile size.
The summary goes to standard error, --json to standard output.")]
pub(in crate::cli) struct RenderArgs {
    /// Scene (.toml) or model (.obj)
    pub scene: PathBuf,

    /// Picture to write: .png, .exr, .hdr or .pfm [default: the scene's name with .png, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub settings: SettingsArgs,

    /// Bits of a PNG's samples [default: 8]
    #[arg(long, value_enum, help_heading = "Picture")]
    pub bits: Option<BitsArg>,

    /// Multiply all colours by 2 to the power EV
    #[arg(long, value_name = "EV", value_parser = exposure, allow_negative_numbers = true, help_heading = "Picture")]
    pub exposure: Option<f32>,

    /// End rays by proof: what is cut changes no channel of any pixel by more than E
    #[arg(long, value_name = "E", value_parser = above_zero, allow_negative_numbers = true, conflicts_with = "cutoff",
        help_heading = "Light")]
    pub cutoff_error: Option<f32>,

    /// Formula that splits light at a surface [default: exact]
    #[arg(long, value_enum, help_heading = "Light")]
    pub fresnel: Option<FresnelArg>,

    /// Formula that bends light at a surface [default: stable]
    #[arg(long, value_enum, help_heading = "Light")]
    pub refraction: Option<RefractionArg>,

    /// The constant of `--refraction oliveira`, above -1 [default: 0.6645, for glass]
    #[arg(long, value_name = "C", value_parser = above_minus_one, allow_negative_numbers = true, help_heading = "Light")]
    pub oliveira: Option<f64>,

    /// What becomes of light that surfaces reflect [default: traced]
    #[arg(long, value_enum, help_heading = "Light")]
    pub reflection: Option<ReflectionArg>,

    /// What transparent surfaces do to shadows [default: as the scene says]
    #[arg(long, value_enum, help_heading = "Light")]
    pub shadows: Option<ShadowsArg>,

    /// Exact spheres, or as meshes of so many bands [default: exact]
    #[arg(long, value_name = "exact|BANDS", value_parser = spheres, help_heading = "Light")]
    pub spheres: Option<Spheres>,

    #[command(flatten)]
    pub effects: EffectArgs,

    /// What traces the rays [default: embree where built in, else native]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub backend: Option<Renderer>,

    /// How much work the hierarchy's build is worth; the picture is the same [default: default]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub bvh: Option<BvhArg>,

    /// Ray/triangle test, by native's hierarchy one ray at a time: slow, to compare tests [default: the back end's own]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub triangles: Option<TrianglesArg>,

    /// One over a number in the same walk; estimates differ between CPU makers [default: exact]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub reciprocal: Option<ReciprocalArg>,

    /// Render with the cheapest settings that keep every channel within E (1/512, 0.002) of f64; options given stay
    #[arg(long, value_name = "E", value_parser = bound, conflicts_with_all = ["time_budget", "exposure"], help_heading = "Budget")]
    pub max_error: Option<f64>,

    /// Choose what renders within TIME (2s, 500ms), the most accurate; what is given besides stays
    #[arg(long, value_name = "TIME", value_parser = price::duration, help_heading = "Budget")]
    pub time_budget: Option<Duration>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024), help_heading = "Machine")]
    pub threads: Option<u32>,

    /// Edge of the squares that threads work on, in pixels
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=1024), default_value_t = 32,
        help_heading = "Machine")]
    pub tile: u32,

    /// Make every warning, and everything dropped or clamped, an error
    #[arg(long, help_heading = "Reports")]
    pub strict: bool,

    /// Print the summary as JSON on standard output
    #[arg(long, help_heading = "Reports")]
    pub json: bool,

    /// No progress bar, no warnings and no summary
    #[arg(short, long, help_heading = "Reports")]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum BitsArg {
    #[value(name = "8")]
    Eight,
    #[value(name = "16")]
    Sixteen,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum ReflectionArg {
    /// By rays
    Traced,
    /// Looked up in the environment, whatever stands between
    Environment,
    /// Left out, and counted as truncated weight
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum TrianglesArg {
    /// Plane and signed areas, of the lecture notes
    PlaneArea,
    /// Möller and Trumbore
    MollerTrumbore,
    /// Plücker coordinates, as Embree's robust mode
    Pluecker,
    /// Woop, Benthin and Wald's, the renderer's own
    #[value(alias = "woop")]
    Watertight,
    /// f32 with a bound on its error, f64 where that does not decide
    Certified,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum ReciprocalArg {
    /// True division
    Exact,
    /// The hardware's estimate and one Newton step
    Newton,
    /// The hardware's estimate
    Estimate,
}

fn spheres(text: &str) -> Result<Spheres, String> {
    if text == "exact" {
        return Ok(Spheres::Exact);
    }
    match text.parse() {
        Ok(n @ 2..=4096) => Ok(Spheres::Bands(n)),
        _ => Err(String::from("neither `exact` nor a number of bands, 2 to 4096")),
    }
}
