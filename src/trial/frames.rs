//! Whole pictures: the same scene rendered with the native hierarchy and with Embree, in turn.
//!
//! Shading is the same code for all back ends, so the ratio of whole pictures lies between 1 and that of traversal. The
//! share of traversal in a picture is measured separately.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use serde::Serialize;

use super::report::mode_name;
use crate::Result;
use crate::accel::{Accel, Backend, BuildOptions, BuildQuality, BuildStats, Coherence, Intersector};
use crate::geometry::{Hit8, Ray8};
use crate::image::Film;
use crate::measure::Machine;
use crate::measure::Percentiles;
use crate::measure::table::aligned;
use crate::render::{self, Observer, Options};
use crate::scene::Scene;
use crate::simd::Mask8;

/// Difference of a channel above which a pixel of two back ends counts as different.
const TOLERANCE: f32 = 5e-4;

/// All results, in the form of `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Frames {
    /// Machine that it ran on.
    pub machine: Machine,
    /// Pictures, by scene, threads and back end.
    pub frames: Vec<Frame>,
    /// Comparisons of native with Embree.
    pub ratios: Vec<FrameRatio>,
}

/// A picture by one back end.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    /// Name of the scene.
    pub scene: String,
    /// Back end.
    #[serde(serialize_with = "mode_name")]
    pub backend: Backend,
    /// Number of threads that rendered.
    pub threads: usize,
    /// Number of rays of all kinds.
    pub rays: u64,
    /// Milliseconds from scene to film, without building: median over the rounds.
    pub ms: f64,
    /// Their 10th and 90th percentile.
    pub spread: [f64; 2],
    /// Share of the threads' time that was spent on tracing rays, from a separate picture in which each call is timed.
    pub traversal: f64,
    /// Number of pixels that differ from the native picture's by more than 5e-4 in some channel.
    pub different: usize,
}

/// Comparison of whole pictures: native with one mode of Embree.
#[derive(Clone, Debug, Serialize)]
pub struct FrameRatio {
    /// Name of the scene.
    pub scene: String,
    /// Number of threads that rendered.
    pub threads: usize,
    /// Embree in one of its modes.
    #[serde(serialize_with = "mode_name")]
    pub against: Backend,
    /// Embree's time relative to the native path's: median of the rounds' ratios. Above 1 native is faster.
    pub ratio: f64,
    /// Its 10th and 90th percentile.
    pub spread: [f64; 2],
}

/// Measurements to make.
#[derive(Clone, Debug)]
pub struct FramePlan {
    /// Numbers of threads, measured one after the other.
    pub threads: Vec<usize>,
    /// Number of pictures by each back end, at least 1.
    pub rounds: usize,
    /// Build quality of the native hierarchy.
    pub bvh: BuildQuality,
}

impl FramePlan {
    /// Number of pictures of each scene.
    #[must_use]
    pub fn pictures(&self, embree: bool) -> u64 {
        (self.threads.len() * if embree { 3 } else { 1 } * (self.rounds.max(1) + 1)) as u64
    }
}

/// Renders every scene with every back end as often as planned, with Embree only if `machine` has it.
///
/// # Errors
/// As [`render::render`]; a limit, if Embree cannot build.
pub fn run(scenes: &[(String, Scene)], plan: &FramePlan, machine: Machine, observer: &Observer) -> Result<Frames> {
    let embree = machine.embree.is_some();
    let mut report = Frames { machine, frames: Vec::new(), ratios: Vec::new() };
    for (name, scene) in scenes {
        let accels = build(scene, plan, embree)?;
        for &threads in &plan.threads {
            measure(name, scene, &accels, threads, plan.rounds.max(1), observer, &mut report)?;
        }
    }
    Ok(report)
}

/// Accelerator whose calls are timed.
struct Timed<'a, I> {
    inner: &'a I,
    nanos: &'a AtomicU64,
}

impl<I> Timed<'_, I> {
    fn time(&self, work: impl FnOnce()) {
        let start = Instant::now();
        work();
        self.nanos.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }
}

