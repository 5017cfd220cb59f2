//! Arguments of `vitrum render`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, value_parser};

use crate::accel::BuildQuality;
use crate::accel::walk::TriangleModel;
use crate::cli::args::numbers::{above_zero, bound, duration, exposure};
use crate::cli::args::{EffectArgs, ModelArgs, OpticsArgs, SettingsArgs, StrictArg};
use crate::cli::backend::Renderer;
use crate::cli::choice::{about, about_with, levels};
use crate::image::Bits;
use crate::render::Reflection;
use crate::simd::ReciprocalModel;
use crate::study::Spheres;
use crate::systems::maps::Proxy;

/// Largest number of mirrors in a row, as that of a ray's depth.
const MOST_MIRRORS: i64 = 10_000;

/// Render a scene file or a model to a picture.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum render scenes/glass.toml -o glass.png
  vitrum render bunny.obj --width 800 --height 600 --samples 3
  vitrum render house.obj --up z --material window=thin:1.5 --material roof=metal:copper
  vitrum render bunny.obj --eye 2,1,4 --target 0,1,0 --background '#202830' --light 3,5,4
  vitrum render scenes/glass.toml -o glass.exr --depth 128 --cutoff 0
  vitrum render scenes/glass.toml -o reference.exr --backend reference
  vitrum render scenes/glass.toml -o plain.png --no-fresnel-split
  vitrum render scenes/glass.toml -o proven.png --cutoff-error 0.002
  vitrum render scenes/glass.toml -o polarised.png --fresnel polarised
  vitrum render scenes/glass.toml --quiet --json > summary.json
  vitrum render bunny.obj -o holes.png --triangles moller-trumbore
  vitrum render scenes/mirrors/planar.toml --reflection planar --mirror-levels 4
  vitrum render scenes/mirrors/maps.toml --reflection cube-map --proxy box
  vitrum render scenes/glass.toml --max-error 1/512
  vitrum render scenes/glass.toml --time-budget 2s

The same command gives the same bytes for any number of threads and any tile size.
The summary goes to standard error, --json to standard output.")]
pub(in crate::cli) struct RenderArgs {
    /// Scene (.toml) or model (.obj, .gltf, .glb, .ply, .stl)
    pub scene: PathBuf,

    #[command(flatten)]
    pub model: ModelArgs,

    /// Picture to write: .png, .exr, .hdr or .pfm [default: the scene's name with .png, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub settings: SettingsArgs,

    #[arg(long, help = about::<Bits>(), value_parser = levels::<Bits>(), help_heading = "Picture")]
    pub bits: Option<Bits>,

    /// Multiply all colours by 2 to the power EV
    #[arg(long, value_name = "EV", value_parser = exposure, allow_negative_numbers = true, help_heading = "Picture")]
    pub exposure: Option<f32>,

    /// End rays so that, provably, no channel of any pixel changes by more than E
    #[arg(long, value_name = "E", value_parser = above_zero, allow_negative_numbers = true, conflicts_with = "cutoff",
        help_heading = "Light")]
    pub cutoff_error: Option<f32>,

    #[command(flatten)]
    pub optics: OpticsArgs,

    #[arg(long, help = about::<Reflection>(), value_parser = levels::<Reflection>(), help_heading = "Light")]
    pub reflection: Option<Reflection>,

    /// Most mirrors in a row under --reflection planar; light that needs more is left out [default: as --depth]
    #[arg(long, value_name = "0..10000", value_parser = value_parser!(u32).range(0..=MOST_MIRRORS), help_heading = "Light")]
    pub mirror_levels: Option<u32>,

    #[arg(long, help = about::<Proxy>(), value_parser = levels::<Proxy>(), help_heading = "Light")]
    pub proxy: Option<Proxy>,

    /// Exact spheres, or meshes with this many bands [default: exact]
    #[arg(long, value_name = "exact|BANDS", value_parser = spheres, help_heading = "Light")]
    pub spheres: Option<Spheres>,

    #[command(flatten)]
    pub effects: EffectArgs,

    /// Back end that traces rays [default: embree where built in, else native]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub backend: Option<Renderer>,

    #[arg(long, help = about::<BuildQuality>(), value_parser = levels::<BuildQuality>(), help_heading = "Machine")]
    pub bvh: Option<BuildQuality>,

    #[arg(long, help = about_with::<TriangleModel>("the back end's own"), value_parser = levels::<TriangleModel>(), help_heading = "Machine")]
    pub triangles: Option<TriangleModel>,

    #[arg(long, help = about::<ReciprocalModel>(), value_parser = levels::<ReciprocalModel>(), help_heading = "Machine")]
    pub reciprocal: Option<ReciprocalModel>,

    /// Render with the cheapest settings that keep every channel within E (1/512, 0.002) of f64. Options set explicitly are kept
    #[arg(long, value_name = "E", value_parser = bound, conflicts_with_all = ["time_budget", "exposure"], help_heading = "Budget")]
    pub max_error: Option<f64>,

    /// Render with the most accurate settings predicted to take at most TIME (2s, 500ms). Options set explicitly are kept
    #[arg(long, value_name = "TIME", value_parser = duration, help_heading = "Budget")]
    pub time_budget: Option<Duration>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024), help_heading = "Machine")]
    pub threads: Option<u32>,

    /// Edge of the squares that threads work on, in pixels
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=1024), default_value_t = 32,
        help_heading = "Machine")]
    pub tile: u32,

    /// Camera of a glTF model that is rendered by itself [default: its first one, else one that shows all of it]
    #[arg(long, value_name = "NAME", help_heading = "Picture")]
    pub camera: Option<String>,

    #[command(flatten, next_help_heading = "Reports")]
    pub strict: StrictArg,

    /// Print the summary as JSON on standard output
    #[arg(long, help_heading = "Reports")]
    pub json: bool,

    /// No progress bar, no warnings and no summary
    #[arg(short, long, help_heading = "Reports")]
    pub quiet: bool,
}

fn spheres(text: &str) -> Result<Spheres, String> {
    if text == "exact" {
        return Ok(Spheres::Exact);
    }
    match text.parse() {
        Ok(n @ 2..=4096) => Ok(Spheres::Bands(n)),
        _ => Err(String::from("neither `exact` nor a number of bands, 2 to 4096")),
    }
}
