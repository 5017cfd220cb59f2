//! Arguments of `vitrum explain`.

use std::path::PathBuf;

use clap::{Args, value_parser};

use crate::cli::args::{EffectArgs, ModelArgs, StrictArg};
use crate::cli::options::SmallPicture;

/// List the effects that a scene needs, with reasons; with --measure, their cost.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum explain scenes/glass.toml
  vitrum explain scenes/glass.toml --measure
  vitrum explain scenes/glass.toml --no-fresnel-split --json

With --measure the native back end renders the picture without each effect that
is on, in rounds that begin with the whole picture. `time` is the time of the
whole picture relative to that without the effect (median over the rounds).
`rmse` and `pixels` are the changes of the picture, in linear light.")]
pub(in crate::cli) struct ExplainArgs {
    /// Scene (.toml) or model (.obj, .gltf, .glb, .ply, .stl)
    pub scene: PathBuf,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Render with and without each effect
    #[arg(long)]
    pub measure: bool,

    /// Number of timed renders for each effect
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 5, requires = "measure")]
    pub rounds: u32,

    #[command(flatten)]
    pub picture: SmallPicture,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    #[command(flatten)]
    pub effects: EffectArgs,

    #[command(flatten)]
    pub strict: StrictArg,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// No progress bar
    #[arg(short, long)]
    pub quiet: bool,
}