impl<I: Intersector> Intersector for Timed<'_, I> {
    type Scratch = I::Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Self::Scratch) {
        self.time(|| self.inner.closest(rays, hits, coherence, scratch));
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Self::Scratch) {
        self.time(|| self.inner.occluded(rays, blocked, coherence, scratch));
    }

    fn build_stats(&self) -> BuildStats {
        self.inner.build_stats()
    }
}

/// Builds the accelerators of all back ends, native first. Embree's are of `MEDIUM` quality, and built if `embree` is
/// true.
fn build(scene: &Scene, plan: &FramePlan, embree: bool) -> Result<Vec<Accel>> {
    let threads = plan.threads.iter().copied().max().unwrap_or(1);
    let backends = Backend::ALL.into_iter().filter(|&backend| embree || backend == Backend::Native);
    let build = |backend| {
        let quality = if backend == Backend::Native { plan.bvh } else { BuildQuality::Default };
        Accel::build(backend, &scene.geometry, BuildOptions { quality, threads })
    };
    backends.map(build).collect()
}

/// Measures one scene with one number of threads.
fn measure(
    name: &str,
    scene: &Scene,
    accels: &[Accel],
    threads: usize,
    rounds: usize,
    observer: &Observer,
    report: &mut Frames,
) -> Result<()> {
    let options = Options { threads, ..Options::default() };
    let mut films: Vec<Film> = Vec::new();
    for accel in accels {
        let nanos = AtomicU64::new(0);
        let start = Instant::now();
        let outcome = render::render(scene, &Timed { inner: accel, nanos: &nanos }, &options, observer)?;
        let all = start.elapsed().as_secs_f64() * threads as f64;
        films.push(outcome.film);
        report.frames.push(Frame {
            scene: name.to_owned(),
            backend: accel.backend(),
            threads,
            rays: outcome.rays.total(),
            ms: 0.0,
            spread: [0.0; 2],
            traversal: nanos.into_inner() as f64 * 1e-9 / all,
            different: different(&films[0], &films[films.len() - 1]),
        });
    }
    let mut seconds = vec![Vec::with_capacity(rounds); accels.len()];
    for _ in 0..rounds {
        for (accel, seconds) in accels.iter().zip(&mut seconds) {
            let start = Instant::now();
            render::render(scene, accel, &options, observer)?;
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    let first = report.frames.len() - accels.len();
    for (frame, seconds_of) in report.frames[first..].iter_mut().zip(&seconds) {
        let figure = Percentiles::of(seconds_of.iter().map(|s| s * 1e3).collect());
        (frame.ms, frame.spread) = (figure.median, figure.spread);
        if frame.backend != Backend::Native {
            let Percentiles { median, spread } = Percentiles::of_ratio(&seconds[0], seconds_of);
            let scene = name.to_owned();
            report.ratios.push(FrameRatio { scene, threads, against: frame.backend, ratio: median, spread });
        }
    }
    Ok(())
}

/// Number of pixels that differ in some channel.
fn different(a: &Film, b: &Film) -> usize {
    let close = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= TOLERANCE);
    a.pixels.iter().zip(&b.pixels).filter(|(a, b)| !close(a, b)).count()
}

/// Returns the report as a table.
#[must_use]
pub fn table(report: &Frames) -> String {
    let head = ["scene", "threads", "back end", "ms", "10..90 %", "traversal", "native is", "10..90 %", "differ"];
    let mut rows = vec![head.map(String::from).to_vec()];
    for f in &report.frames {
        let ratio = report
            .ratios
            .iter()
            .find(|r| r.scene == f.scene && r.threads == f.threads && r.against == f.backend)
            .map_or([String::from("-"), String::from("-")], |r| {
                [format!("{:.2} x", r.ratio), format!("{:.2}..{:.2}", r.spread[0], r.spread[1])]
            });
        let [ratio, spread] = ratio;
        rows.push(vec![
            f.scene.clone(),
            f.threads.to_string(),
            f.backend.mode_name().to_owned(),
            format!("{:.1}", f.ms),
            format!("{:.1}..{:.1}", f.spread[0], f.spread[1]),
            format!("{:.0} %", f.traversal * 100.0),
            ratio,
            spread,
            f.different.to_string(),
        ]);
    }
    format!("{}\n{}", super::text::machine(&report.machine), aligned(&rows))
}
