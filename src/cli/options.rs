//! The command line as types, checked as a whole: past this point there are no flags.

mod effects;
mod explain;
mod formulas;
mod pixel;
mod price;

use std::path::{Path, PathBuf};

use clap::ValueEnum as _;

use super::args::{
    BackendArg, BenchArgs, BitsArg, BvhArg, CompareArgs, FresnelArg, GroupArg, ParityArgs, PathArg, RaysArg,
    ReciprocalArg, ReflectionArg, RefractionArg, RenderArgs, ShadowsArg, TrianglesArg, VerifyArgs,
};
use super::backend::Backend;
use crate::accel::BuildQuality;
use crate::accel::native::TriangleModel;
use crate::effects::Effect;
use crate::image::{Bits, Destination, Format};
use crate::optics::{FresnelModel, Oliveira, RefractionModel};
use crate::scene::{Settings, ShadowRule};
use crate::simd::ReciprocalModel;
use crate::study::budget::Wish;
use crate::study::{Axis, Spheres};
use crate::trial::verify::{self, Group};
use crate::trial::{Picture, Plan, RayKind};
use crate::{Error, Result, render};
pub(super) use explain::Explain;
pub(super) use formulas::Formulas;
pub(super) use pixel::Pixel;
pub(super) use price::Price;

/// Pixels that one picture may have: 2^27, some 6 GiB while it is rendered.
const MOST_PIXELS: u64 = 1 << 27;

/// A picture to be rendered.
#[derive(Debug)]
pub(super) struct Render {
    pub scene: PathBuf,
    pub output: Destination,
    pub format: Format,
    pub bits: Bits,
    /// Factor on all colours.
    pub exposure: Exposure,
    pub overrides: Overrides,
    /// What the scene's exact spheres are.
    pub spheres: Spheres,
    pub backend: Backend,
    pub bvh: BuildQuality,
    pub options: render::Options,
    /// What the free choices are made for, where that is asked.
    pub wish: Option<Wish>,
    /// Choices that the command line made.
    pub fixed: Vec<Axis>,
    /// Makes every oddity an error.
    pub strict: bool,
    pub json: bool,
    pub quiet: bool,
}

/// A factor on all colours, `2^ev`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Exposure {
    pub ev: f32,
}

impl Exposure {
    /// The factor itself.
    pub fn factor(self) -> f32 {
        self.ev.exp2()
    }
}

/// Settings of the scene that the command line replaces.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Overrides {
    width: Option<u32>,
    height: Option<u32>,
    samples: Option<u32>,
    depth: Option<u32>,
    cutoff: Option<f32>,
    shadows: Option<ShadowRule>,
    wavelengths: Option<u32>,
}

impl Overrides {
    /// Replaces what was given.
    ///
    /// # Errors
    /// A limit, where the picture is then too large.
    pub fn apply(&self, settings: &mut Settings) -> Result<()> {
        settings.width = self.width.unwrap_or(settings.width);
        settings.height = self.height.unwrap_or(settings.height);
        settings.samples = self.samples.unwrap_or(settings.samples);
        settings.max_depth = self.depth.unwrap_or(settings.max_depth);
        settings.cutoff = self.cutoff.unwrap_or(settings.cutoff);
        settings.shadows = self.shadows.unwrap_or(settings.shadows);
        settings.wavelengths = self.wavelengths.unwrap_or(settings.wavelengths);
        refuse_large(settings)
    }
}

/// # Errors
/// A limit, where the picture is too large.
fn refuse_large(settings: &Settings) -> Result<()> {
    let (width, height) = (settings.width, settings.height);
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(Error::Limit(format!(
            "a picture of {width} by {height} pixels is too large; at most {MOST_PIXELS} pixels are rendered"
        )));
    }
    Ok(())
}

impl TryFrom<RenderArgs> for Render {
    type Error = Error;

