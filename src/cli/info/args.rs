//! The arguments of `vitrum info`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::{ModelArgs, StrictArg};

/// Say what a model or a scene holds: bounds, materials, triangles, and what was left out.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum info bunny.obj
  vitrum info house.obj --json")]
pub(in crate::cli) struct InfoArgs {
    /// Model (.obj, .gltf, .glb, .ply, .stl) or scene (.toml)
    pub scene: PathBuf,

    #[command(flatten)]
    pub options: ModelArgs,

    #[command(flatten)]
    pub strict: StrictArg,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}
