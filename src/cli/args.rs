//! What may be typed, and the help for it. Values are checked one by one here, against each other in [`super::options`].

mod effects;
mod explain;
mod formulas;
mod pixel;
mod price;

use std::path::PathBuf;
use std::sync::LazyLock;

use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};

use crate::simd::level;
use crate::study::Spheres;
pub(super) use effects::EffectArgs;
pub(super) use explain::ExplainArgs;
pub(super) use formulas::{FormulasArgs, KindArg};
pub(super) use pixel::PixelArgs;
pub(super) use price::PriceArgs;

static VERSION: LazyLock<String> = LazyLock::new(|| format!("{} ({})", env!("CARGO_PKG_VERSION"), level::BUILT));

/// A SIMD packet ray tracer: exact refraction and reflection.
#[derive(Debug, Parser)]
#[command(name = "vitrum", version = VERSION.as_str(), arg_required_else_help = true, subcommand_required = true)]
#[command(after_help = "Exit codes:
  0    done
  1    a comparison or check came out negative
  2    wrong input or usage
  3    reading or writing failed
  4    a limit, or a missing back end
  130  interrupted

`vitrum COMMAND --help` has examples.")]
pub(super) struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Render(RenderArgs),
    Explain(ExplainArgs),
    Compare(CompareArgs),
    Parity(ParityArgs),
    Verify(VerifyArgs),
    Bench(BenchArgs),
    Price(PriceArgs),
    Pixel(PixelArgs),
    Doctor(DoctorArgs),
}

/// Render a scene file or an OBJ model to a picture.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum render scenes/glass.toml -o glass.png
  vitrum render bunny.obj --width 800 --height 600 --samples 3
  vitrum render scenes/glass.toml -o glass.exr --depth 40 --cutoff 0
  vitrum render scenes/glass.toml -o reference.exr --backend reference
  vitrum render scenes/glass.toml -o plain.png --no-fresnel-split
  vitrum render scenes/glass.toml -o proven.png --cutoff-error 0.002
  vitrum render scenes/glass.toml -o polarised.png --fresnel polarised
  vitrum render scenes/glass.toml --quiet --json > summary.json
  vitrum render bunny.obj -o holes.png --triangles moller-trumbore
  vitrum render scenes/glass.toml --max-error 1/512
  vitrum render scenes/glass.toml --time-budget 2s

The same command gives the same bytes for any number of threads and any tile size.
The summary goes to standard error, --json to standard output.")]
pub(super) struct RenderArgs {
    /// Scene (.toml) or model (.obj)
    pub scene: PathBuf,

