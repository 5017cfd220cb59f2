//! `vitrum render --max-error` keeps its word: other pixels than it looked at, judged apart from it.
//!
//! A plain run looks at two small scenes. `VITRUM_BUDGETS=1 cargo test --test command budgets:: -- --nocapture` looks at 2,000
//! pixels of each of ten scenes.

use crate::support;

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use glam::DVec3;
use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use serde_json::Value;
use support::Rng;
use vitrum::load;
use vitrum::optics::FresnelModel;
use vitrum::render::FilmRay;
use vitrum::render::reference::Prepared;
use vitrum::scene::{Medium, Scene};

/// A matt still life under a lamp of some size, small and quickly rendered.
const SOFT: &str = r#"
[camera]
eye = [0.4, 2.2, 4]
target = [0, 0.4, 0]
[render]
width = 48
height = 36
samples = 2
depth = 4
light_samples = 16
[environment]
type = "constant"
color = [0.2, 0.2, 0.25]
ambient = 0.1
[[light]]
name = "panel"
type = "rectangle"
position = [-1.5, 3, 0]
edges = [[1, 0.3, 0], [0, 0, 1]]
target = [0, 0, 0]
intensity = 25
[[material]]
name = "matt"
type = "diffuse"
color = 0.7
ambient = 0.7
[[material]]
name = "steel"
type = "conductor"
metal = "chromium"
[[mesh]]
name = "floor"
shape = "plane"
material = "matt"
[[mesh]]
name = "post"
shape = "box"
size = [0.1, 1.2, 0.1]
center = [-0.5, 0.6, 0]
material = "matt"
[[mesh]]
name = "ball"
shape = "sphere"
radius = 0.4
center = [0.5, 0.4, 0.2]
material = "steel"
"#;

fn bundled(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"))
}

/// A picture made under a bound, and what the program said of it.
struct Made {
    size: [usize; 2],
    pixels: Vec<[f32; 3]>,
    budget: Value,
    log: String,
}

fn made(scene: &Path, bound: f64, more: &[&str]) -> Made {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("a.pfm");
    let mut command = Command::cargo_bin("vitrum").unwrap();
    command.arg("render").arg(scene).arg("-o").arg(&picture).args(["--json", "--max-error", &bound.to_string()]);
    let output = command.args(more).output().unwrap();
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {log}"));
    let kept = summary["budget"]["kept"].as_bool().unwrap();
    assert_eq!(output.status.code(), Some(i32::from(!kept)), "{log}");
    let (size, pixels) = pfm(&std::fs::read(&picture).unwrap());
    Made { size, pixels, budget: summary["budget"].clone(), log }
}

/// Rows of a PFM come from below.
fn pfm(bytes: &[u8]) -> ([usize; 2], Vec<[f32; 3]>) {
    let mut lines = bytes.splitn(4, |&b| b == b'\n');
    assert_eq!(lines.next().unwrap(), b"PF");
    let size = String::from_utf8(lines.next().unwrap().to_vec()).unwrap();
    let size: Vec<usize> = size.split(' ').map(|n| n.parse().unwrap()).collect();
    assert!(lines.next().unwrap().starts_with(b"-1"), "little-endian");
    let channel = |c: &[u8]| f32::from_le_bytes(c.try_into().unwrap());
    let pixel = |p: &[u8]| [channel(&p[..4]), channel(&p[4..8]), channel(&p[8..])];
    let rows: Vec<Vec<[f32; 3]>> =
        lines.next().unwrap().chunks(12 * size[0]).map(|row| row.chunks(12).map(pixel).collect()).collect();
    ([size[0], size[1]], rows.into_iter().rev().flatten().collect())
}

/// The best that the scene supports: `f64`, polarised where nothing disperses, deep.
struct Judge<'a> {
    prepared: Prepared<'a>,
    samples: u32,
    eye: f64,
}

impl<'a> Judge<'a> {
    fn scene(file: &Path, [width, height]: [usize; 2], samples: u32) -> Scene {
        let mut scene = load::scene(file, &load::LoadOptions::default()).unwrap().scene;
        let settings = &mut scene.settings;
        (settings.width, settings.height, settings.samples) = (width as u32, height as u32, samples);
        settings.max_depth = settings.max_depth.max(64);
        settings.cutoff = settings.cutoff.min(1.0 / 65536.0);
        scene
    }

