//! `vitrum bench` and `vitrum doctor`: the shape of what they say.

use std::path::Path;

use assert_cmd::Command;
use predicates::str::contains;
use serde_json::Value;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/house.obj");
const KINDS: [&str; 6] = ["primary", "shadow", "mirror", "refracted", "diffuse", "diffuse-any"];

fn vitrum() -> Command {
    Command::cargo_bin("vitrum").unwrap()
}

/// `vitrum bench` on a small model, over in a moment.
fn bench() -> Command {
    let mut command = vitrum();
    command.args(["bench", MODEL, "--size", "64", "--one-in", "1", "--rounds", "3", "--builds", "1"]);
    command
}

fn json(command: &mut Command) -> Value {
    let output = command.arg("--json").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().unwrap()
}

/// Returns true if the program reports that Embree takes part.
fn has_embree() -> bool {
    !json(vitrum().arg("doctor"))["embree"].is_null()
}

#[test]
fn the_figures_have_the_agreed_shape() {
    let report = json(bench().args(["--threads", "2"]));
    assert_eq!(keys(&report), ["builds", "machine", "ratios", "rows"]);
    let of_a_row = ["backend", "mesh", "mode", "mrays_per_s", "rays", "spread", "threads", "triangles"];
    for row in list(&report, "rows") {
        assert_eq!(keys(row), of_a_row);
        let (low, median, high) = (&row["spread"][0], &row["mrays_per_s"], &row["spread"][1]);
        let [low, median, high] = [low, median, high].map(|x| x.as_f64().unwrap());
        assert!(0.0 < low && low <= median && median <= high && high < 1e5);
        assert_eq!((row["mesh"].as_str(), row["threads"].as_u64()), (Some("house"), Some(2)));
        assert!(row["triangles"].as_u64().unwrap() > 5);
    }
    for build in list(&report, "builds") {
        assert_eq!(keys(build), ["backend", "bytes_per_triangle", "mesh", "ms", "quality", "threads"]);
        assert!(build["ms"].as_f64().unwrap() > 0.0 && build["bytes_per_triangle"].as_f64().unwrap() > 16.0);
    }
    for kind in KINDS {
        let rows: Vec<_> = list(&report, "rows").iter().filter(|r| r["rays"] == kind).collect();
        let modes = |backend: &str| rows.iter().filter(|r| r["backend"] == backend).count();
        assert_eq!(modes("native"), 4, "{kind}");
        let (others, ratios) = if has_embree() { (6, 2) } else { (0, 0) };
        assert_eq!((modes("embree-robust"), modes("embree-fast")), (others, others), "{kind}");
        let of_kind = list(&report, "ratios").iter().filter(|r| r["rays"] == kind);
        assert_eq!(of_kind.count(), ratios);
    }
    for ratio in list(&report, "ratios") {
        assert_eq!(keys(ratio), ["against", "embree_mode", "mesh", "ratio", "rays", "spread", "threads"]);
        let names = [&ratio["rays"], &ratio["against"], &ratio["embree_mode"]].map(|v| v.as_str().unwrap());
        // The mode named is the one with the highest figure.
        let rows = list(&report, "rows").iter().filter(|r| r["rays"] == names[0] && r["backend"] == names[1]);
        let figure = |row: &&Value| row["mrays_per_s"].as_f64().unwrap();
        let best = rows.max_by(|a, b| figure(a).total_cmp(&figure(b))).unwrap();
        assert_eq!(best["mode"], names[2]);
    }
}

#[test]
fn one_thread_and_all_of_them_are_timed_unless_told_otherwise() {
    let report = json(bench().args(["--rays", "primary,diffuse-any"]));
    let all = std::thread::available_parallelism().unwrap().get() as u64;
    for row in list(&report, "rows") {
        assert!([1, all].contains(&row["threads"].as_u64().unwrap()));
        assert!(["primary", "diffuse-any"].contains(&row["rays"].as_str().unwrap()));
    }
    assert_eq!(list(&report, "builds").iter().filter(|b| b["backend"] == "native").count() as u64, all.min(2));
}