    fn try_from(args: RenderArgs) -> Result<Self> {
        let effects = effects::effects(&args.effects)?;
        let bent = args.refraction.is_some_and(|r| r != RefractionArg::Stable).then_some("--refraction");
        effects::refuse_contradiction(&effects, Effect::Refraction, bent)?;
        let straight = matches!(args.shadows, Some(ShadowsArg::Straight)).then_some("--shadows straight");
        effects::refuse_contradiction(&effects, Effect::ShadowsThroughGlass, straight)?;
        let spread = args.wavelengths.map(|_| "--wavelengths");
        effects::refuse_contradiction(&effects, Effect::Dispersion, spread)?;
        let backend = backend(&args)?;
        let name = match args.output {
            Some(name) => name,
            None => default_output(&args.scene)?,
        };
        refuse_input("-o", &name, [args.scene.as_path()])?;
        let output = Destination::new(&name)?;
        let format = format_of(&output)?;
        if args.bits.is_some() && format != Format::Png {
            return Err(Error::Usage(format!(
                "--bits is for PNG; {} has samples of its own kind: leave it out, or end {} in .png",
                format.name(),
                name.display()
            )));
        }
        let fixed = [
            (Axis::Fresnel, args.fresnel.is_some()),
            (Axis::Refraction, args.refraction.is_some()),
            (Axis::Reflection, args.reflection.is_some()),
            (Axis::Shadows, args.shadows.is_some()),
            (Axis::Spheres, args.spheres.is_some()),
            (Axis::Cutoff, args.cutoff.is_some() || args.cutoff_error.is_some()),
            (Axis::Depth, args.depth.is_some()),
            (Axis::Backend, args.backend.is_some() || matches!(backend, Backend::Walk(..))),
            (Axis::Triangles, args.triangles.is_some()),
            (Axis::Reciprocal, args.reciprocal.is_some()),
        ];
        if args.bvh.is_some() && backend == Backend::Reference {
            return Err(Error::Usage(String::from("--bvh: the f64 renderer has no hierarchy to build; leave it out")));
        }
        let wish = args.max_error.map(Wish::MaxError).or(args.time_budget.map(Wish::Time));
        if wish.is_some() && backend == Backend::Reference {
            return Err(Error::Usage(String::from(
                "--backend reference: f64 is exact already; leave --max-error or --time-budget out",
            )));
        }
        if let (Some(_), Some(left_out)) = (wish, effects.without.iter().next()) {
            return Err(Error::Usage(format!(
                "--{}: a budget is for the whole of a scene's effects; leave it out, or --max-error and --time-budget",
                left_out.flag()
            )));
        }
        Ok(Self {
            scene: args.scene,
            output,
            format,
            bits: match args.bits {
                None | Some(BitsArg::Eight) => Bits::Eight,
                Some(BitsArg::Sixteen) => Bits::Sixteen,
            },
            exposure: Exposure { ev: args.exposure.unwrap_or(0.0) },
            overrides: Overrides {
                width: args.width,
                height: args.height,
                samples: args.samples,
                depth: args.depth,
                cutoff: args.cutoff,
                wavelengths: args.wavelengths,
                shadows: args.shadows.map(Into::into),
            },
            spheres: args.spheres.unwrap_or(Spheres::Exact),
            wish,
            fixed: fixed.into_iter().filter(|(_, given)| *given).map(|(axis, _)| axis).collect(),
            backend,
            bvh: quality(args.bvh),
            options: render::Options {
                fresnel: args.fresnel.unwrap_or(FresnelArg::Exact).into(),
                refraction: args.refraction.unwrap_or(RefractionArg::Stable).into(),
                oliveira: oliveira(args.refraction.unwrap_or(RefractionArg::Stable), args.oliveira)?,
                reflection: match args.reflection {
                    None | Some(ReflectionArg::Traced) => render::Reflection::Traced,
                    Some(ReflectionArg::Environment) => render::Reflection::Environment,
                    Some(ReflectionArg::None) => render::Reflection::None,
                },
                effects,
                cutoff_error: args.cutoff_error,
                threads: args.threads.unwrap_or(0) as usize,
                tile: args.tile,
            },
            strict: args.strict,
            json: args.json,
            quiet: args.quiet,
        })
    }
}

/// What traces rays.
///
/// # Errors
/// Usage, where a triangle test or a reciprocal is chosen for a back end that has its own; a limit, where this build has
/// no Embree.
fn backend(args: &RenderArgs) -> Result<Backend> {
    let flag = match (args.triangles, args.reciprocal) {
        (Some(_), _) => "--triangles",
        (None, Some(_)) => "--reciprocal",
        (None, None) => return Backend::choose(args.backend),
    };
    if let Some(given @ (BackendArg::Reference | BackendArg::Embree | BackendArg::EmbreeFast)) = args.backend {
        let name = given.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
        return Err(Error::Usage(format!(
            "{flag}: is a choice of the native hierarchy, --backend {name} has its own; leave one of them out"
        )));
    }
    let triangles = args.triangles.map_or(TriangleModel::Watertight, Into::into);
    Ok(Backend::Walk(triangles, args.reciprocal.map_or(ReciprocalModel::Exact, Into::into)))
}

