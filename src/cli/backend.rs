//! Rendering with the renderer that the command line chooses.

use std::time::{Duration, Instant};

use clap::ValueEnum;
use clap::builder::PossibleValue;

use super::{interrupt, output};
use crate::accel::walk::{TestCounts, TriangleModel, Walk};
use crate::accel::{Accel, Backend, BuildOptions, BuildQuality, BuildStats, Intersector, Unbounded};
use crate::choice::Choice as _;
use crate::error::{Error, Result, Unavailable};
use crate::render::{self, Observer, Options, Outcome, Pixels, Shortfall};
use crate::scene::Scene;
use crate::simd::ReciprocalModel;
use crate::system::threads;

/// Renderer of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Renderer {
    /// Packets of eight rays in `f32`, with a back end.
    Packets(Backend),
    /// Single rays in `f32` in native's hierarchy, with a chosen triangle test and reciprocal.
    Walk(TriangleModel, ReciprocalModel),
    /// Single rays in `f64`.
    Reference,
}

impl ValueEnum for Renderer {
    fn value_variants<'a>() -> &'a [Self] {
        const {
            &[
                Self::Packets(Backend::Native),
                Self::Reference,
                Self::Packets(Backend::Embree),
                Self::Packets(Backend::EmbreeFast),
            ]
        }
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self {
            Self::Packets(backend) => backend.help(),
            Self::Walk(..) => return None,
            Self::Reference => String::from("Renderer in f64: slow, and the arbiter of the others"),
        };
        Some(PossibleValue::new(self.name()).help(help))
    }
}

impl Renderer {
    /// Returns the requested renderer, or this build's default.
    ///
    /// # Errors
    /// [`Unavailable::NotCompiledIn`].
    pub fn choose(wish: Option<Self>) -> Result<Self> {
        match wish.unwrap_or(Self::Packets(Backend::DEFAULT)) {
            Self::Packets(backend) if !backend.is_compiled_in() => Err(Unavailable::NotCompiledIn.into()),
            renderer => Ok(renderer),
        }
    }

    /// Name on the command line, in reports and in metadata.
    pub fn name(self) -> &'static str {
        match self {
            Self::Packets(backend) => backend.name(),
            Self::Walk(..) => Backend::Native.name(),
            Self::Reference => "reference",
        }
    }

    /// Returns true if it may lose rays at the edges of a closed mesh.
    pub fn leaks(self) -> bool {
        matches!(self, Self::Packets(backend) if !backend.is_exact())
    }
}

/// Returns `renderer`, or native if `renderer` is Embree by default and the scene exceeds the sizes that Embree
/// supports.
///
/// # Errors
/// A limit if Embree was requested. The message names the object.
pub(super) fn fit_for(scene: &Scene, renderer: Renderer, asked_for: bool, quiet: bool) -> Result<Renderer> {
    let Renderer::Packets(backend) = renderer else { return Ok(renderer) };
    let (shape, why) = match backend.check_reach(&scene.geometry) {
        Ok(()) => return Ok(renderer),
        Err(Unavailable::OutOfReach { shape, why }) => (shape, why),
        Err(other) => return Err(other.into()),
    };
    let object = &scene.objects[shape];
    let place = match (object.origin.file.as_str(), object.origin.line) {
        ("", _) => String::new(),
        (file, 0) => format!("{file}: "),
        (file, line) => format!("{file}:{line}: "),
    };
    let what = format!("{place}`{}` {why}", object.name);
    if asked_for {
        return Err(Error::Limit(format!("{what}; scale the scene or take --backend native")));
    }
    if !quiet {
        output::log(&format!(
            "warning: {what}; rendering with the native back end instead; give --backend native to leave out this warning"
        ));
    }
    Ok(Renderer::Packets(Backend::Native))
}

