//! From the choice of a back end to the picture it makes.

use std::time::{Duration, Instant};

use super::args::BackendArg;
use super::interrupt;
#[cfg(feature = "embree")]
use super::output;
#[cfg(not(feature = "embree"))]
use crate::Error;
use crate::Result;
use crate::accel::native::Native;
use crate::accel::walk::TriangleModel;
use crate::accel::walk::{TestCounts, Walk};
use crate::accel::{BuildQuality, BuildStats, Intersector, Unbounded};
use crate::render::{self, Observer, Options, Outcome, Pixels, Shortfall};
use crate::scene::Scene;
use crate::simd::ReciprocalModel;
use crate::system::threads;

/// What traces rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Backend {
    /// The eight-wide hierarchy, in `f32`.
    Native,
    /// The same hierarchy, one ray at a time by a triangle test and a reciprocal of choice.
    Walk(TriangleModel, ReciprocalModel),
    /// The scalar renderer in `f64`.
    Reference,
    /// Embree, in one of its modes.
    #[cfg(feature = "embree")]
    Embree(crate::accel::embree::Mode),
}

impl Backend {
    /// The one that was asked for, or this build's default.
    ///
    /// # Errors
    /// A limit, where this build has no Embree.
    #[cfg(feature = "embree")]
    pub fn choose(wish: Option<BackendArg>) -> Result<Self> {
        use crate::accel::embree::Mode;
        Ok(match wish {
            Some(BackendArg::Native) => Self::Native,
            Some(BackendArg::Reference) => Self::Reference,
            None | Some(BackendArg::Embree) => Self::Embree(Mode::Robust),
            Some(BackendArg::EmbreeFast) => Self::Embree(Mode::Fast),
        })
    }

    /// The one that was asked for, or this build's default.
    ///
    /// # Errors
    /// A limit, where this build has no Embree.
    #[cfg(not(feature = "embree"))]
    pub fn choose(wish: Option<BackendArg>) -> Result<Self> {
        match wish {
            None | Some(BackendArg::Native) => Ok(Self::Native),
            Some(BackendArg::Reference) => Ok(Self::Reference),
            Some(BackendArg::Embree | BackendArg::EmbreeFast) => Err(Error::Limit(String::from(
                "--backend embree: this program was built without it; build with `cargo build --release \
                 --features embree`, or take --backend native",
            ))),
        }
    }

    /// The name in reports and metadata, as the command line has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Native | Self::Walk(..) => "native",
            Self::Reference => "reference",
            #[cfg(feature = "embree")]
            Self::Embree(crate::accel::embree::Mode::Robust) => "embree",
            #[cfg(feature = "embree")]
            Self::Embree(crate::accel::embree::Mode::Fast) => "embree-fast",
        }
    }
}

impl Backend {
    /// Returns true if it may lose rays at the edges of a closed mesh.
    #[cfg(feature = "embree")]
    pub fn leaks(self) -> bool {
        matches!(self, Self::Embree(_))
    }

    /// Returns true if it may lose rays at the edges of a closed mesh.
    #[cfg(not(feature = "embree"))]
    #[expect(clippy::unused_self, reason = "the twin of the one with Embree")]
    pub fn leaks(self) -> bool {
        false
    }
}

/// The back end for `scene`: `backend`, or native where that is Embree, which was not asked for, and the scene reaches
/// beyond what Embree finds.
///
/// # Errors
/// A limit, where it was asked for. The message names the object.
#[cfg(feature = "embree")]
pub(super) fn fit_for(scene: &Scene, backend: Backend, asked_for: bool, quiet: bool) -> Result<Backend> {
    use crate::accel::embree::reach::{self, Lost};
    let Backend::Embree(_) = backend else { return Ok(backend) };
    let Some(Lost { shape, why }) = reach::lost(&scene.geometry) else { return Ok(backend) };
    let object = &scene.objects[shape];
    let place = match (object.origin.file.as_str(), object.origin.line) {
        ("", _) => String::new(),
        (file, 0) => format!("{file}: "),
        (file, line) => format!("{file}:{line}: "),
    };
    let what = format!("{place}`{}` {why}", object.name);
    if asked_for {
        return Err(crate::Error::Limit(format!("{what}; scale the scene or take --backend native")));
    }
    if !quiet {
        output::log(&format!(
            "warning: {what}; rendering with the native back end instead; give --backend native to leave out this warning"
        ));
    }
    Ok(Backend::Native)
}

