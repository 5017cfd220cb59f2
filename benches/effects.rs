//! Gain of simulating only the effects of a scene. Each scene of `scenes/`, small, is rendered by its own stages
//! (`auto`) and by stages for everything (`all`), which make the same picture.
//!
//! The two take turns, with alternating order, on one thread. The figure is the ratio within a turn, auto over all,
//! below 1 where auto is faster: its median, and the interval that holds the true one with 95 % confidence. Where that
//! reaches above [`MOST`], the program says so and ends with 1.
//!
//!     cargo bench --bench effects [-- NAME...]               every scene, or those named
//!     cargo bench --bench effects -- --once auto|all NAME    one picture, for a counter of instructions

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::effects::{self, EffectPlan, Pipeline};
use vitrum::load::{self, LoadOptions};
use vitrum::measure::Figure;
use vitrum::render::{Observer, Options, Outcome, render};
use vitrum::scene::Scene;

/// Columns and rows of the pictures that are timed, one ray a pixel: at most so many, halved until one takes little time,
/// so that many turns go into the interval.
const TIMED: (u32, u32) = (160, 120);

/// Largest time of a picture, unless it is as small as [`COUNTED`].
const LITTLE: Duration = Duration::from_millis(12);

/// Columns and rows of those whose instructions are counted, and of tests.
const COUNTED: (u32, u32) = (80, 60);

/// Upper end of the interval, at most.
const MOST: f64 = 1.02;

/// Turns of a scene: at least so many, an even number of them for each that goes first.
const TURNS: usize = 12;

/// And so many more as fit into this time.
const TIME: Duration = Duration::from_secs(3);

/// A scene and the hierarchy over it.
struct Subject {
    name: String,
    scene: Scene,
    accel: Accel,
}

impl Subject {
    fn load(file: &Path, (width, height): (u32, u32)) -> Self {
        let mut scene = load::scene(file, &LoadOptions::default()).expect("the scene loads").scene;
        (scene.settings.width, scene.settings.height, scene.settings.samples) = (width, height, 1);
        let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default()).expect("there is memory");
        Self { name: name_of(file), scene, accel }
    }

    /// With a picture that takes little time.
    fn timed(file: &Path) -> Self {
        let mut subject = Self::load(file, TIMED);
        loop {
            let start = Instant::now();
            counted_picture(&subject, Pipeline::All);
            let settings = &mut subject.scene.settings;
            if start.elapsed() <= LITTLE || settings.width <= COUNTED.0 {
                return subject;
            }
            (settings.width, settings.height) = (settings.width / 2, settings.height / 2);
        }
    }
}

/// The one place that renders, under a name that a counter of instructions can be told.
#[inline(never)]
fn counted_picture(subject: &Subject, pipeline: Pipeline) -> Outcome {
    let effects = effects::Options { pipeline, ..effects::Options::default() };
    let options = Options { threads: 1, effects, ..Options::default() };
    render(&subject.scene, &subject.accel, &options, &Observer::default()).expect("the scene renders")
}

fn name_of(file: &Path) -> String {
    file.file_stem().expect("a name").to_string_lossy().into_owned()
}

fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let list = |folder: &Path| -> Vec<PathBuf> {
        let files = std::fs::read_dir(folder).expect("the folder is there").map(|f| f.expect("readable").path());
        let mut files: Vec<_> = files.filter(|f| f.extension().is_some_and(|e| e == "toml")).collect();
        files.sort();
        files
    };
    [list(&folder), list(&folder.join("hard"))].concat()
}

fn check(subject: &Subject) {
    let [auto, all] = [Pipeline::Auto, Pipeline::All].map(|pipeline| counted_picture(subject, pipeline));
    assert!(auto.film == all.film && auto.truncated == all.truncated, "{}: two pictures", subject.name);
    assert_eq!(auto.rays, all.rays, "{}", subject.name);
}

/// Times both by turns, and says whether the interval stays below [`MOST`].
fn compare(subject: &Subject) -> bool {
    check(subject);
    let seconds = |pipeline| {
        let start = Instant::now();
        std::hint::black_box(counted_picture(subject, pipeline));
        start.elapsed().as_secs_f64()
    };
    let (mut ratios, mut times) = (Vec::new(), [Vec::new(), Vec::new()]);
    let begin = Instant::now();
    while ratios.len() < TURNS || begin.elapsed() < TIME {
        let (auto, all) = if ratios.len() % 2 == 0 {
            let auto = seconds(Pipeline::Auto);
            (auto, seconds(Pipeline::All))
        } else {
            let all = seconds(Pipeline::All);
            (seconds(Pipeline::Auto), all)
        };
        ratios.push(auto / all);
        times[0].push(auto);
        times[1].push(all);
    }
    let [auto, all] = times.map(|t| 1e3 * Figure::of(&t).median);
    let Figure { median, interval: [low, high], runs, .. } = Figure::of(&ratios);
    let on = EffectPlan::resolve(&subject.scene, &effects::Options::default()).on().iter().count();
    let kept = high <= MOST;
    let mark = if kept { "" } else { "  ABOVE 1.02" };
    println!(
        "{:<12} {on:>2}  {auto:>8.2} {all:>8.2}  {median:.3} ({low:.3} to {high:.3})  {runs:>3}{mark}",
        subject.name
    );
    kept
}

fn main() {
    // Cargo adds --bench.
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let files = scene_files();
    let named = |name: &String| files.iter().find(|f| name_of(f) == *name).unwrap_or_else(|| panic!("no scene {name}"));
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--once", pipeline, _] => {
            let pipeline = match pipeline {
                "auto" => Pipeline::Auto,
                "all" => Pipeline::All,
                _ => panic!("{pipeline} is neither auto nor all"),
            };
            let outcome = counted_picture(&Subject::load(named(&args[2]), COUNTED), pipeline);
            println!("{}", outcome.rays.total());
        }
        ["--test"] => files.iter().for_each(|file| check(&Subject::load(file, COUNTED))),
        _ => {
            let chosen: Vec<&PathBuf> =
                if args.is_empty() { files.iter().collect() } else { args.iter().map(named).collect() };
            println!("scene        on   auto ms   all ms  auto / all (95 %)     turns");
            // Not `all`, which would stop at the first.
            let above = chosen.iter().filter(|file| !compare(&Subject::timed(file))).count();
            if above > 0 {
                std::process::exit(1);
            }
        }
    }
}
