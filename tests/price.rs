//! `vitrum price`: what it leaves in its folder, that it goes on from there, and its page in a real browser.

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use predicates::str::contains;
use serde_json::Value;

/// A ball of glass over a checkered floor, and what may go wrong in a name.
const SCENE: &str = r#"
[camera]
eye = [0, 1.5, 4]
target = [0, 0.7, 0]
[render]
width = 64
height = 48
depth = 8
[environment]
type = "constant"
color = [0.6, 0.7, 0.8]
[[light]]
name = "lamp"
type = "point"
position = [2, 5, 3]
intensity = [60, 60, 60]
[[material]]
name = "floor"
type = "diffuse"
checker = { even = [0.8, 0.8, 0.8], odd = [0.2, 0.2, 0.2], size = 0.5, offset = [0, -0.25, 0] }
[[material]]
name = "glass"
type = "dielectric"
ior = 1.5
[[mesh]]
name = "floor"
shape = "plane"
material = "floor"
[[mesh]]
name = "ball"
shape = "sphere"
radius = 0.8
center = [0, 0.85, 0]
material = "glass"
"#;

struct Study {
    folder: tempfile::TempDir,
}

impl Study {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a <b> & \"c\".toml"), SCENE).unwrap();
        Self { folder }
    }

    fn scene(&self) -> PathBuf {
        self.folder.path().join("a <b> & \"c\".toml")
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn command(&self, more: &[&str]) -> Command {
        let mut command = Command::cargo_bin("vitrum").unwrap();
        command.arg("price").arg(self.scene()).arg("-o").arg(self.out());
        command.args(["--size", "32x24", "--runs", "3", "--limit", "60s", "--backend", "native", "--threads", "1"]);
        command.args(more);
        command
    }

    fn run(&self, more: &[&str]) -> Output {
        let output = self.command(more).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output
    }

    fn report(&self) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.out().join("report.json")).unwrap()).unwrap()
    }

    fn journal(&self) -> String {
        std::fs::read_to_string(self.out().join("study/journal.jsonl")).unwrap()
    }
}

fn names(report: &Value) -> Vec<&str> {
    report["rows"].as_array().unwrap().iter().map(|r| r["name"].as_str().unwrap()).collect()
}

#[test]
fn a_study_leaves_a_table_a_page_and_figures_and_goes_on_where_it_ended() {
    let study = Study::new();
    let output = study.run(&["--axes", "fresnel", "--single"]);
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    for words in ["default", "fresnel off", "fresnel schlick", "RMSE", "times the default's time"] {
        assert!(table.contains(words), "{words} in\n{table}");
    }
    let report = study.report();
    assert_eq!(names(&report), ["default", "fresnel off", "fresnel schlick", "fresnel polarised"]);
    assert_eq!((report["finished"].as_bool(), report["subject"]["width"].as_u64()), (Some(true), Some(32)));
    for row in report["rows"].as_array().unwrap() {
        assert!(row["seconds"]["median"].as_f64().unwrap() > 0.0);
        let [low, median, high] = [&row["ratio"]["interval"][0], &row["ratio"]["median"], &row["ratio"]["interval"][1]]
            .map(|x| x.as_f64().unwrap());
        assert!(low <= median && median <= high);
        assert_eq!(row["ledger"]["non_finite"], 0);
        let command = row["command"].as_str().unwrap();
        assert!(command.starts_with("vitrum render '") && !command.contains("--bvh"), "{command}");
    }
    let error = |i: usize| report["rows"][i]["own"]["rmse"].as_f64().unwrap();
    assert!(error(0) < error(2) && error(2) < error(1), "off is worse than Schlick, Schlick than exact");
    assert!(error(3) < error(0), "and light without polarisation is worse than light with it");
    let csv = std::fs::read_to_string(study.out().join("report.csv")).unwrap();
    assert_eq!(csv.lines().count(), 5);

    // Another axis is added to what is there, which is not measured again.
    let before = study.journal();
    study.run(&["--axes", "fresnel,depth,sampling", "--quiet"]);
    assert!(study.journal().starts_with(&before));
    let added = &study.journal()[before.len()..];
    assert!(added.contains("\"depth\":\"2\"") && !added.contains("\"own\":{\"variant\""), "the reference is kept");
    let report = study.report();
    assert!(names(&report).contains(&"depth 4") && names(&report).contains(&"fresnel schlick"));
    // Whatever times come out, light with polarisation and more rays a pixel are each more right.
    assert!(names(&report).iter().any(|name| name.contains(", ")), "combinations: {:?}", names(&report));

    // With everything there, nothing is rendered but the default, and the journal stays as it is.
    let before = study.journal();
    study.run(&["--axes", "fresnel", "--single", "--quiet"]);
    assert_eq!(study.journal(), before);
}

