//! The program as its user meets it: exit codes, files, what goes to which stream.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::time::Duration;

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::{contains, is_empty, starts_with};
use tempfile::TempDir;

const SCENE: &str = r#"
[camera]
eye = [0, 1, 5]
target = [0, 0.5, 0]

[render]
width = 48
height = 32
depth = 6

[environment]
type = "gradient"
nadir = [0.1, 0.1, 0.1]
horizon = [0.8, 0.8, 0.9]
zenith = [0.2, 0.4, 0.9]

[[light]]
name = "lamp"
type = "point"
position = [3, 4, 3]
intensity = [40, 40, 40]

[[material]]
name = "floor"
type = "diffuse"
color = [0.6, 0.5, 0.4]

[[material]]
name = "glass"
type = "dielectric"
ior = 1.5

[[mesh]]
name = "ground"
shape = "plane"
material = "floor"

[[mesh]]
name = "ball"
shape = "sphere"
center = [0, 1, 0]
radius = 1
material = "glass"
"#;

/// A folder of its own for a test, with `scene.toml` in it.
struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn vitrum<S: AsRef<OsStr>>(&self, args: impl IntoIterator<Item = S>) -> Command {
        let mut command = Command::cargo_bin("vitrum").unwrap();
        command.current_dir(self.folder.path()).args(args).timeout(Duration::from_secs(120));
        command
    }

    /// `vitrum` with arguments separated by blanks.
    fn run(&self, line: &str) -> assert_cmd::assert::Assert {
        self.vitrum(line.split_whitespace()).assert()
    }

    fn json(&self, line: &str) -> serde_json::Value {
        serde_json::from_slice(&self.run(line).success().get_output().stdout).unwrap()
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    fn names(&self) -> Vec<String> {
        crate::support::program::names(self.folder.path())
    }

    fn film(&self, name: &str) -> vitrum::image::Film {
        vitrum::image::read(&self.path(name), &vitrum::image::ReadOptions::default()).unwrap().film
    }
}

/// One line that starts with `error: ` and says `what`.
fn error_line(what: &str) -> impl Predicate<str> {
    starts_with("error: ").and(contains(what)).and(predicate::function(|text: &str| text.lines().count() == 1))
}

#[test]
fn a_scene_becomes_a_picture_named_after_it() {
    let place = Place::new();
    place.run("render scene.toml").code(0).stdout(is_empty()).stderr(contains("Mrays/s"));
    assert_eq!(place.names(), ["scene.png", "scene.toml"]);
    let film = place.film("scene.png");
    assert_eq!((film.width, film.height), (48, 32));
    let sky = film.at(0, 0);
    assert!(sky[2] > sky[0], "the sky is blue: {sky:?}");
}

#[test]
fn the_summary_tells_of_scene_settings_rays_and_machine() {
    let place = Place::new();
    let said = place.run("render scene.toml -o a.png --threads 2 --backend native").code(0).get_output().stderr.clone();
    let said = String::from_utf8(said).unwrap();
    for word in [
        "a.png",
        "48 x 32",
        "1 sphere",
        "1 plane",
        "1 light",
        "depth 6",
        "Fresnel exact",
        "shadows straight",
        "native",
        vitrum::simd::level::BUILT,
        "2 threads",
        "camera",
        "transmitted",
        "1 536",
        "truncated",
        "build",
    ] {
        assert!(said.contains(word), "{word} is missing in:\n{said}");
    }
}

#[test]
fn json_goes_to_standard_output_and_words_to_standard_error() {
    let place = Place::new();
    let done = place.run("render scene.toml --json --depth 3").code(0).stderr(contains("Mrays/s"));
    let summary: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    assert_eq!(summary["rays"]["camera"], 48 * 32);
    assert_eq!(summary["size"]["spheres"], 1);
    assert_eq!(summary["picture"]["depth"], 3);
    assert_eq!(summary["simd"], vitrum::simd::level::BUILT);
    let by_depth = summary["rays"]["by_depth"].as_array().unwrap();
    let total: u64 = by_depth.iter().flat_map(|row| row.as_array().unwrap()).map(|n| n.as_u64().unwrap()).sum();
    assert_eq!(summary["rays"]["total"].as_u64(), Some(total));
    assert!(summary["truncated"]["pixels"].as_u64().unwrap() > 0, "three bounces do not leave the glass ball");
}