    /// Picture to write: .png, .exr, .hdr or .pfm [default: the scene's name with .png, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Columns of the picture
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536), help_heading = "Picture")]
    pub width: Option<u32>,

    /// Rows of the picture
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536), help_heading = "Picture")]
    pub height: Option<u32>,

    /// N by N rays a pixel; 1 is its centre
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024), help_heading = "Picture")]
    pub samples: Option<u32>,

    /// Bits of a PNG's samples [default: 8]
    #[arg(long, value_enum, help_heading = "Picture")]
    pub bits: Option<BitsArg>,

    /// Multiply all colours by 2 to the power EV
    #[arg(long, value_name = "EV", value_parser = exposure, allow_negative_numbers = true, help_heading = "Picture")]
    pub exposure: Option<f32>,

    /// How often a ray may reflect or refract
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(0..=4096), help_heading = "Light")]
    pub depth: Option<u32>,

    /// End rays whose weight is below this, 0 to 1
    #[arg(long, value_name = "WEIGHT", value_parser = cutoff, allow_negative_numbers = true, help_heading = "Light")]
    pub cutoff: Option<f32>,

    /// Wavelengths that white light divides into where a medium disperses it
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(7..=64), help_heading = "Light")]
    pub wavelengths: Option<u32>,

    /// End rays by proof: what is cut changes no channel of any pixel by more than E
    #[arg(long, value_name = "E", value_parser = above_zero, allow_negative_numbers = true, conflicts_with = "cutoff",
        help_heading = "Light")]
    pub cutoff_error: Option<f32>,

    /// Formula that splits light at a surface [default: exact]
    #[arg(long, value_enum, help_heading = "Light")]
    pub fresnel: Option<FresnelArg>,

    /// Formula that bends light at a surface [default: stable]
    #[arg(long, value_enum, help_heading = "Light")]
    pub refraction: Option<RefractionArg>,

    /// The constant of `--refraction oliveira`, above -1 [default: 0.6645, for glass]
    #[arg(long, value_name = "C", value_parser = above_minus_one, allow_negative_numbers = true, help_heading = "Light")]
    pub oliveira: Option<f64>,

    /// What becomes of light that surfaces reflect [default: traced]
    #[arg(long, value_enum, help_heading = "Light")]
    pub reflection: Option<ReflectionArg>,

    /// What transparent surfaces do to shadows [default: as the scene says]
    #[arg(long, value_enum, help_heading = "Light")]
    pub shadows: Option<ShadowsArg>,

    /// Exact spheres, or as meshes of so many bands [default: exact]
    #[arg(long, value_name = "exact|BANDS", value_parser = spheres, help_heading = "Light")]
    pub spheres: Option<Spheres>,

    #[command(flatten)]
    pub effects: EffectArgs,

    /// What traces the rays [default: embree where built in, else native]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub backend: Option<BackendArg>,

    /// How much work the hierarchy's build is worth; the picture is the same [default: default]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub bvh: Option<BvhArg>,

    /// Ray/triangle test, by native's hierarchy one ray at a time: slow, to compare tests [default: the back end's own]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub triangles: Option<TrianglesArg>,

    /// One over a number in the same walk; estimates differ between CPU makers [default: exact]
    #[arg(long, value_enum, help_heading = "Machine")]
    pub reciprocal: Option<ReciprocalArg>,

    /// Choose what keeps every channel within E (1/512, 0.002), the cheapest; what is given besides stays
    #[arg(long, value_name = "E", value_parser = bound, conflicts_with_all = ["time_budget", "exposure"], help_heading = "Budget")]
    pub max_error: Option<f64>,

    /// Choose what renders within TIME (2s, 500ms), the most accurate; what is given besides stays
    #[arg(long, value_name = "TIME", value_parser = price::duration, help_heading = "Budget")]
    pub time_budget: Option<std::time::Duration>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024), help_heading = "Machine")]
    pub threads: Option<u32>,

    /// Edge of the squares that threads work on, in pixels
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=1024), default_value_t = 32,
        help_heading = "Machine")]
    pub tile: u32,

    /// Make every warning, and everything dropped or clamped, an error
    #[arg(long, help_heading = "Reports")]
    pub strict: bool,

    /// Print the summary as JSON on standard output
    #[arg(long, help_heading = "Reports")]
    pub json: bool,

    /// No progress bar, no warnings and no summary
    #[arg(short, long, help_heading = "Reports")]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum TrianglesArg {
    /// Plane and signed areas, of the lecture notes
    PlaneArea,
    /// Möller and Trumbore
    MollerTrumbore,
    /// Plücker coordinates, as Embree's robust mode
    Pluecker,
    /// Woop, Benthin and Wald's, the renderer's own
    #[value(alias = "woop")]
    Watertight,
    /// f32 with a bound on its error, f64 where that does not decide
    Certified,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ReciprocalArg {
    /// True division
    Exact,
    /// The hardware's estimate and one Newton step
    Newton,
    /// The hardware's estimate
    Estimate,
}

/// Compare two pictures of the same size.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum compare ours.exr theirs.exr
  vitrum compare ours.png theirs.png --tolerance 0.0005 --allow-share 0.001
  vitrum compare ours.exr theirs.exr --diff difference.png

Differences are of linear light; PSNR and SSIM are of the pictures as a screen
shows them. Exits 1 when more pixels than allowed exceed a given --tolerance.")]
pub(super) struct CompareArgs {
    /// A picture: PNG, OpenEXR, Radiance HDR, PFM or JPEG
    pub a: PathBuf,

    /// Another one
    pub b: PathBuf,

    /// Largest difference of a channel that passes [default: 1/255, for the count alone]
    #[arg(long, value_name = "LIGHT", value_parser = not_negative, allow_negative_numbers = true)]
    pub tolerance: Option<f64>,

    /// Share of pixels that may exceed the tolerance, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true, requires = "tolerance", default_value_t = 0.0)]
    pub allow_share: f64,

    /// Picture of the absolute differences to write
    #[arg(long, value_name = "FILE")]
    pub diff: Option<PathBuf>,

    /// Factor on the differences in that picture [default: the largest becomes 1]
    #[arg(long, value_name = "FACTOR", value_parser = not_negative, allow_negative_numbers = true, requires = "diff")]
    pub diff_scale: Option<f64>,