impl From<TrianglesArg> for TriangleModel {
    fn from(arg: TrianglesArg) -> Self {
        match arg {
            TrianglesArg::PlaneArea => Self::PlaneArea,
            TrianglesArg::MollerTrumbore => Self::MollerTrumbore,
            TrianglesArg::Pluecker => Self::Pluecker,
            TrianglesArg::Watertight => Self::Watertight,
            TrianglesArg::Certified => Self::Certified,
        }
    }
}

impl From<ReciprocalArg> for ReciprocalModel {
    fn from(arg: ReciprocalArg) -> Self {
        match arg {
            ReciprocalArg::Exact => Self::Exact,
            ReciprocalArg::Newton => Self::Newton,
            ReciprocalArg::Estimate => Self::Estimate,
        }
    }
}

impl From<FresnelArg> for FresnelModel {
    fn from(arg: FresnelArg) -> Self {
        match arg {
            FresnelArg::Exact => Self::Exact,
            FresnelArg::Polarised => Self::Polarised,
            FresnelArg::Schlick => Self::Schlick,
            FresnelArg::Off => Self::Off,
        }
    }
}

impl From<ShadowsArg> for ShadowRule {
    fn from(arg: ShadowsArg) -> Self {
        match arg {
            ShadowsArg::Opaque => Self::Opaque,
            ShadowsArg::Straight => Self::Straight,
        }
    }
}

impl From<RefractionArg> for RefractionModel {
    fn from(arg: RefractionArg) -> Self {
        match arg {
            RefractionArg::Stable => Self::Stable,
            RefractionArg::Trigonometric => Self::Trigonometric,
            RefractionArg::Heckbert => Self::Heckbert,
            RefractionArg::Bec => Self::Bec,
            RefractionArg::Slides => Self::SlidesVector,
            RefractionArg::Oliveira => Self::Oliveira,
            RefractionArg::Straight => Self::StraightThrough,
        }
    }
}

/// The constant of Oliveira's formula.
///
/// # Errors
/// Usage, where it is given for another formula.
fn oliveira(formula: RefractionArg, c: Option<f64>) -> Result<Oliveira> {
    match (formula, c) {
        (_, None) => Ok(Oliveira::GLASS),
        (RefractionArg::Oliveira, Some(c)) => Ok(Oliveira { c }),
        (_, Some(c)) => Err(Error::Usage(format!(
            "--oliveira {c}: only that formula has a constant; add --refraction oliveira, or leave it out"
        ))),
    }
}

/// Two pictures to be compared.
#[derive(Debug)]
pub(super) struct Compare {
    pub a: PathBuf,
    pub b: PathBuf,
    /// Where given, exceeding it is a negative result.
    pub tolerance: Option<f64>,
    /// Share of pixels that may exceed it.
    pub allow_share: f64,
    pub diff: Option<Difference>,
    pub linear: bool,
    pub json: bool,
    pub quiet: bool,
}

/// A picture of the differences to be written.
#[derive(Debug)]
pub(super) struct Difference {
    pub output: Destination,
    pub format: Format,
    /// Factor on the differences; none makes the largest 1.
    pub scale: Option<f64>,
}

impl TryFrom<CompareArgs> for Compare {
    type Error = Error;

    fn try_from(args: CompareArgs) -> Result<Self> {
        let diff = match args.diff {
            None => None,
            Some(name) => {
                refuse_input("--diff", &name, [args.a.as_path(), args.b.as_path()])?;
                let output = Destination::new(&name)?;
                let format = format_of(&output)?;
                Some(Difference { output, format, scale: args.diff_scale })
            }
        };
        Ok(Self {
            a: args.a,
            b: args.b,
            tolerance: args.tolerance,
            allow_share: args.allow_share,
            diff,
            linear: args.linear,
            json: args.json,
            quiet: args.quiet,
        })
    }
}

fn quality(arg: Option<BvhArg>) -> BuildQuality {
    match arg {
        Some(BvhArg::Fast) => BuildQuality::Fast,
        None | Some(BvhArg::Default) => BuildQuality::Default,
        Some(BvhArg::High) => BuildQuality::High,
    }
}

/// A trial of the back ends.
#[derive(Debug)]
pub(super) struct Bench {
    pub scenes: Vec<PathBuf>,
    pub plan: Plan,
    /// Whole pictures instead of rays.
    pub frames: bool,
    /// Triangles of one landscape, again and again, instead of scenes.
    pub sweep: Vec<u32>,
    /// Picture of the sweep to write.
    pub plot: Option<Destination>,
    pub json: bool,
    /// Page to write.
    pub html: Option<Destination>,
    pub quiet: bool,
}

