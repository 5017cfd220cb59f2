//! Validated options of `vitrum map`.

use std::path::PathBuf;

use glam::DVec3;

use super::args::MapArgs;
use crate::cli::backend::Renderer;
use crate::cli::options::{Reading, format_of, refuse_input};
use crate::image::{Destination, Format};
use crate::scene::MapKind;
use crate::{Error, Result, render};

/// A map to write.
#[derive(Debug)]
pub(in crate::cli) struct Map {
    pub scene: PathBuf,
    pub reading: Reading,
    /// In the scene's own coordinates.
    pub at: DVec3,
    pub kind: MapKind,
    pub size: u32,
    pub output: Destination,
    pub format: Format,
    pub samples: Option<u32>,
    pub backend: Renderer,
    /// True if the back end was asked for.
    pub chosen: bool,
    pub options: render::Options,
    pub strict: bool,
    pub quiet: bool,
}

impl TryFrom<MapArgs> for Map {
    type Error = Error;

    fn try_from(args: MapArgs) -> Result<Self> {
        refuse_input("-o", &args.output, [args.scene.as_path()])?;
        let output = Destination::new(&args.output)?;
        let format = format_of(&output)?;
        Ok(Self {
            scene: args.scene,
            reading: args.model.into(),
            at: args.at,
            kind: args.kind,
            size: args.size,
            output,
            format,
            samples: args.samples,
            backend: Renderer::choose(args.backend)?,
            chosen: args.backend.is_some(),
            options: render::Options { threads: args.threads.unwrap_or(0) as usize, ..render::Options::default() },
            strict: args.strict.strict,
            quiet: args.quiet,
        })
    }
}