#[test]
fn a_journal_that_was_cut_short_or_is_of_something_else_is_noticed() {
    let study = Study::new();
    study.run(&["--axes", "fresnel", "--single", "--quiet"]);
    let text = study.journal();
    // A crash in the middle of a line: that variant is measured again.
    let cut = &text[..text.trim_end().rfind('\n').unwrap() + 40];
    std::fs::write(study.out().join("study/journal.jsonl"), format!("{cut}\n")).unwrap();
    study.run(&["--axes", "fresnel", "--single", "--quiet"]);
    assert_eq!(names(&study.report()), ["default", "fresnel off", "fresnel schlick", "fresnel polarised"]);

    study.command(&["--samples", "2"]).assert().code(2).stderr(contains("--fresh"));
    study.run(&["--samples", "2", "--axes", "fresnel", "--single", "--quiet", "--fresh"]);
    assert_eq!(study.report()["rows"][0]["levels"]["sampling"], "2x2");
}

#[test]
fn a_hierarchy_built_otherwise_is_in_every_command_and_its_journal_is_not_gone_on_from_by_another() {
    let study = Study::new();
    let wish = ["--axes", "precision", "--single", "--quiet", "--bvh", "fast"];
    study.run(&wish);
    let report = study.report();
    assert_eq!(names(&report), ["default", "precision f64"]);
    let row = |i: usize| (report["rows"][i]["command"].as_str().unwrap(), report["rows"][i]["levels"]["bvh"].as_str());
    assert!(row(0).0.ends_with("--backend native --bvh fast") && row(0).1 == Some("fast"), "{:?}", row(0));
    // Which would be refused beside it.
    assert!(row(1).0.ends_with("--backend reference"), "{:?}", row(1));

    let before = study.journal();
    study.run(&wish);
    assert_eq!(study.journal(), before, "the same study goes on");
    for other in [&["--bvh", "high"][..], &["--bvh", "default"], &[]] {
        study.command(other).assert().code(2).stderr(contains("--fresh"));
    }
    assert_eq!(study.journal(), before);
}

#[test]
fn what_is_left_out_is_said() {
    let study = Study::new();
    let text = std::fs::read_to_string(study.scene()).unwrap();
    std::fs::write(
        study.scene(),
        text.replace(
            "shape = \"sphere\"\nradius = 0.8\ncenter = [0, 0.85, 0]",
            "shape = \"torus\"\nmajor = 0.6\nminor = 0.2",
        ),
    )
    .unwrap();
    // A lamp on the floor weakens with the square of a distance that may be 0.
    let text = std::fs::read_to_string(study.scene()).unwrap().replace("position = [2, 5, 3]", "position = [2, 0, 3]");
    std::fs::write(study.scene(), text.replace("ior = 1.5", "ior = 1.5\nabbe = 50")).unwrap();
    study.run(&["--axes", "spheres,backend,fresnel,cutoff", "--single", "--quiet"]);
    let left_out = study.report()["left_out"].to_string();
    assert!(left_out.contains("spheres: the scene has no exact sphere"), "{left_out}");
    for words in [
        "fresnel polarised: polarisation is not possible in scenes whose media disperse light",
        "cutoff proven 1/64, cutoff proven 1/512, cutoff",
    ] {
        assert!(left_out.contains(words), "{words} in {left_out}");
    }
    assert!(!names(&study.report()).iter().any(|name| name.contains("proven") || name.contains("polarised")));
    if !vitrum::accel::Backend::Embree.is_compiled_in() {
        assert!(left_out.contains("backend embree"), "{left_out}");
    }
}

