//! Validated options of `vitrum price`.

use std::path::PathBuf;
use std::time::Duration;

use super::args::PriceArgs;
use crate::accel::{Backend, BuildQuality};
use crate::cli::backend::Renderer;
use crate::cli::options::Reading;
use crate::study::Axis;
use crate::{Error, Result};

/// Study of one scene.
#[derive(Debug)]
pub(in crate::cli) struct Price {
    pub scene: PathBuf,
    pub reading: Reading,
    pub folder: PathBuf,
    pub limit: Duration,
    pub axes: Vec<Axis>,
    pub size: Option<[u32; 2]>,
    pub samples: u32,
    /// Back end of the default variant.
    pub backend: Backend,
    pub bvh: BuildQuality,
    pub runs: usize,
    /// Number of threads; 0 means one per processor.
    pub threads: usize,
    pub combine: bool,
    pub fresh: bool,
    pub pictures: bool,
    pub json: bool,
    pub quiet: bool,
}

impl TryFrom<PriceArgs> for Price {
    type Error = Error;

    fn try_from(args: PriceArgs) -> Result<Self> {
        let (Some(scene), Some(folder)) = (args.scene, args.output) else {
            return Err(Error::Usage(String::from("price: name a scene and -o a folder, or ask for --formulas")));
        };
        let (backend, folder) = (default_backend(args.backend)?, self::folder(folder)?);
        let axes = if args.axes.is_empty() { Axis::ALL.to_vec() } else { args.axes };
        Ok(Self {
            scene,
            reading: args.model.into(),
            folder,
            limit: args.limit,
            axes,
            size: args.size,
            samples: args.samples,
            backend,
            bvh: args.bvh.unwrap_or_default(),
            runs: args.runs as usize,
            threads: args.threads.unwrap_or(0) as usize,
            combine: !args.single,
            fresh: args.fresh,
            pictures: args.pictures,
            json: args.json,
            quiet: args.quiet,
        })
    }
}

/// Returns the back end of the default picture.
///
/// # Errors
/// - [`Error::Usage`] for a renderer that is no back end of packets.
/// - [`Error::Limit`] if the back end is not available.
pub(in crate::cli) fn default_backend(asked: Option<Renderer>) -> Result<Backend> {
    let backend = match asked {
        Some(Renderer::Packets(backend)) => backend,
        Some(Renderer::Reference | Renderer::Walk(..)) => {
            return Err(Error::Usage(String::from(
                "--backend reference: f64 is what all is held against; take native, embree or embree-fast as the default",
            )));
        }
        None if Backend::Embree.availability().is_ok() => Backend::Embree,
        None => Backend::Native,
    };
    backend.availability()?;
    Ok(backend)
}

/// Checks that the place of a report can be a folder.
///
/// # Errors
/// [`Error::Usage`] if it is a file.
pub(in crate::cli) fn folder(folder: PathBuf) -> Result<PathBuf> {
    if folder.exists() && !folder.is_dir() {
        return Err(Error::Usage(format!("-o {}: is a file; name a folder", folder.display())));
    }
    Ok(folder)
}