#[test]
fn the_table_fits_a_terminal_and_says_loudly_where_embree_is_left_out() {
    let output = bench().args(["--threads", "1"]).output().unwrap();
    assert!(output.status.success());
    let (table, log) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(table.lines().skip(1).all(|line| line.chars().count() <= 100), "{table}");
    for kind in KINDS {
        assert!(table.contains(kind), "{table}");
    }
    assert_eq!(table.contains("native / best"), has_embree());
    assert_eq!(log.contains("EMBREE IS LEFT OUT"), !has_embree());
    assert_eq!(table.contains("WITHOUT EMBREE"), !has_embree());
}

#[test]
fn the_page_needs_nothing_but_itself() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    bench().args(["--threads", "1", "--rays", "primary", "--quiet", "--html"]).arg(&page).assert().success().stdout("");
    let text = std::fs::read_to_string(page).unwrap();
    assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>\n"));
    assert!(text.contains("<svg") && text.contains("house") && text.contains("primary"));
    for foreign in ["http", "src=", "href=", "@import", "url(", "<script", "<link"] {
        assert!(!text.contains(foreign), "{foreign}");
    }
}

#[test]
fn a_scene_with_spheres_and_planes_is_timed_without_its_planes() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/glass.toml");
    let mut command = vitrum();
    command.arg("bench").arg(scene).args(["--size", "64", "--rounds", "1", "--builds", "1", "--threads", "1"]);
    let report = json(&mut command);
    assert_eq!(report["rows"][0]["mesh"], "glass");
}

/// A small picture of a glass ring.
fn small_scene(folder: &Path) -> std::path::PathBuf {
    let ring = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/sweep-1k.toml");
    let text = std::fs::read_to_string(ring).unwrap();
    let small = text.replace("width = 640", "width = 48").replace("height = 480", "height = 36");
    assert_ne!(small, text);
    let file = folder.join("ring.toml");
    std::fs::write(&file, small).unwrap();
    file
}

#[test]
fn whole_pictures_take_turns_and_hardly_differ() {
    let folder = tempfile::tempdir().unwrap();
    let scene = small_scene(folder.path());
    let frames = |more: &[&str]| {
        let mut command = vitrum();
        command.args(["bench", "--frames", "--threads", "1", "--rounds", "2"]).arg(&scene).args(more);
        json(&mut command)
    };
    let report = frames(&[]);
    assert_eq!(keys(&report), ["frames", "machine", "ratios"]);
    let back_ends = if has_embree() { 3 } else { 1 };
    assert_eq!((list(&report, "frames").len(), list(&report, "ratios").len()), (back_ends, back_ends - 1));
    for frame in list(&report, "frames") {
        assert_eq!(frame["scene"], "ring");
        assert!(frame["rays"].as_u64().unwrap() > 48 * 36 && frame["ms"].as_f64().unwrap() > 0.0);
        let traversal = frame["traversal"].as_f64().unwrap();
        assert!(0.0 < traversal && traversal < 1.0, "{traversal}");
        assert!(frame["different"].as_u64().unwrap() < 10);
    }
    // Neither what is hit nor, then, how many rays follow depends on how the hierarchy was built.
    let rays = |report: &Value| report["frames"][0]["rays"].as_u64().unwrap();
    for quality in ["fast", "high"] {
        assert_eq!(rays(&frames(&["--bvh", quality])), rays(&report));
    }
}