#[test]
fn quiet_is_quiet() {
    let place = Place::new();
    place.run("render scene.toml --quiet").code(0).stdout(is_empty()).stderr(is_empty());
    place.run("compare scene.png scene.png --quiet").code(0).stdout(is_empty()).stderr(is_empty());
    place.run("render scene.toml --quiet --json").code(0).stdout(starts_with("{")).stderr(is_empty());
    place.run("render none.toml --quiet").code(3).stderr(error_line("none.toml"));
}

#[test]
fn flags_replace_what_the_scene_says() {
    let place = Place::new();
    let line = "render scene.toml -q --json --width 20 --height 10 --samples 2 --depth 1 --cutoff 0.5 \
                --fresnel schlick --shadows opaque --tile 8 --threads 1";
    let summary = place.json(line);
    let picture = &summary["picture"];
    assert_eq!((&picture["width"], &picture["height"]), (&20.into(), &10.into()));
    assert_eq!((&picture["samples"], &picture["depth"], &picture["cutoff"]), (&2.into(), &1.into(), &0.5.into()));
    assert_eq!((&picture["fresnel"], &picture["shadows"]), (&"schlick".into(), &"opaque".into()));
    assert_eq!((&summary["threads"], &summary["tile"]), (&1.into(), &8.into()));
    assert_eq!(summary["rays"]["camera"], 20 * 10 * 4);
}

#[test]
fn every_format_holds_the_same_picture() {
    let place = Place::new();
    for name in ["a.exr", "b.pfm", "c.hdr", "d.png"] {
        place.run(&format!("render scene.toml -q -o {name}")).code(0);
    }
    place.run("render scene.toml -q -o e.PNG --bits 16").code(0);
    assert_eq!(place.film("a.exr"), place.film("b.pfm"));
    place.run("compare a.exr c.hdr --tolerance 0.004").code(0);
    place.run("compare a.exr d.png --tolerance 0.005").code(0);
    place.run("compare a.exr e.PNG --tolerance 0.00002").code(0);
    place.run("compare a.exr d.png --tolerance 0.00002").code(1);
}

#[test]
fn threads_tiles_and_names_change_no_byte_of_the_file() {
    let place = Place::new();
    for format in ["png", "exr"] {
        let once = format!("once.{format}");
        place.run(&format!("render scene.toml -q -o {once} --threads 1 --tile 32 --samples 2")).code(0);
        let machines = [
            "--threads 3 --tile 8",
            "--threads 8 --tile 5",
            "--threads 2 --tile 64",
            "--threads 1 --bvh fast",
            "--threads 2 --bvh high",
        ];
        for (i, machine) in machines.iter().enumerate() {
            let again = format!("again{i}.{format}");
            place.run(&format!("render scene.toml -q -o {again} {machine} --samples 2")).code(0);
            assert!(place.bytes(&once) == place.bytes(&again), "{machine}");
        }
    }
}

#[test]
fn a_png_says_what_decided_its_pixels_and_nothing_else() {
    let place = Place::new();
    place.run("render scene.toml -q -o a.png --depth 9 --exposure -0.5 --backend native").code(0);
    let decoder = png::Decoder::new(std::io::Cursor::new(place.bytes("a.png")));
    let reader = decoder.read_info().unwrap();
    let texts = &reader.info().uncompressed_latin1_text;
    let names: Vec<_> = texts.iter().map(|t| t.keyword.strip_prefix("vitrum:").unwrap_or(&t.keyword)).collect();
    let expected = [
        "Software",
        "backend",
        "simd",
        "samples",
        "depth",
        "cutoff",
        "wavelengths",
        "fresnel",
        "refraction",
        "reflection",
        "shadows",
        "lights-from",
        "exposure",
    ];
    assert_eq!(names, expected);
    let value = |name: &str| texts.iter().find(|t| t.keyword == format!("vitrum:{name}")).unwrap().text.clone();
    assert_eq!((value("depth"), value("exposure"), value("backend")), ("9".into(), "-0.5".into(), "native".into()));
    assert!(reader.info().srgb.is_some());
}