    fn new(scene: &'a Scene) -> Self {
        let disperses = scene.media.iter().any(Medium::disperses);
        let fresnel = if disperses { FresnelModel::Exact } else { FresnelModel::Polarised };
        let eye = f64::from(scene.camera.eye.abs().max_element());
        Self { prepared: Prepared::new(scene, fresnel), samples: scene.settings.samples, eye }
    }

    /// The pixel with all its rays moved: origins, directions, directions of shadow rays. And its most levels.
    fn pixel(&self, [x, y]: [u32; 2], moved: [DVec3; 3]) -> (DVec3, usize) {
        let n = self.samples;
        let within = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let (mut sum, mut levels) = (DVec3::ZERO, 1);
        for sample in 0..n * n {
            let film = FilmRay { pixel: [x, y], sample };
            let (dx, dy) = (within(sample % n), within(sample / n));
            let (origin, dir) = self.prepared.camera_ray(f64::from(x) + dx, f64::from(y) + dy);
            let dir = (dir + moved[1]).normalize();
            let tally = self.prepared.trace_turned(film, origin + moved[0], dir, moved[2]);
            sum += tally.radiance;
            levels = levels.max(tally.rays.by_depth.len());
        }
        (sum / f64::from(n * n), levels)
    }

    /// Returns true if a pixel is off by more than `bound` and well-conditioned. Well-conditioned means that its right
    /// value changes by at most `bound` when its rays move at random by up to 8 ulps of `f32` per level of its paths.
    fn violates(&self, made: &Made, at: [u32; 2], bound: f64, rng: &mut Rng) -> bool {
        let (here, levels) = self.pixel(at, [DVec3::ZERO; 3]);
        let shown = made.pixels[at[1] as usize * made.size[0] + at[0] as usize];
        let off = DVec3::from(shown.map(f64::from)) - here;
        if off.abs().max_element() <= bound {
            return false;
        }
        let mut step = |most: f64| DVec3::from([0; 3].map(|_| f64::from(rng.unit()) * 2.0 - 1.0)) * most;
        let most = 8.0 * levels as f64 * f64::from(f32::EPSILON);
        !(0..192).any(|k| {
            let most = most * [0.05, 0.2, 1.0][k % 3];
            let (there, _) = self.pixel(at, [step(most * self.eye), step(most), step(most)]);
            (there - here).abs().max_element() > bound
        })
    }
}

/// Holds a picture against the reference at pixels of the test's own. A picture that is said to be kept violates the
/// bound nowhere; one that is condemned does where the program says so.
fn word_is_kept(name: &str, file: &Path, bound: f64, asked: usize, more: &[&str], samples: u32) -> bool {
    let made = made(file, bound, more);
    let scene = Judge::scene(file, made.size, samples);
    let judge = Judge::new(&scene);
    let check = &made.budget["steps"].as_array().unwrap().last().unwrap()["check"];
    let mut rng = Rng::new(made.pixels.len() as u64);
    let any = |rng: &mut Rng| [rng.below(made.size[0]) as u32, rng.below(made.size[1]) as u32];
    let violations: Vec<[u32; 2]> = (0..asked)
        .map(|_| any(&mut rng))
        .collect::<Vec<_>>()
        .into_iter()
        .filter(|&at| judge.violates(&made, at, bound, &mut rng))
        .collect();
    let wrong = check["wrong"].as_array().unwrap();
    let condemned = wrong.iter().filter(|p| {
        let at = [&p["x"], &p["y"]].map(|v| v.as_u64().unwrap() as u32);
        !judge.violates(&made, at, bound, &mut rng)
    });
    let condemned = condemned.count();
    println!(
        "{name}: {}, {} wrong and {} ill-conditioned of {}, {} undecided; {} of {asked} others violate {bound:.1e}: {:?}",
        made.budget["options"],
        wrong.len(),
        check["ill"].as_array().unwrap().len(),
        check["asked"],
        check["undecided"],
        violations.len(),
        &violations[..violations.len().min(8)],
    );
    let kept = made.budget["kept"] == true;
    let sound = (!kept || violations.is_empty()) && (wrong.is_empty() || condemned < wrong.len());
    if !sound {
        println!("{name}: kept: {kept}, {condemned} of {} condemned without cause\n{}", wrong.len(), made.log);
    }
    sound
}

