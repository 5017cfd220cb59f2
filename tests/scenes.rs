//! The scenes of the project are what they say: they load without a warning, render without a number gone wrong, and
//! the sizes of the sweep are those of their names.

use crate::support;

use std::fs;
use std::path::{Path, PathBuf};

use support::backends;
use vitrum::accel::{Backend, Intersector as _};
use vitrum::load;
use vitrum::render::{Observer, Options, render};
use vitrum::scene::{Medium, Scene};

fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<_> =
        fs::read_dir(folder).expect("the folder is there").map(|f| f.expect("readable").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml"));
    files.sort();
    assert!(files.len() >= 12, "{files:?}");
    files
}

fn load_scene(file: &Path) -> Scene {
    let loaded = load::scene(file, &load::LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.report.warnings.is_empty(), "{}: {:?}", file.display(), loaded.report.warnings);
    assert!(loaded.report.dropped.is_empty(), "{}: {:?}", file.display(), loaded.report.dropped);
    loaded.scene
}

#[test]
fn every_scene_opens_with_a_comment_that_says_what_it_shows() {
    for file in scene_files() {
        let text = fs::read_to_string(&file).expect("readable");
        let comment: usize = text.lines().take_while(|l| l.starts_with('#')).map(str::len).sum();
        assert!(comment > 60, "{}", file.display());
    }
}

#[test]
fn every_scene_renders_to_sound_radiance() {
    for file in scene_files() {
        let mut scene = load_scene(&file);
        let settings = &mut scene.settings;
        (settings.width, settings.height, settings.samples) = (settings.width / 20, settings.height / 20, 1);
        let accel = backends::native(&scene.geometry);
        assert_eq!(accel.build_stats().dropped, 0, "{}", file.display());
        let outcome = render(&scene, &accel, &Options::default(), &Observer::default()).expect("renders");
        assert_eq!((outcome.non_finite, outcome.clamped), (0, 0), "{}", file.display());
        let pixels = &outcome.film.pixels;
        // Colours of the spectrum lie outside what red, green and blue can mix.
        let least = if scene.media.iter().any(Medium::disperses) { -1.5 } else { 0.0 };
        assert!(pixels.iter().flatten().all(|&v| v >= least), "{}", file.display());
        let mean = pixels.iter().flatten().sum::<f32>() / (3 * pixels.len()) as f32;
        assert!((0.1..0.7).contains(&mean), "{}: mean radiance {mean}", file.display());
        let bright = pixels.iter().filter(|p| p.iter().any(|&v| v > 1.0)).count();
        assert!(
            bright * 50 < pixels.len(),
            "{}: {bright} of {} pixels are too bright to show",
            file.display(),
            pixels.len()
        );
    }
}

#[test]
fn the_sweep_has_the_sizes_of_its_names() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for (name, triangles) in [("sweep-1k", 1e3), ("sweep-10k", 1e4), ("sweep-100k", 1e5), ("sweep-1m", 1e6)] {
        let scene = load_scene(&folder.join(name).with_extension("toml"));
        let stats = backends::native(&scene.geometry).build_stats();
        assert!((stats.triangles as f64 / triangles - 1.0).abs() < 0.03, "{name}: {}", stats.triangles);
    }
}

/// Shading is shared, so a pixel that differs must be undecidable in `f32`. Its `f64` value must change when the camera
/// ray moves by a few roundings per level of the path.
#[test]
fn both_back_ends_make_the_same_picture_of_every_scene() {
    use vitrum::optics::FresnelModel;
    use vitrum::render::reference::Prepared;

    const TOLERANCE: f32 = 5e-4;
    for file in scene_files() {
        let mut scene = load_scene(&file);
        let settings = &mut scene.settings;
        (settings.width, settings.height, settings.samples) = (settings.width / 8, settings.height / 8, 1);
        let Some(embree) = backends::embree(Backend::Embree, &scene.geometry) else { return };
        let native = backends::native(&scene.geometry);
        let (options, observer) = (Options::default(), Observer::default());
        let ours = render(&scene, &native, &options, &observer).expect("renders").film;
        let theirs = render(&scene, &embree, &options, &observer).expect("renders").film;
        let prepared = Prepared::new(&scene, FresnelModel::Exact);
        let roundings = 8.0 * f64::from(scene.settings.max_depth + 1);
        let (mut apart, mut unexplained) = (0, Vec::new());
        for y in 0..ours.height {
            for x in 0..ours.width {
                let differ = ours.at(x, y).iter().zip(theirs.at(x, y)).any(|(a, b)| (a - b).abs() > TOLERANCE);
                apart += usize::from(differ);
                let (fx, fy) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                if differ && prepared.ulps_until_moved(fx, fy, f64::from(TOLERANCE), roundings).is_none() {
                    unexplained.push((x, y, ours.at(x, y), theirs.at(x, y)));
                }
            }
        }
        let name = file.display();
        eprintln!("{name}: {apart} of {} pixels apart, {} unexplained", ours.pixels.len(), unexplained.len());
        assert!(apart * 100 <= ours.pixels.len(), "{name}: {apart} pixels apart");
        assert!(unexplained.is_empty(), "{name}: {unexplained:?}");
    }
}