#[test]
fn an_exr_says_what_decided_its_pixels() {
    let place = Place::new();
    place.run("render scene.toml -q -o a.exr --fresnel off").code(0);
    let meta = exr::meta::MetaData::read_from_file(place.path("a.exr"), true).unwrap();
    let others = &meta.headers[0].own_attributes.other;
    let text = |name: &str| match others.get(&exr::prelude::Text::from(name)) {
        Some(exr::prelude::AttributeValue::Text(text)) => text.to_string(),
        other => panic!("{name}: {other:?}"),
    };
    assert_eq!(text("vitrum:fresnel"), "off");
    assert_eq!(text("vitrum:simd"), vitrum::simd::level::BUILT);
}

#[test]
fn exposure_is_a_factor_of_two_to_its_power() {
    let place = Place::new();
    place.run("render scene.toml -q -o a.pfm").code(0);
    place.run("render scene.toml -q -o b.pfm --exposure -1").code(0);
    let half = place.film("a.pfm").pixels.iter().map(|p| p.map(|x| x * 0.5)).collect::<Vec<_>>();
    assert_eq!(place.film("b.pfm").pixels, half);
}

#[test]
fn both_renderers_make_the_same_picture() {
    let place = Place::new();
    place.run("render scene.toml -q -o a.exr").code(0);
    let summary = place.json("render scene.toml -q --json -o b.exr --backend reference");
    assert_eq!(summary["backend"], "reference");
    place.run("compare a.exr b.exr --tolerance 0.0005 --allow-share 0.01").code(0);
}

/// Case IO-21 of the catalogue.
#[test]
fn wrong_usage_ends_with_2_and_writes_nothing() {
    let place = Place::new();
    for flags in [
        "--width 0",
        "--width -5",
        "--width 99999999999999999999",
        "--height 1.5",
        "--samples 0",
        "--samples 1025",
        "--depth -1",
        "--depth 1000000000",
        "--cutoff nan",
        "--cutoff -0.1",
        "--cutoff 2",
        "--fresnel maybe",
        "--shadows",
        "--threads 0",
        "--threads 1000000",
        "--tile 0",
        "--bvh best",
        "--bvh fast --backend reference",
        "--bits 12",
        "--exposure inf",
        "--nonsense",
        "--quiet --quiet",
        "extra.toml",
        "-o a.exr --bits 16",
        "-o a.gif",
        "-o noextension",
    ] {
        place.run(&format!("render scene.toml {flags}")).code(2).stdout(is_empty()).stderr(starts_with("error: "));
    }
    place.run("render").code(2).stderr(starts_with("error: "));
    place.run("nonsense").code(2).stderr(starts_with("error: "));
    let long = "9".repeat(100_000);
    place.vitrum(["render", "scene.toml", "--depth", &long]).assert().code(2);
    assert_eq!(place.names(), ["scene.toml"]);
}

#[test]
fn a_wrong_scene_is_named_with_its_line() {
    let place = Place::new();
    std::fs::write(place.path("wrong.toml"), SCENE.replace("radius", "radios")).unwrap();
    let line = SCENE.lines().position(|l| l.starts_with("radius")).unwrap() + 1;
    place.run("render wrong.toml").code(2).stderr(error_line(&format!("wrong.toml:{line}")));
    std::fs::write(place.path("words.txt"), "no scene").unwrap();
    place.run("render words.txt").code(2).stderr(error_line("words.txt"));
    assert_eq!(place.names(), ["scene.toml", "words.txt", "wrong.toml"]);
}

