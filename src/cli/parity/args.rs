//! Arguments of `vitrum parity`.

use std::path::PathBuf;

use clap::{Args, value_parser};

use crate::accel::BuildQuality;
use crate::cli::args::{ModelArgs, StrictArg};
use crate::cli::choice::{about, levels};
use crate::cli::options::SmallPicture;
use crate::trial::shown::{self, Ray};

/// Trace the same rays by every path and judge the differences.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum parity scenes/glass.toml
  vitrum parity bunny.obj --rays 100000 --json
  vitrum parity bunny.obj --ray=0,1,5,0,0,-1

The rays are those of pictures, and rays aimed at edges, at corners and at the
ends of their own intervals. They are traced by the native path and, if it is
available, by Embree in its robust and fast modes. An answer that differs from
the f64 reference is undecidable in f32 (by a margin below the bound on its
error) or wrong. Then each path makes a small picture, which is compared with a
picture of the same shading from the reference's hits; pixels at edges and
pixels that magnify roundings are counted separately.
A crack is an open edge, or triangles that meet without sharing corners: a ray
may pass there. With --ray one ray is traced by every path, and no picture is
made; reports print the option for each wrong ray.
Exits 1 if the native path is wrong anywhere.")]
pub(in crate::cli) struct ParityArgs {
    /// Scene (.toml) or model (.obj, .gltf, .glb, .ply, .stl)
    pub scene: PathBuf,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Rays of each kind
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=16_777_216), default_value_t = 100_000)]
    pub rays: u32,

    /// Send this ray alone: start, direction, and the interval of t [default: 0,inf]
    #[arg(long, value_name = "X,Y,Z,DX,DY,DZ[,TMIN,TMAX]", value_parser = shown::read, allow_hyphen_values = true,
          conflicts_with_all = ["rays", "width", "height"])]
    pub ray: Option<Ray>,

    #[command(flatten)]
    pub picture: SmallPicture,

    #[arg(long, help = about::<BuildQuality>(), value_parser = levels::<BuildQuality>())]
    pub bvh: Option<BuildQuality>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    #[command(flatten)]
    pub strict: StrictArg,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// No progress bar
    #[arg(short, long)]
    pub quiet: bool,
}
