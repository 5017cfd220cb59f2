//! Arguments of `vitrum bench`.

use std::path::PathBuf;

use clap::{Args, value_parser};

use crate::accel::BuildQuality;
use crate::cli::args::ModelArgs;
use crate::cli::choice::levels;
use crate::trial::RayKind;

/// Time the back ends against each other on the same rays, or on whole pictures.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum bench bunny.obj dragon.obj
  vitrum bench scenes/glass.toml --threads 1 --rounds 21
  vitrum bench bunny.obj --rays primary,shadow --html bunny.html
  vitrum bench bunny.obj --json > bunny.json
  vitrum bench --frames scenes/glass.toml scenes/goblet.toml
  vitrum bench --sweep --threads 1 --plot sweep.svg

All contenders trace the same rays, which are prepared before. They take turns,
and the figure is the median over the rounds. Contenders that do not find the
same hits are not timed: the rays that differ are printed, and the program
exits 1. Infinite planes are left out. A machine without other work gives
narrow spreads.

With --frames whole pictures of the scenes are timed by turns, in the size of
the scene with one ray per pixel; building is not part of their time.")]
pub(in crate::cli) struct BenchArgs {
    /// Scenes (.toml) or models (.obj, .gltf, .glb, .ply, .stl)
    #[arg(required_unless_present = "sweep", value_name = "SCENE|MESH")]
    pub scenes: Vec<PathBuf>,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Time whole pictures of the scenes instead of rays
    #[arg(long, conflicts_with_all = ["sweep", "rays", "size", "one_in", "builds", "html", "plot"])]
    pub frames: bool,

    /// Time primary and diffuse rays at one landscape, divided into so many triangles [default sizes: 1 k to 10 M]
    #[arg(
        long, value_name = "TRIANGLES,...", num_args = 0..=1, require_equals = true, value_delimiter = ',',
        default_missing_value = "1000,3162,10000,31623,100000,316228,1000000,3162278,10000000",
        value_parser = value_parser!(u32).range(2..=100_000_000), conflicts_with = "scenes"
    )]
    pub sweep: Option<Vec<u32>>,

    /// Picture (SVG) of the sweep to write
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,

    /// Build quality of the native hierarchy; Embree's is MEDIUM [default: default]
    #[arg(long, value_parser = levels::<BuildQuality>())]
    pub bvh: Option<BuildQuality>,

    /// Threads that trace and build [default: 1, then one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Runs of each contender
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=10_000), default_value_t = 11)]
    pub rounds: u32,

    /// Builds of each hierarchy
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 3)]
    pub builds: u32,

    /// Kinds of rays [default: all]
    #[arg(long, value_parser = levels::<RayKind>(), value_name = "KIND,...", value_delimiter = ',')]
    pub rays: Vec<RayKind>,

    /// Edge of the picture that the rays start from, in pixels; a multiple of 8
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(8..=8192), default_value_t = 1024)]
    pub size: u32,

    /// Take one 8 x 8 tile of the picture in N
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=65536), default_value_t = 4)]
    pub one_in: u32,

    /// Print the figures as JSON
    #[arg(long)]
    pub json: bool,

    /// Page with bars to write
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,

    /// No progress bar, no warnings and no table
    #[arg(short, long)]
    pub quiet: bool,
}