/// Case AB-10 of the catalogue.
#[test]
fn what_was_left_out_is_told_and_under_strict_an_error() {
    let place = Place::new();
    std::fs::write(place.path("odd.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n").unwrap();
    place
        .run("render odd.obj --width 16 --height 16")
        .code(0)
        .stderr(contains("1 triangle,").and(contains("odd.obj:")));
    std::fs::remove_file(place.path("odd.png")).unwrap();
    place.run("render odd.obj --strict").code(2).stderr(error_line("odd.obj:"));
    // An open sheet of glass, seen from behind: rays leave what they never entered.
    let sheet = SCENE.replace("shape = \"sphere\"", "shape = \"disc\"\nnormal = [0, 0, -1]");
    std::fs::write(place.path("sheet.toml"), sheet).unwrap();
    place.run("render sheet.toml").code(0).stderr(contains("unmatched"));
    std::fs::remove_file(place.path("sheet.png")).unwrap();
    place.run("render sheet.toml --strict").code(2).stderr(error_line("sheet.toml:"));
    assert_eq!(place.names(), ["odd.obj", "scene.toml", "sheet.toml"]);
}

#[test]
fn what_is_not_there_or_too_large_has_its_own_exit_code() {
    let place = Place::new();
    place.run("render none.toml").code(3).stderr(error_line("none.toml"));
    place.run("compare none.png none.png").code(3).stderr(error_line("none.png"));
    place.run("render scene.toml --width 65536 --height 65536").code(4).stderr(error_line("65536"));
    if !vitrum::accel::Backend::Embree.is_compiled_in() {
        place.run("render scene.toml --backend embree").code(4).stderr(error_line("--features embree"));
    }
    assert_eq!(place.names(), ["scene.toml"]);
}

/// Case IO-16 of the catalogue.
#[test]
fn places_that_cannot_be_written_are_refused_with_3() {
    let place = Place::new();
    std::fs::create_dir(place.path("folder.png")).unwrap();
    std::fs::write(place.path("kept.png"), "kept").unwrap();
    let mut permissions = std::fs::metadata(place.path("kept.png")).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(place.path("kept.png"), permissions).unwrap();
    for name in ["missing/a.png", "folder.png", "kept.png", "..", "scene.toml/a.png"] {
        place.run(&format!("render scene.toml -o {name}")).code(3).stdout(is_empty()).stderr(error_line(name));
    }
    assert_eq!(place.bytes("kept.png"), b"kept");
    assert_eq!(place.names(), ["folder.png", "kept.png", "scene.toml"]);
}

/// Case IO-16 of the catalogue.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_and_a_device_is_written_to() {
    let place = Place::new();
    place.run("render scene.toml -q -o /dev/full").code(3).stderr(error_line("/dev/full"));
    place.run("render scene.toml -q -o /dev/null").code(0).stderr(is_empty());
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut child = process(&place, &["render", "scene.toml", "-q", "--json"]);
    assert_eq!(child.stdout(full).status().unwrap().code(), Some(3));
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    assert_eq!(process(&place, &["render", "--help"]).stdout(full).status().unwrap().code(), Some(3));
    // A summary that nobody can read is no reason to fail.
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut child = process(&place, &["render", "scene.toml"]);
    assert_eq!(child.stderr(full).status().unwrap().code(), Some(0));
}

/// Case IO-15 of the catalogue.
#[test]
fn inputs_are_never_written_over() {
    let place = Place::new();
    std::fs::copy(place.path("scene.toml"), place.path("scene.png")).unwrap();
    place.run("render scene.png -o scene.png").code(2).stderr(error_line("overwrite"));
    place.run("render scene.png").code(2).stderr(error_line("overwrite"));
    place.run("render scene.png -o ./scene.png").code(2).stderr(error_line("overwrite"));
    assert_eq!(place.bytes("scene.png"), SCENE.as_bytes());
    place.run("render scene.toml -q").code(0);
    let before = place.bytes("scene.png");
    place.run("compare scene.png scene.png --diff scene.png").code(2).stderr(error_line("overwrite"));
    assert!(place.bytes("scene.png") == before);
}