#[test]
fn triangle_tests_and_reciprocals_are_compared_within_one_walk_and_proven_cut_offs_are_levels() {
    let study = Study::new();
    let text = std::fs::read_to_string(study.scene()).unwrap();
    let torus = "shape = \"torus\"\nmajor = 0.6\nminor = 0.2";
    std::fs::write(study.scene(), text.replace("shape = \"sphere\"\nradius = 0.8\ncenter = [0, 0.85, 0]", torus))
        .unwrap();
    let output = study.run(&["--axes", "triangles,reciprocal,cutoff", "--single"]);
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    assert!(table.contains("over watertight's walk") && table.contains("fell to f64"), "{table}");
    let report = study.report();
    let row = |name: &str| report["rows"].as_array().unwrap().iter().find(|r| r["name"] == name).unwrap();
    for name in ["plane-area", "moller-trumbore", "pluecker", "watertight", "certified"] {
        let row = row(&format!("triangles {name}"));
        assert!(row["walk"]["median"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["command"].as_str().unwrap().contains(&format!("--backend native --triangles {name}")), "{row}");
        assert!(!row["front"].as_bool().unwrap() || row["own"]["rmse"].as_f64() > Some(0.0));
    }
    assert!(row("default")["walk"].is_null());
    assert!(row("triangles certified")["settled"].as_f64().unwrap() > 0.0);
    // The watertight test with true division is the default's own, to the bit.
    assert_eq!(row("triangles watertight")["change"]["max"], 0.0);
    assert!(row("reciprocal newton")["change"]["max"].as_f64() <= row("reciprocal estimate")["change"]["max"].as_f64());
    let proven = row("cutoff proven 1/512");
    assert!(proven["command"].as_str().unwrap().contains("--cutoff-error 0.001953125"), "{proven}");
    // The bound is beside the same depth without a cut-off; a finer one is no worse than a coarser.
    assert!(proven["own"]["rmse"].as_f64() <= row("cutoff proven 1/64")["own"]["rmse"].as_f64());
}

#[test]
fn wrong_wishes_are_refused() {
    let study = Study::new();
    for (more, words) in [
        (["--axes", "colour"], "fresnel"),
        (["--limit", "soon"], "90s"),
        (["--size", "100"], "320x240"),
        (["--backend", "reference"], "held against"),
        (["--bvh", "best"], "high"),
    ] {
        Command::cargo_bin("vitrum")
            .unwrap()
            .arg("price")
            .arg(study.scene())
            .arg("-o")
            .arg(study.out())
            .args(more)
            .assert()
            .code(2)
            .stderr(contains(words));
    }
    assert!(!study.out().exists());
    Command::cargo_bin("vitrum")
        .unwrap()
        .args(["price", "--formulas", "--bvh", "fast"])
        .assert()
        .code(2)
        .stderr("error: --bvh: formulas have no hierarchy to build; leave it out\n");
    Command::cargo_bin("vitrum").unwrap().arg("price").arg(study.scene()).assert().code(2).stderr(contains("--output"));
    Command::cargo_bin("vitrum").unwrap().args(["price", "missing.toml", "-o"]).arg(study.out()).assert().code(3);
}

/// `render` with a wish, on a scene that nothing was tuned on.
fn budget(scene: &Path, more: &[&str]) -> (Value, String, Option<i32>) {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::cargo_bin("vitrum").unwrap();
    command.arg("render").arg(scene).arg("-o").arg(folder.path().join("a.exr")).args(["--json"]).args(more);
    let output = command.output().unwrap();
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    let json = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {log}"));
    (json, log, output.status.code())
}

#[test]
fn a_bound_on_the_error_is_kept_and_told_with_its_reasons() {
    let study = Study::new();
    for bound in ["1/16", "1/512"] {
        let (summary, log, code) = budget(&study.scene(), &["--max-error", bound, "--samples", "2"]);
        assert_eq!(code, Some(0), "{log}");
        let spent = &summary["budget"];
        assert_eq!(spent["kept"], true);
        let check = &spent["steps"].as_array().unwrap().last().unwrap()["check"];
        assert!(
            check["examined"] == true
                && check["asked"].as_u64().unwrap() > 500
                && check["wrong"].as_array().unwrap().is_empty()
        );
        assert!(check["worst"].as_f64().unwrap() <= check["bound"].as_f64().unwrap());
        for pixel in check["ill"].as_array().unwrap() {
            assert!(pixel["moves_at_ulps"].as_f64().unwrap() > 0.0, "each is shown to be so: {pixel}");
        }
        for words in ["study ", "predicted ", "because ", "choice ", "check ", "--depth"] {
            assert!(log.contains(words), "{words} in\n{log}");
        }
    }
}

#[test]
fn a_bound_that_given_options_break_is_not_kept_and_says_so() {
    let study = Study::new();
    let (summary, log, code) = budget(&study.scene(), &["--max-error", "1/512", "--fresnel", "off"]);
    assert_eq!((code, &summary["budget"]["kept"]), (Some(1), &Value::Bool(false)), "{log}");
    assert!(log.contains("NOT kept") && log.contains("step up") && log.contains("not ill-conditioned"), "{log}");
    assert_eq!(summary["picture"]["fresnel"], "off", "what is given stays");
}

#[test]
fn a_time_budget_takes_the_most_accurate_that_fits_or_the_fastest() {
    let study = Study::new();
    let (summary, log, _) = budget(&study.scene(), &["--time-budget", "1h", "--bvh", "fast"]);
    assert!(summary["budget"]["kept"] == true && log.contains("in time"), "{log}");
    assert!(summary["budget"]["options"].as_str().unwrap().ends_with(" --bvh fast"), "{summary}");
    assert_eq!(summary["picture"]["fresnel"], "polarised");
    let (summary, log, _) = budget(&study.scene(), &["--time-budget", "0.001ms"]);
    assert!(summary["budget"]["kept"] == false && log.contains("nothing fits"), "{log}");
    // To ask each pixel for its condition would take far longer than the budget.
    let check = &summary["budget"]["steps"][0]["check"];
    assert!(check["examined"] == false && check["asked"].as_u64() > Some(500), "{check}");
    for list in ["ill", "wrong"] {
        assert!(check[list].as_array().is_some_and(Vec::is_empty), "{check}");
    }
    assert!(log.contains(&format!(", {} beyond ", check["beyond"])), "{log}");
    Command::cargo_bin("vitrum")
        .unwrap()
        .arg("render")
        .arg(study.scene())
        .args(["--time-budget", "1s", "--max-error", "0.1"])
        .assert()
        .code(2);
}

fn chromium() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&path).flat_map(|dir| names.map(|n| dir.join(n))).find(|p| p.is_file())
}