#[test]
fn a_sweep_is_one_landscape_in_several_sizes_and_can_be_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("sweep.svg");
    let mut command = vitrum();
    command.args(["bench", "--sweep=200,2000", "--threads", "1", "--rounds", "1", "--builds", "1", "--size", "64"]);
    let report = json(command.arg("--plot").arg(&plot));
    let sizes: Vec<_> = list(&report, "rows").iter().map(|r| r["triangles"].as_u64().unwrap()).collect();
    assert!(sizes.iter().all(|n| [200, 2048].contains(n)), "{sizes:?}");
    assert!(list(&report, "rows").iter().all(|r| r["rays"] == "primary" || r["rays"] == "diffuse"));
    let text = std::fs::read_to_string(plot).unwrap();
    assert!(text.starts_with("<svg") && text.contains("diffuse, native") && text.contains("n log n"));
    assert!(!text.contains("NaN") && !text.contains("inf"));
}

#[test]
fn wrong_wishes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str], words: &str| {
        vitrum().arg("bench").args(arguments).assert().code(2).stderr(contains(words));
    };
    refused(&[], "SCENE|MESH");
    refused(&[MODEL, "--size", "100"], "not a multiple of 8");
    refused(&[MODEL, "--rays", "tertiary"], "diffuse-any");
    refused(&[MODEL, "--rounds", "0"], "--rounds");
    refused(&[MODEL, "--bvh", "perfect"], "high");
    refused(&[MODEL, "--sweep"], "cannot be used with");
    refused(&[MODEL, "--plot", "sweep.svg"], "--sweep");
    refused(&[MODEL, "--frames", "--rays", "primary"], "cannot be used with");
    let plane = folder.path().join("plane.toml");
    std::fs::write(
        &plane,
        "[[material]]\nname = \"a\"\ntype = \"diffuse\"\ncolor = [1, 1, 1]\n\n\
         [[mesh]]\nname = \"b\"\nshape = \"plane\"\nmaterial = \"a\"\n",
    )
    .unwrap();
    refused(&[plane.to_str().unwrap()], "nothing that a hierarchy holds");
    vitrum().args(["bench", MODEL, "--html", "no-such-folder/page.html"]).assert().code(3);
}

#[test]
fn the_doctor_knows_machine_and_build() {
    let findings = json(vitrum().arg("doctor"));
    assert_eq!(
        keys(&findings),
        ["backends", "choice", "cpu", "default_backend", "embree", "missing", "processors", "simd", "vitrum"],
        "one name for each finding"
    );
    // The feature decides the default, and native is named as the one that takes less time.
    assert_eq!(findings["default_backend"], vitrum::accel::Backend::DEFAULT.name());
    let choice = findings["choice"].as_str().unwrap();
    assert!(choice.contains("native takes less CPU time") && choice.contains("1.1 to 1.9 times"), "{choice}");
    assert!(!findings["cpu"].as_str().unwrap().is_empty() && findings["processors"].as_u64().unwrap() >= 1);
    assert_eq!(keys(&findings["simd"]), ["available", "built", "lacking", "saves_ymm", "saves_zmm"]);
    // It runs here, so it lacks nothing.
    assert_eq!(findings["simd"]["lacking"].as_array().unwrap().len(), 0);
    assert_eq!(findings["simd"]["built"], vitrum::simd::level::BUILT);
    let embree = &findings["embree"];
    if embree.is_null() {
        assert!(findings["missing"].to_string().contains("Embree: "));
    } else {
        assert_eq!(keys(embree), ["file", "found_by", "isa", "tasking", "version"]);
        assert!(embree["version"].as_str().unwrap().starts_with("4."));
    }
    let lines =
        vitrum().arg("doctor").assert().success().stdout(contains("simd available")).get_output().stdout.clone();
    let lines = String::from_utf8(lines).unwrap();
    assert!(lines.contains(findings["cpu"].as_str().unwrap()) && lines.contains(choice));
}

#[test]
fn the_doctor_names_a_folder_without_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let findings = json(vitrum().arg("doctor").env("EMBREE_DIR", folder.path()));
    assert!(findings["embree"].is_null() && !findings["backends"].to_string().contains("embree"));
    assert!(findings["missing"].to_string().contains("Embree: "));
}