#[test]
fn pixels_that_were_not_looked_at_keep_the_bound_too() {
    let folder = tempfile::tempdir().unwrap();
    let soft = folder.path().join("soft.toml");
    std::fs::write(&soft, SOFT).unwrap();
    assert!(word_is_kept("soft", &soft, 1.0 / 512.0, 200, &[], 2));
    let more = ["--width", "48", "--height", "32", "--samples", "1"];
    assert!(word_is_kept("box", &bundled("box"), 1.0 / 64.0, 200, &more, 1));
}

#[test]
fn two_thousand_pixels_of_ten_scenes_keep_the_bound_too() {
    if std::env::var_os("VITRUM_BUDGETS").is_none() {
        return;
    }
    let mut unsound = Vec::new();
    for name in ["absorption", "box", "glass", "goblet", "hall", "illum", "pool", "prism", "soft", "spectrum"] {
        let more = ["--width", "240", "--height", "160", "--samples", "1"];
        if !word_is_kept(name, &bundled(name), 1.0 / 512.0, 2000, &more, 1) {
            unsound.push(name);
        }
    }
    assert!(unsound.is_empty(), "{unsound:?}");
}

/// The light samples of a pixel are its own in the check as in the picture: a picture in `f64` is right against `f64`.
#[test]
fn a_picture_under_a_lamp_with_an_extent_is_kept_and_its_reference_named() {
    let folder = tempfile::tempdir().unwrap();
    let soft = folder.path().join("soft.toml");
    std::fs::write(&soft, SOFT).unwrap();
    let made = made(&soft, 1.0 / 512.0, &[]);
    assert_eq!(made.budget["kept"], true, "{}", made.log);
    assert!(made.log.contains("pixels against f64, polarised, depth 64, cut-off 1/65536"), "{}", made.log);
    assert_eq!(made.budget["steps"].as_array().unwrap().len(), 1, "the first choice holds: {}", made.log);
}

/// Seven panes of index 1.5 before a wall of radiance 1 let 0.96 / (1 + 13 * 0.04) through. The reference's own cut-off takes
/// some of it, which wider limits tell.
#[test]
fn a_bound_on_panes_in_a_row_is_shown_to_be_kept() {
    let mut text = String::from(
        "[camera]\neye = [0.3, 0.2, 50]\ntarget = [0.3, 0.2, 0]\nprojection = \"orthographic\"\nheight = 1\n\
         [render]\nwidth = 2\nheight = 2\n[environment]\ntype = \"constant\"\ncolor = 0\n\
         [[material]]\nname = \"glass\"\ntype = \"dielectric\"\nior = 1.5\n\
         [[material]]\nname = \"wall\"\ntype = \"emissive\"\nemission = 1\n\
         [[mesh]]\nshape = \"plane\"\npoint = [0, 0, -40]\nnormal = [0, 0, 1]\nmaterial = \"wall\"\n",
    );
    for z in 0..7 {
        text +=
            &format!("[[mesh]]\nshape = \"box\"\nsize = [20, 20, 0.5]\ncenter = [0, 0, -{z}]\nmaterial = \"glass\"\n");
    }
    let folder = tempfile::tempdir().unwrap();
    let panes = folder.path().join("panes.toml");
    std::fs::write(&panes, text).unwrap();
    let made = made(&panes, 1.0 / 100.0, &[]);
    let check = &made.budget["steps"].as_array().unwrap().last().unwrap()["check"];
    assert_eq!((&made.budget["kept"], &check["undecided"]), (&true.into(), &0.into()), "{}", made.log);
    let seen = f64::from(made.pixels[0][0]);
    assert!((seen - 0.96 / 1.52).abs() < 1.0 / 100.0, "{seen}: {}", made.log);
}

#[test]
fn a_bound_below_the_rounding_of_the_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let soft = folder.path().join("soft.toml");
    std::fs::write(&soft, SOFT).unwrap();
    for bound in ["1e-30", "1e-9"] {
        let mut command = Command::cargo_bin("vitrum").unwrap();
        command.arg("render").arg(&soft).arg("-o").arg(folder.path().join("a.png")).args(["--max-error", bound]);
        command
            .assert()
            .code(2)
            .stderr(contains(format!("--max-error {bound}")).and(contains("take a bound of at least")));
    }
    assert!(!folder.path().join("a.png").exists());
}