    /// Take the codes of PNG and JPEG as linear light, whatever the files say
    #[arg(long)]
    pub linear: bool,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// Print nothing but errors; the exit code tells
    #[arg(short, long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Trace the same rays by every path and judge what differs.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum parity scenes/glass.toml
  vitrum parity bunny.obj --rays 100000 --json

Rays as pictures need them, and rays aimed at edges, at corners and at the ends
of their own intervals go through the native path and, where they are there,
Embree's robust and fast modes. What differs from the f64 reference is either
undecidable in f32 (by a margin below the bound on its error) or wrong. Then
each makes a small picture, compared with the one that the same shading makes
of the reference's hits; edges and what magnifies roundings are told apart.
Exits 1 when the native path is wrong anywhere.")]
pub(super) struct ParityArgs {
    /// Scene (.toml) or model (.obj)
    pub scene: PathBuf,

    /// Rays of each kind
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=16_777_216), default_value_t = 100_000)]
    pub rays: u32,

    /// Columns of the picture [default: the scene's, at most 320]
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536))]
    pub width: Option<u32>,

    /// Rows of the picture [default: the scene's, at most 240]
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536))]
    pub height: Option<u32>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// No progress bar
    #[arg(short, long)]
    pub quiet: bool,
}

/// Time the back ends against each other on the same rays, or on whole pictures.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum bench bunny.obj dragon.obj
  vitrum bench scenes/glass.toml --threads 1 --rounds 21
  vitrum bench bunny.obj --rays primary,shadow --html bunny.html
  vitrum bench bunny.obj --json > bunny.json
  vitrum bench --frames scenes/glass.toml scenes/goblet.toml
  vitrum bench --sweep --threads 1 --plot sweep.svg

Every contender traces the same rays, made beforehand; they take turns, and the
figure is the median over the rounds. Contenders that do not find the same hits
are not timed: the program says which rays differ and exits 1. Infinite planes
are left out. A quiet machine gives narrow spreads.

With --frames whole pictures of the scenes, as large as they say with one ray a
pixel, take turns instead; building is not part of their time.")]
pub(super) struct BenchArgs {
    /// Scenes (.toml) or models (.obj)
    #[arg(required_unless_present = "sweep", value_name = "SCENE|MESH")]
    pub scenes: Vec<PathBuf>,

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

    /// How the native hierarchy is built; Embree's is MEDIUM [default: default]
    #[arg(long, value_enum)]
    pub bvh: Option<BvhArg>,

    /// Threads that trace and build [default: 1, then one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// How often each contender runs
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=10_000), default_value_t = 11)]
    pub rounds: u32,

    /// How often each hierarchy is built
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 3)]
    pub builds: u32,

    /// Kinds of rays [default: all]
    #[arg(long, value_enum, value_name = "KIND,...", value_delimiter = ',')]
    pub rays: Vec<RaysArg>,

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

/// Say what this machine and this build can do, and what is missing.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum doctor
  vitrum doctor --json

Exits 4 when this binary cannot run here.")]
pub(super) struct DoctorArgs {
    /// Print the findings as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum RaysArg {
    /// From the eye
    Primary,
    /// To a point light, any hit
    Shadow,
    /// Reflected
    Mirror,
    /// Into glass and out of it
    Refracted,
    /// Into the hemisphere by cosine
    Diffuse,
    /// The same, any hit nearby
    DiffuseAny,
}

/// Fire the hard cases of numerics at this machine, or at a scene.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum verify
  vitrum verify --full --json > figures.json
  vitrum verify --backend native,embree --group leaks self-hits
  vitrum verify scenes/glass.toml

Without a scene: closed meshes of all sizes and places, odd meshes, the optics
against an oracle of twice the digits of f64, long chains of reflections.
With one: rays at its corners and edges, judged by the f64 arbiter, and the
triangles that are in trouble, each with its place in the file.
Exits 1 when anything falls short.")]
pub(super) struct VerifyArgs {
    /// Scene (.toml) or model (.obj) to fire at, instead of the built-in cases
    pub scene: Option<PathBuf>,

    /// All the cases (minutes) instead of a sample of them (seconds)
    #[arg(long)]
    pub full: bool,

    /// Paths to try, side by side; embree is tried robust and fast
    #[arg(long, value_enum, value_delimiter = ',', default_value = "native")]
    pub backend: Vec<PathArg>,

    /// Groups to run [default: all]
    #[arg(long, value_name = "NAME", value_enum, num_args = 1.., value_delimiter = ',')]
    pub group: Vec<GroupArg>,

