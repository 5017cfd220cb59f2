//! Arguments of `vitrum map`.

use std::path::PathBuf;

use clap::{Args, value_parser};
use glam::DVec3;

use crate::cli::args::{ModelArgs, StrictArg};
use crate::cli::backend::Renderer;
use crate::cli::choice::{about, levels};
use crate::scene::MapKind;

/// Write an environment map: the view in all directions from a place in a scene.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum map scenes/mirrors/maps.toml --at 0,1,0 --kind latlong -o map.exr
  vitrum map scenes/mirrors/maps.toml --at 0,1,0 --kind cube --size 512 -o cube.exr

cube     six faces side by side, +x -x +y -y +z -z, oriented as in OpenGL
sphere   a mirrored ball seen along -z; its rim is the direction -z
latlong  the middle column is towards -z, u = 0.75 is +x, the top row is +y

A scene takes a map as its environment: [environment] type = \"cube\", \"sphere\" or
\"latlong\", file = \"map.exr\". Values are linear radiance; .exr and .pfm keep them.")]
pub(in crate::cli) struct MapArgs {
    /// Scene (.toml) or model (.obj, .gltf, .glb, .ply, .stl)
    pub scene: PathBuf,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Place of the map, in the scene's coordinates
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    pub at: DVec3,

    #[arg(long, help = about::<MapKind>(), value_parser = levels::<MapKind>())]
    pub kind: MapKind,

    /// Rows of the map; a cube has six times as many columns, a latlong map twice as many
    #[arg(long, value_name = "TEXELS", value_parser = value_parser!(u32).range(1..=16384), default_value_t = 256)]
    pub size: u32,

    /// Picture to write: .exr, .hdr, .pfm or .png
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// N by N rays a texel [default: the scene's]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub samples: Option<u32>,

    /// Back end that traces rays [default: embree where built in, else native]
    #[arg(long, value_enum)]
    pub backend: Option<Renderer>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    #[command(flatten)]
    pub strict: StrictArg,

    /// No progress bar and no warnings
    #[arg(short, long)]
    pub quiet: bool,
}

fn place(text: &str) -> Result<DVec3, String> {
    let numbers: Vec<f64> = text.split(',').map_while(|n| n.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, z] if text.split(',').count() == 3 && [x, y, z].iter().all(|n| n.is_finite()) => Ok(DVec3::new(x, y, z)),
        _ => Err(String::from("is not three finite numbers with commas between; write X,Y,Z")),
    }
}
