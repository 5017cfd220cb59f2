//! Arguments of `vitrum verify`.

use std::path::PathBuf;

use clap::{Args, value_parser};

use crate::accel::BuildQuality;
use crate::cli::args::{ModelArgs, StrictArg};
use crate::cli::choice::{PathArg, about, levels};
use crate::trial::verify::Group;

/// Test the hard numerical cases on this machine, or rays at a scene.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum verify
  vitrum verify --full --json > figures.json
  vitrum verify --backend native,embree --group leaks self-hits
  vitrum verify scenes/glass.toml

Without a scene: closed meshes of all sizes and places, odd meshes, the optics
against an oracle of twice the digits of f64, long chains of reflections.
With one: rays at its corners and edges, judged by the f64 arbiter, and faulty
triangles, each with its line in the file.
Exits 1 if any case fails.")]
pub(in crate::cli) struct VerifyArgs {
    /// Scene (.toml) or model (.obj, .gltf, .glb, .ply, .stl) to test, instead of the built-in cases
    pub scene: Option<PathBuf>,

    #[command(flatten)]
    pub model: ModelArgs,

    /// All the cases (minutes) instead of a sample of them (seconds)
    #[arg(long)]
    pub full: bool,

    /// Paths to try, side by side; embree is tried robust and fast
    #[arg(long, value_parser = levels::<PathArg>(), value_delimiter = ',', default_value = "native")]
    pub backend: Vec<PathArg>,

    #[arg(long, help = about::<BuildQuality>(), value_parser = levels::<BuildQuality>())]
    pub bvh: Option<BuildQuality>,

    /// Groups to run [default: all]
    #[arg(long, value_name = "NAME", value_parser = levels::<Group>(), num_args = 1.., value_delimiter = ',')]
    pub group: Vec<Group>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    #[command(flatten)]
    pub strict: StrictArg,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// Print only errors; the exit code is the result
    #[arg(short, long, conflicts_with = "json")]
    pub quiet: bool,
}