#[test]
fn the_page_opens_in_a_browser_without_errors_shows_every_point_and_sorts() {
    let study = Study::new();
    study.run(&["--axes", "fresnel,depth,sampling", "--pictures", "--quiet"]);
    assert!(
        study.out().join("pictures/default.exr").is_file() && study.out().join("pictures/fresnel-off.png").is_file()
    );
    let page = study.out().join("report.html");
    let text = std::fs::read_to_string(&page).unwrap();
    for foreign in ["http:", "https:", "<link", "@import", "url("] {
        assert!(!text.replace("http://www.w3.org/2000/svg", "").contains(foreign), "{foreign}");
    }
    assert!(!text.contains("a <b>") && text.contains("a &lt;b&gt; &amp; &quot;c&quot;.toml"), "names are escaped");

    let Some(chromium) = chromium() else {
        eprintln!("CHROMIUM IS NOT THERE: the page is not opened ('apt-get install chromium')");
        return;
    };
    let seen = opened(&chromium, &page);
    let report = study.report();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(seen["errors"], Value::Array(Vec::new()));
    let with = |set: &str| rows.iter().filter(|r| !r[set].is_null()).count() as u64;
    assert_eq!((seen["points"].as_u64(), seen["fine"].as_u64()), (Some(with("own")), Some(with("fine"))));
    assert_eq!((seen["rows"].as_u64(), seen["ledger"].as_u64()), (Some(rows.len() as u64), Some(rows.len() as u64)));
    assert_eq!((&seen["named"], &seen["line"]), (&Value::Bool(true), &Value::Bool(true)));
    assert!(seen["images"].as_array().unwrap().len() == 3 && !seen["images"].to_string().contains("false"));
    let times = |key: &str| -> Vec<f64> { seen[key].as_array().unwrap().iter().map(|t| t.as_f64().unwrap()).collect() };
    let (up, down) = (times("up"), times("down"));
    assert!(up.len() == rows.len() && up.is_sorted() && down.is_sorted_by(|a, b| a >= b), "{up:?} {down:?}");
    assert!(up.first() < up.last());
    assert!(
        seen["tip"].as_str().unwrap().contains("RMSE") && seen["detail"].as_str().unwrap().contains("vitrum render")
    );
}

/// Opens the page in Chromium and returns the result of the page's own check.
fn opened(chromium: &Path, page: &Path) -> Value {
    let profile = tempfile::tempdir().unwrap();
    let output = std::process::Command::new(chromium)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-logging=stderr",
            "--virtual-time-budget=20000",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}#selftest", page.display()))
        .output()
        .unwrap();
    let (dom, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(!log.contains("CONSOLE"), "{log}");
    let start = dom.find("<pre id=\"selftest\">").unwrap_or_else(|| panic!("no look at itself:\n{log}")) + 19;
    let text = &dom[start..start + dom[start..].find("</pre>").unwrap()];
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    serde_json::from_str(&text).unwrap()
}
