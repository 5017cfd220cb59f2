//! `vitrum parity`, checked.

use std::path::PathBuf;

use crate::accel::BuildQuality;
use crate::cli::args::ParityArgs;
use crate::cli::options::SmallPicture;
use crate::trial::shown::Ray;

/// Paths to be compared ray by ray.
#[derive(Debug)]
pub(in crate::cli) struct Parity {
    pub scene: PathBuf,
    /// Rays of each kind.
    pub rays: usize,
    /// The only ray, where one is asked for.
    pub ray: Option<Ray>,
    pub picture: SmallPicture,
    pub bvh: BuildQuality,
    /// 0 is one a processor.
    pub threads: usize,
    /// Warnings are errors.
    pub strict: bool,
    pub json: bool,
    pub quiet: bool,
}

impl From<ParityArgs> for Parity {
    fn from(args: ParityArgs) -> Self {
        Self {
            scene: args.scene,
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