impl TryFrom<BenchArgs> for Bench {
    type Error = Error;

    fn try_from(args: BenchArgs) -> Result<Self> {
        if !args.size.is_multiple_of(8) {
            return Err(Error::Usage(format!("--size {}: not a multiple of 8, the edge of a tile", args.size)));
        }
        let html = match args.html {
            None => None,
            Some(name) => {
                refuse_input("--html", &name, args.scenes.iter().map(PathBuf::as_path))?;
                Some(Destination::new(&name)?)
            }
        };
        let all = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = match args.threads {
            Some(n) => vec![n as usize],
            None if all == 1 => vec![1],
            None => vec![1, all],
        };
        let named = |kind: &RayKind| args.rays.iter().any(|&r| kind_of(r) == *kind);
        let of_a_sweep = |kind: &RayKind| matches!(kind, RayKind::Primary | RayKind::Diffuse);
        let asked = |kind: &RayKind| match args.rays.is_empty() {
            true => args.sweep.is_none() || of_a_sweep(kind),
            false => named(kind),
        };
        if args.plot.is_some() && args.sweep.is_none() {
            return Err(Error::Usage(String::from("--plot: only --sweep is drawn; give it instead of scenes")));
        }
        let plot = args.plot.as_deref().map(Destination::new).transpose()?;
        Ok(Self {
            frames: args.frames,
            plot,
            plan: Plan {
                bvh: quality(args.bvh),
                picture: Picture { edge: args.size, one_in: args.one_in },
                kinds: RayKind::ALL.into_iter().filter(asked).collect(),
                threads,
                rounds: args.rounds as usize,
                builds: args.builds as usize,
            },
            sweep: args.sweep.unwrap_or_default(),
            scenes: args.scenes,
            json: args.json,
            html,
            quiet: args.quiet,
        })
    }
}

fn kind_of(arg: RaysArg) -> RayKind {
    match arg {
        RaysArg::Primary => RayKind::Primary,
        RaysArg::Shadow => RayKind::Shadow,
        RaysArg::Mirror => RayKind::Mirror,
        RaysArg::Refracted => RayKind::Refracted,
        RaysArg::Diffuse => RayKind::Diffuse,
        RaysArg::DiffuseAny => RayKind::DiffuseAny,
    }
}

/// Paths to be compared ray by ray.
#[derive(Debug)]
pub(super) struct Parity {
    pub scene: PathBuf,
    /// Rays of each kind.
    pub rays: usize,
    pub picture: SmallPicture,
    /// 0 is one a processor.
    pub threads: usize,
    pub json: bool,
    pub quiet: bool,
}

/// The size of a picture that is traced in `f64`, too.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmallPicture {
    width: Option<u32>,
    height: Option<u32>,
}

impl SmallPicture {
    /// What it is at most where nothing else is asked for.
    const MOST: [u32; 2] = [320, 240];

    /// Makes the picture of `settings` as large as asked for, or else small, of the same shape as far as pixels allow.
    ///
    /// # Errors
    /// A limit, where it is too large.
    pub fn fit(self, settings: &mut Settings) -> Result<()> {
        let (width, height) = (f64::from(settings.width), f64::from(settings.height));
        let scale = match (self.width, self.height) {
            (Some(w), _) => f64::from(w) / width,
            (None, Some(h)) => f64::from(h) / height,
            (None, None) => (f64::from(Self::MOST[0]) / width).min(f64::from(Self::MOST[1]) / height).min(1.0),
        };
        let scaled = |x: f64| (x * scale).round().max(1.0) as u32;
        settings.width = self.width.unwrap_or(scaled(width));
        settings.height = self.height.unwrap_or(scaled(height));
        refuse_large(settings)
    }
}

impl From<ParityArgs> for Parity {
    fn from(args: ParityArgs) -> Self {
        Self {
            scene: args.scene,
            rays: args.rays as usize,
            picture: SmallPicture { width: args.width, height: args.height },
            threads: args.threads.unwrap_or(0) as usize,
            json: args.json,
            quiet: args.quiet,
        }
    }
}

