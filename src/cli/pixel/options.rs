//! Validated options of `vitrum pixel`.

use std::path::PathBuf;

use super::args::PixelArgs;
use crate::accel::Backend;
use crate::cli::backend::Renderer;
use crate::cli::options::choices::refraction;
use crate::cli::options::{Overrides, Reading, refuse_input};
use crate::image::Destination;
use crate::render;
use crate::{Error, Result};

/// Pixel to examine.
#[derive(Debug)]
pub(in crate::cli) struct Pixel {
    pub scene: PathBuf,
    pub reading: Reading,
    pub x: u32,
    pub y: u32,
    /// Sample to show, from 1; `None` for all.
    pub sample: Option<u32>,
    /// Contributions and differences below this are folded away.
    pub least: f64,
    pub svg: Option<Destination>,
    pub json: bool,
    pub overrides: Overrides,
    pub backend: Backend,
    pub options: render::Options,
}

impl TryFrom<PixelArgs> for Pixel {
    type Error = Error;

    fn try_from(args: PixelArgs) -> Result<Self> {
        let Renderer::Packets(backend) = Renderer::choose(args.backend)? else {
            return Err(Error::Usage(String::from(
                "--backend reference: its f64 is always shown; name what is to be shown beside it, such as native",
            )));
        };
        let refraction = refraction(args.optics.refraction, args.optics.oliveira)?;
        if refraction.is_mapped() {
            return Err(Error::Usage(format!(
                "--refraction {}: light that a map shows has no ray to be recorded; take another --refraction",
                refraction.name()
            )));
        }
        let svg = match args.svg {
            None => None,
            Some(name) => {
                refuse_input("--svg", &name, [args.scene.as_path()])?;
                Some(Destination::new(&name)?)
            }
        };
        Ok(Self {
            scene: args.scene,
            reading: args.model.into(),
            x: args.x,
            y: args.y,
            sample: args.sample,
            least: args.least,
            svg,
            json: args.json,
            overrides: Overrides::new(args.settings, args.optics),
            backend,
            options: render::Options {
                fresnel: args.optics.fresnel.unwrap_or_default(),
                refraction,
                threads: 1,
                ..render::Options::default()
            },
        })
    }
}
