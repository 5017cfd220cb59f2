//! Argument that selects `vitrum price --reflections`.

use clap::Args;

/// The option of `price --reflections`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reflections")]
pub(in crate::cli) struct ReflectionsArgs {
    /// Compare the lecture notes' systems with traced pictures, on two bundled scenes per system
    #[arg(long, conflicts_with_all = ["formulas", "axes", "limit", "single", "fresh", "pictures", "bvh"])]
    pub reflections: bool,
}