    /// Worker threads [default: one a processor]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// Print nothing but errors; the exit code tells
    #[arg(short, long, conflicts_with = "json")]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PathArg {
    /// Our own eight-wide hierarchy
    Native,
    /// Embree, robust and fast, where built in
    Embree,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum GroupArg {
    /// Rays out of closed meshes
    Leaks,
    /// Rays that meet what they leave
    SelfHits,
    /// Reflectance against the oracle
    Fresnel,
    /// Refracted directions against the oracle
    Refraction,
    /// Mirror directions against the oracle
    Reflection,
    /// Equal media, R + T = 1, one lane beside eight
    Matched,
    /// Spoilt lanes and other orders
    Lanes,
    /// Hits against testing everything
    Traversal,
    /// Trees over garbage
    Builds,
    /// Light after long chains of reflections
    Chains,
    /// Hits at the scene against the arbiter
    Parity,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum BitsArg {
    #[value(name = "8")]
    Eight,
    #[value(name = "16")]
    Sixteen,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum FresnelArg {
    /// The Fresnel equations
    Exact,
    /// The Fresnel equations, polarisation carried along every path
    Polarised,
    /// Schlick's approximation
    Schlick,
    /// The reflectance at normal incidence for every angle
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum RefractionArg {
    /// Snell's law, stable at every index ratio
    Stable,
    /// Snell's law by arc sine and arc cosine
    Trigonometric,
    /// Heckbert's method
    Heckbert,
    /// Bec's method
    Bec,
    /// The lighting slides' vector form
    Slides,
    /// Oliveira's approximation
    Oliveira,
    /// No bending at all
    Straight,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ReflectionArg {
    /// By rays
    Traced,
    /// Looked up in the environment, whatever stands between
    Environment,
    /// Left out, and counted as truncated weight
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ShadowsArg {
    /// They block light
    Opaque,
    /// Light goes straight through, weakened
    Straight,
}

/// Embree's own LOW, MEDIUM and HIGH stand in where Embree traces.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum BvhArg {
    /// Quickest to build, slower to trace: previews
    Fast,
    /// By the surface area heuristic
    Default,
    /// Several times as long to build: long renders where large and small triangles mix
    High,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum BackendArg {
    /// Our own eight-wide hierarchy
    Native,
    /// The f64 renderer: slow, obvious, the arbiter
    Reference,
    /// Embree in its robust mode, where built in
    Embree,
    /// Embree in its fast mode, which may lose rays at edges
    EmbreeFast,
}

/// A difference of a channel: a fraction or a number.
fn bound(text: &str) -> Result<f64, String> {
    let value: f64 = match text.split_once('/') {
        Some((above, below)) => number::<f64>(above)? / number::<f64>(below)?,
        None => number(text)?,
    };
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(String::from("not a number above 0; write 1/512 or 0.002"))
    }
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

fn number<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| String::from("not a number"))
}

fn cutoff(text: &str) -> Result<f32, String> {
    let x: f32 = number(text)?;
    if (0.0..=1.0).contains(&x) { Ok(x) } else { Err(String::from("not in 0 to 1")) }
}

fn above_minus_one(text: &str) -> Result<f64, String> {
    let x: f64 = number(text)?;
    if x > -1.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number above -1")) }
}

fn above_zero(text: &str) -> Result<f32, String> {
    let x: f32 = number(text)?;
    if x > 0.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number above 0")) }
}

fn exposure(text: &str) -> Result<f32, String> {
    let x: f32 = number(text)?;
    if (-64.0..=64.0).contains(&x) { Ok(x) } else { Err(String::from("not in -64 to 64")) }
}

fn share(text: &str) -> Result<f64, String> {
    let x: f64 = number(text)?;
    if (0.0..=1.0).contains(&x) { Ok(x) } else { Err(String::from("not in 0 to 1")) }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let x: f64 = number(text)?;
    if x >= 0.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number of at least 0")) }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definition_of_the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for text in ["nan", "inf", "-0.1", "1.5", "", "a"] {
            assert!(cutoff(text).is_err(), "{text}");
            assert!(share(text).is_err(), "{text}");
        }
        assert!(exposure("nan").is_err() && exposure("65").is_err());
        assert!(not_negative("inf").is_err() && not_negative("-1e-9").is_err());
        assert_eq!((cutoff("0"), exposure("-2"), not_negative("5e-4")), (Ok(0.0), Ok(-2.0), Ok(5e-4)));
    }
}
