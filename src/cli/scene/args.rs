//! The arguments of `vitrum scene`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::{ModelArgs, StrictArg};

/// Write the scene of a model as a scene file, to be edited.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum scene bunny.obj -o bunny.toml
  vitrum scene house.obj -o house.toml --up z --material window=thin:1.5

The file holds the fitted camera, the lights and the sky that `vitrum render
MODEL` takes, and gives the same picture.")]
pub(in crate::cli) struct SceneArgs {
    /// Model (.obj, .gltf, .glb, .ply, .stl)
    pub model: PathBuf,

    /// Scene file to write: .toml
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    #[command(flatten)]
    pub options: ModelArgs,

    #[command(flatten)]
    pub strict: StrictArg,

    /// No warnings
    #[arg(short, long)]
    pub quiet: bool,
}