/// Picture and its cost.
pub(super) struct Traced {
    pub outcome: Outcome,
    /// Statistics of the hierarchy; `None` if the back end builds it as part of its render.
    pub build: Option<BuildStats>,
    pub build_time: Duration,
    pub render_time: Duration,
    /// Version of the library that traced the rays, if it is not part of this program.
    pub library: Option<String>,
    /// Numbers of triangle tests, if the test was chosen.
    pub lanes: Option<TestCounts>,
}

/// Starts rayon's own threads, which parse models and build hierarchies, once for the whole program. 0 means one per
/// processor.
///
/// # Errors
/// A limit if they cannot be started.
pub(super) fn start_threads(threads: usize) -> Result<()> {
    threads::start_global_pool(threads::count(threads))
}

/// Builds the hierarchy and renders. If `exposure` is given, also searches for missing light that is visible in the
/// picture multiplied by it.
///
/// # Errors
/// `Interrupted`; a limit if threads cannot be started or a library is missing.
pub(super) fn trace(
    scene: &Scene,
    renderer: Renderer,
    bvh: BuildQuality,
    options: &Options,
    observer: &Observer,
    exposure: Option<f32>,
) -> Result<Traced> {
    // Checked before the hierarchy is built.
    render::need(&scene.settings)?;
    let start = Instant::now();
    match renderer {
        Renderer::Packets(backend) => {
            let build = BuildOptions { quality: bvh, threads: options.thread_count() };
            let accel = Accel::build(backend, &scene.geometry, build)?;
            let traced = with(&accel, start, scene, options, observer, exposure)?;
            let library = accel.library().map(|library| format!("Embree {}", library.version));
            Ok(Traced { library, ..traced })
        }
        Renderer::Walk(triangles, reciprocal) => {
            let walk = Walk::try_build(&scene.geometry, bvh, triangles, reciprocal)?;
            let accel = Unbounded::new(walk, &scene.geometry);
            let traced = with(&accel, start, scene, options, observer, exposure)?;
            Ok(Traced { lanes: Some(accel.inner().test_counts()), ..traced })
        }
        Renderer::Reference => {
            let mut outcome = interrupt::heeded(|| render::reference::render(scene, options, observer))?;
            let render_time = start.elapsed();
            if let Some(exposure) = exposure {
                // The native renderer traces the sample again in a fraction of the time.
                let accel = Accel::build(Backend::Native, &scene.geometry, bvh)?;
                // Maps of reflectors are captured only once.
                let maps = outcome.maps.as_ref().map(|report| report.maps.clone());
                let options = &Options { maps, ..options.clone() };
                look(scene, &Pixels::new(&accel, options, observer), options, exposure, &mut outcome)?;
            }
            let build_time = Duration::ZERO;
            Ok(Traced { outcome, build: None, build_time, render_time, library: None, lanes: None })
        }
    }
}

/// Renders with a hierarchy whose build began at `start`.
fn with<I: Intersector>(
    accel: &I,
    start: Instant,
    scene: &Scene,
    options: &Options,
    observer: &Observer,
    exposure: Option<f32>,
) -> Result<Traced> {
    let build_time = start.elapsed();
    let pixels = Pixels::new(accel, options, observer);
    let mut outcome = interrupt::heeded(|| pixels.picture(scene))?;
    let render_time = start.elapsed() - build_time;
    if let Some(exposure) = exposure {
        look(scene, &pixels, options, exposure, &mut outcome)?;
    }
    drop(pixels);
    let build = Some(accel.build_stats());
    Ok(Traced { outcome, build, build_time, render_time, library: None, lanes: None })
}

/// Searches for visible light that the picture lacks.
fn look<I: Intersector>(
    scene: &Scene,
    pixels: &Pixels<I>,
    options: &Options,
    exposure: f32,
    outcome: &mut Outcome,
) -> Result<()> {
    let again = |scene: &Scene, which: &[[u32; 2]]| pixels.render(scene, which);
    outcome.shortfall = interrupt::heeded(|| Shortfall::of(scene, options, outcome, exposure, &again))?;
    Ok(())
}