/// Case IO-17 of the catalogue.
#[test]
fn a_reader_that_leaves_early_breaks_nothing() {
    let place = Place::new();
    place.run("render scene.toml -q").code(0);
    for args in [&["render", "scene.toml", "-q", "--json"][..], &["compare", "scene.png", "scene.png"], &["--help"]] {
        let mut child = process(&place, args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{args:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{args:?}");
    }
}

#[test]
fn compare_gives_figures_and_a_verdict() {
    let place = Place::new();
    place.run("render scene.toml -q -o a.exr").code(0);
    place.run("render scene.toml -q -o b.exr --depth 2").code(0);
    place.run("render scene.toml -q -o small.exr --width 8").code(0);
    place.run("compare a.exr a.exr --tolerance 0").code(0).stdout(contains("infinite"));
    let out = place.run("compare a.exr b.exr").code(0).get_output().stdout.clone();
    let out = String::from_utf8(out).unwrap();
    for word in ["max", "mean", "RMSE", "PSNR", "SSIM", "above", "worst"] {
        assert!(out.contains(word), "{word} is missing in:\n{out}");
    }
    place.run("compare a.exr b.exr --tolerance 0.0001").code(1).stdout(contains("FAILED"));
    place.run("compare a.exr b.exr --tolerance 0.0001 --allow-share 1").code(0).stdout(contains("passed"));
    place.run("compare a.exr b.exr --allow-share 1").code(2);
    place.run("compare a.exr small.exr").code(2).stderr(error_line("48 by 32"));
    place.run("compare a.exr scene.toml").code(2).stderr(error_line("scene.toml"));
    place.run("compare a.exr b.exr --tolerance -1").code(2);
}

#[test]
fn compare_writes_figures_as_json_and_differences_as_a_picture() {
    let place = Place::new();
    place.run("render scene.toml -q -o a.pfm").code(0);
    place.run("render scene.toml -q -o b.pfm --exposure 1").code(0);
    let line = "compare a.pfm b.pfm --json --diff d.pfm --diff-scale 2";
    let result: serde_json::Value = serde_json::from_slice(&place.run(line).code(0).get_output().stdout).unwrap();
    // The second is twice the first, so the difference is the first, and the picture of it is the second.
    let (a, d) = (place.film("a.pfm"), place.film("d.pfm"));
    assert_eq!(d, place.film("b.pfm"));
    let largest = a.pixels.as_flattened().iter().fold(0.0_f32, |m, &x| m.max(x));
    assert_eq!(result["max"].as_f64(), Some(f64::from(largest)));
    assert!(result["passed"].is_null());
    let (x, y) = (result["worst"]["x"].as_u64().unwrap(), result["worst"]["y"].as_u64().unwrap());
    assert!(a.at(x as u32, y as u32).contains(&largest));
}

#[test]
fn help_and_version_are_there() {
    let place = Place::new();
    place.run("").code(2).stderr(contains("Usage: vitrum").and(contains("render")));
    place.run("--version").code(0).stdout(contains(vitrum::simd::level::BUILT));
    place.run("--help").code(0).stdout(contains("130"));
    place.run("render --help").code(0).stdout(contains("Examples:").and(contains("scenes/glass.toml")));
    place.run("compare --help").code(0).stdout(contains("Examples:"));
    for command in ["render", "bench", "parity", "verify", "price"] {
        place.run(&format!("{command} --help")).code(0).stdout(contains("--bvh <BVH>"));
    }
}

/// Case IO-18 of the catalogue.
#[cfg(unix)]
#[test]
fn names_need_not_be_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let place = Place::new();
    let odd = OsStr::from_bytes(b"odd\xff.toml");
    std::fs::copy(place.path("scene.toml"), place.folder.path().join(odd)).unwrap();
    place.vitrum([OsStr::new("render"), odd, OsStr::new("--json")]).assert().code(0).stdout(contains("odd"));
    assert!(place.folder.path().join(OsStr::from_bytes(b"odd\xff.png")).exists());
}

fn process(place: &Place, args: &[&str]) -> Process {
    let mut process = Process::new(assert_cmd::cargo::cargo_bin("vitrum"));
    process.current_dir(place.folder.path()).args(args).stdin(Stdio::null());
    process
}

/// Signals caught by a process, as the bits of `SigCgt` in /proc.
#[cfg(target_os = "linux")]
fn caught(id: u32) -> u64 {
    let status = std::fs::read_to_string(Path::new("/proc").join(id.to_string()).join("status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap_or("0");
    u64::from_str_radix(line.trim(), 16).unwrap_or(0)
}

#[cfg(target_os = "linux")]
fn interrupt_a_long_render(backend: &str, times: u32) {
    const SIGINT: u64 = 1 << 1;
    let place = Place::new();
    let line = "render scene.toml --width 6000 --height 6000 --samples 64 --backend";
    let args: Vec<&str> = line.split_whitespace().chain([backend]).collect();
    let child = process(&place, &args).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let id = child.id();
    while caught(id) & SIGINT == 0 {
        std::thread::sleep(Duration::from_millis(5));
    }
    // Into the render, which would take hours.
    std::thread::sleep(Duration::from_millis(200));
    for _ in 0..times {
        assert!(Process::new("kill").args(["-INT", &id.to_string()]).status().unwrap().success());
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "error: interrupted\n");
    assert_eq!(place.names(), ["scene.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_a_render_with_130_and_leaves_no_file() {
    interrupt_a_long_render("native", 1);
    interrupt_a_long_render("reference", 1);
}

#[cfg(target_os = "linux")]
#[test]
fn a_second_ctrl_c_ends_it_at_once() {
    interrupt_a_long_render("native", 2);
}
