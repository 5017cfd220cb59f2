//! Arguments of `vitrum pixel`.

use std::path::PathBuf;

use clap::{Args, value_parser};

use crate::cli::args::numbers::not_negative;
use crate::cli::args::{ModelArgs, OpticsArgs, SettingsArgs};
use crate::cli::backend::Renderer;

/// Show the tree of rays behind one pixel, in f32 and in f64.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum pixel scenes/glass.toml 320 240
  vitrum pixel scenes/glass.toml 320 240 --depth 3 --svg pixel.svg
  vitrum pixel scenes/hall.toml 100 50 --sample 1 --least 0
  vitrum pixel bunny.obj 64 64 --json > pixel.json

Each ray is shown by the renderer that makes pictures and by the f64 reference.
It has its hit, its angles, the shares that were reflected, transmitted and
absorbed, the light or the occluder of each lamp, and the weight cut off. A
pixel is `ill-conditioned` if its f64 value changes when its camera ray moves
by a few ulps.")]
pub(in crate::cli) struct PixelArgs {
    /// Scene (.toml) or model (.obj, .gltf, .glb, .ply, .stl)
    pub scene: PathBuf,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Column of the picture, from 0 at the left
    pub x: u32,

    /// Row of the picture, from 0 at the top
    pub y: u32,

    /// Only this ray of the pixel's N by N, from 1, row by row [default: all]
    #[arg(long, value_name = "K", value_parser = value_parser!(u32).range(1..=1_048_576), help_heading = "Report")]
    pub sample: Option<u32>,

    /// Fold away rays whose contribution and difference, with all rays that follow, are below this
    #[arg(long, value_name = "LIGHT", value_parser = not_negative, allow_negative_numbers = true,
        default_value_t = 0.001, help_heading = "Report")]
    pub least: f64,

    /// Drawing of the tree to write
    #[arg(long, value_name = "FILE", help_heading = "Report")]
    pub svg: Option<PathBuf>,

    /// Print the whole tree as JSON
    #[arg(long, help_heading = "Report")]
    pub json: bool,

    #[command(flatten)]
    pub settings: SettingsArgs,

    #[command(flatten)]
    pub optics: OpticsArgs,

    /// Back end that traces rays in f32 [default: embree where built in, else native]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub backend: Option<Renderer>,
}