/// The back end for a scene: without Embree, the one that was chosen.
///
/// # Errors
/// None.
#[cfg(not(feature = "embree"))]
#[expect(clippy::unnecessary_wraps, reason = "the twin of the one with Embree")]
pub(super) fn fit_for(_: &Scene, backend: Backend, _: bool, _: bool) -> Result<Backend> {
    Ok(backend)
}

/// A picture and what it took.
pub(super) struct Traced {
    pub outcome: Outcome,
    /// What was built; none where the back end builds as part of its render.
    pub build: Option<BuildStats>,
    pub build_time: Duration,
    pub render_time: Duration,
    /// Version of the library that traced the rays, where it was not this program itself.
    pub library: Option<String>,
    /// TestCounts of triangle tests, where the test was chosen.
    pub lanes: Option<TestCounts>,
}

/// Starts rayon's own threads, which build trees, once for the whole program.
///
/// # Errors
/// A limit, where they cannot be started.
pub(super) fn start_threads(options: &Options) -> Result<()> {
    threads::start_global_pool(options.thread_count())
}

/// Builds what `backend` needs and renders; looks for missing light in a picture that will be multiplied by `exposure`, where
/// that is given.
///
/// # Errors
/// `Interrupted`; a limit, where threads cannot be started or a library is missing.
pub(super) fn trace(
    scene: &Scene,
    backend: Backend,
    bvh: BuildQuality,
    options: &Options,
    observer: &Observer,
    exposure: Option<f32>,
) -> Result<Traced> {
    // Before the work of building.
    render::need(&scene.settings)?;
    let start = Instant::now();
    match backend {
        Backend::Native => {
            Ok(with(Native::try_build_as(&scene.geometry, bvh)?, start, scene, options, observer, exposure)?.0)
        }
        Backend::Walk(triangles, reciprocal) => {
            let walk = Walk::try_build(&scene.geometry, bvh, triangles, reciprocal)?;
            let (traced, accel) = with(walk, start, scene, options, observer, exposure)?;
            Ok(Traced { lanes: Some(accel.inner().test_counts()), ..traced })
        }
        Backend::Reference => {
            let mut outcome = interrupt::heeded(|| render::reference::render(scene, options, observer))?;
            let render_time = start.elapsed();
            if let Some(exposure) = exposure {
                // Native follows a sample further in a fraction of the time.
                let accel = Unbounded::new(Native::build_as(&scene.geometry, bvh), &scene.geometry);
                look(scene, &accel, options, observer, exposure, &mut outcome)?;
            }
            let build_time = Duration::ZERO;
            Ok(Traced { outcome, build: None, build_time, render_time, library: None, lanes: None })
        }
        #[cfg(feature = "embree")]
        Backend::Embree(mode) => {
            use crate::accel::embree::{self, Embree};
            let threads = options.thread_count();
            let wish = embree::Options { mode, quality: bvh.into(), threads, ..embree::Options::default() };
            let built = Embree::build(&scene.geometry, &wish)?;
            let [major, minor, patch] = built.library().version;
            let traced = with(built, start, scene, options, observer, exposure)?.0;
            Ok(Traced { library: Some(format!("Embree {major}.{minor}.{patch}")), ..traced })
        }
    }
}

/// Renders with a hierarchy whose build began at `start`.
fn with<I: Intersector>(
    bounded: I,
    start: Instant,
    scene: &Scene,
    options: &Options,
    observer: &Observer,
    exposure: Option<f32>,
) -> Result<(Traced, Unbounded<I>)> {
    let accel = Unbounded::new(bounded, &scene.geometry);
    let build_time = start.elapsed();
    let mut outcome = interrupt::heeded(|| render::render(scene, &accel, options, observer))?;
    let render_time = start.elapsed() - build_time;
    if let Some(exposure) = exposure {
        look(scene, &accel, options, observer, exposure, &mut outcome)?;
    }
    let build = Some(accel.build_stats());
    Ok((Traced { outcome, build, build_time, render_time, library: None, lanes: None }, accel))
}

/// Looks for visible light that a picture lacks.
fn look<I: Intersector>(
    scene: &Scene,
    accel: &I,
    options: &Options,
    observer: &Observer,
    exposure: f32,
    outcome: &mut Outcome,
) -> Result<()> {
    let pixels = Pixels::new(accel, options, observer);
    let again = |scene: &Scene, which: &[[u32; 2]]| pixels.render(scene, which);
    outcome.shortfall = interrupt::heeded(|| Shortfall::of(scene, options, outcome, exposure, &again))?;
    Ok(())
}
