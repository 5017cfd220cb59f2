//! Validated options of `vitrum parity`.

use std::path::PathBuf;

use super::args::ParityArgs;
use crate::accel::BuildQuality;
use crate::cli::options::{Reading, SmallPicture};
use crate::trial::shown::Ray;

/// Paths to compare ray by ray.
#[derive(Debug)]
pub(in crate::cli) struct Parity {
    pub scene: PathBuf,
    pub reading: Reading,
    /// Number of rays of each kind.
    pub rays: usize,
    /// A single ray to send instead, if given.
    pub ray: Option<Ray>,
    pub picture: SmallPicture,
    pub bvh: BuildQuality,
    /// Number of threads; 0 means one per processor.
    pub threads: usize,
    /// True if warnings are errors.
    pub strict: bool,
    pub json: bool,
    pub quiet: bool,
}

impl From<ParityArgs> for Parity {
    fn from(args: ParityArgs) -> Self {
        Self {
            scene: args.scene,
            reading: args.model.into(),
            rays: args.rays as usize,
            ray: args.ray,
            picture: args.picture,
            bvh: args.bvh.unwrap_or_default(),
            threads: args.threads.unwrap_or(0) as usize,
            strict: args.strict.strict,
            json: args.json,
            quiet: args.quiet,
        }
    }
}
