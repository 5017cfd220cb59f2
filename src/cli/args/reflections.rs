//! Argument that selects `vitrum price --reflections`.

use clap::Args;

/// The option of `price --reflections`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reflections")]
pub(in crate::cli) struct ReflectionsArgs {
    /// Hold the lecture notes' systems against traced pictures of the bundled scenes, two a system
    #[arg(long, conflicts_with_all = ["formulas", "axes", "limit", "single", "fresh", "pictures", "bvh"])]
    pub reflections: bool,
}