/// Hard cases to be tried.
#[derive(Debug)]
pub(super) struct Verify {
    /// What to fire at; none for the built-in cases.
    pub scene: Option<PathBuf>,
    pub plan: verify::Plan,
    pub native: bool,
    /// Both modes of it. Only where built in.
    pub embree: bool,
    /// Worker threads; 0 is one a processor.
    pub threads: usize,
    pub json: bool,
    pub quiet: bool,
}

impl TryFrom<VerifyArgs> for Verify {
    type Error = Error;

    fn try_from(args: VerifyArgs) -> Result<Self> {
        let embree = args.backend.contains(&PathArg::Embree);
        if embree {
            Backend::choose(Some(BackendArg::Embree))?;
        }
        let known: &[Group] = if args.scene.is_some() { &Group::OF_SCENE } else { &Group::ALL };
        let mut groups: Vec<Group> = Vec::new();
        for group in args.group.into_iter().map(Group::from) {
            if !known.contains(&group) {
                let names: Vec<&str> = known.iter().map(|g| g.name()).collect();
                let what = if args.scene.is_some() { "a scene" } else { "no scene" };
                return Err(Error::Usage(format!(
                    "--group {}: with {what} the groups are {}",
                    group.name(),
                    names.join(", ")
                )));
            }
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        if groups.is_empty() {
            groups = known.to_vec();
        }
        Ok(Self {
            scene: args.scene,
            plan: verify::Plan { groups, full: args.full },
            native: args.backend.contains(&PathArg::Native),
            embree,
            threads: args.threads.unwrap_or(0) as usize,
            json: args.json,
            quiet: args.quiet,
        })
    }
}

impl From<GroupArg> for Group {
    fn from(arg: GroupArg) -> Self {
        match arg {
            GroupArg::Leaks => Self::Leaks,
            GroupArg::SelfHits => Self::SelfHits,
            GroupArg::Fresnel => Self::Fresnel,
            GroupArg::Refraction => Self::Refraction,
            GroupArg::Reflection => Self::Reflection,
            GroupArg::Matched => Self::Matched,
            GroupArg::Lanes => Self::Lanes,
            GroupArg::Traversal => Self::Traversal,
            GroupArg::Builds => Self::Builds,
            GroupArg::Chains => Self::Chains,
            GroupArg::Parity => Self::Parity,
        }
    }
}

/// The scene's name with `.png`, in the current folder.
fn default_output(scene: &Path) -> Result<PathBuf> {
    match scene.file_stem() {
        Some(stem) => {
            let mut name = stem.to_os_string();
            name.push(".png");
            Ok(name.into())
        }
        None => Err(Error::Usage(format!("{}: no scene file; name one that ends in .toml or .obj", scene.display()))),
    }
}

/// Devices and pipes seldom have an extension; they get PNG.
fn format_of(output: &Destination) -> Result<Format> {
    if output.is_stream() && output.name().extension().is_none() {
        return Ok(Format::Png);
    }
    Format::from_path(output.name())
}

/// Keeps an input from being written over.
///
/// # Errors
/// Usage, where `output` is one of the inputs, under whatever name.
pub(super) fn refuse_input<'a>(flag: &str, output: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
    let Ok(output_file) = output.canonicalize() else {
        return Ok(());
    };
    for input in inputs {
        if output_file.is_file() && input.canonicalize().is_ok_and(|input| input == output_file) {
            return Err(Error::Usage(format!(
                "{flag} {} would overwrite the input {}; choose another name",
                output.display(),
                input.display()
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_to_be_traced_in_f64_is_small_and_keeps_its_shape_unless_told() {
        let fit = |width, height, asked: (Option<u32>, Option<u32>)| {
            let mut settings = Settings { width, height, ..Settings::default() };
            SmallPicture { width: asked.0, height: asked.1 }
                .fit(&mut settings)
                .map(|()| (settings.width, settings.height))
        };
        assert_eq!(fit(1920, 1080, (None, None)).unwrap(), (320, 180));
        assert_eq!(fit(100, 1000, (None, None)).unwrap(), (24, 240));
        assert_eq!(fit(64, 48, (None, None)).unwrap(), (64, 48));
        assert_eq!(fit(1_000_000, 1, (None, None)).unwrap(), (320, 1));
        assert_eq!(fit(640, 480, (Some(1000), None)).unwrap(), (1000, 750));
        assert_eq!(fit(640, 480, (None, Some(48))).unwrap(), (64, 48));
        assert_eq!(fit(640, 480, (Some(7), Some(9))).unwrap(), (7, 9));
        assert_eq!(fit(640, 480, (Some(65536), None)).unwrap_err().exit_code(), 4);
    }
}
