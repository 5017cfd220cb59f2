//! Promise: `vitrum map` and the notes' systems on the command line say what is wrong, where and what to do.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::support::program::{names, program};

const HEAD: &str = r#"
[camera]
eye = [0, 1, 4]
target = [0, 0.5, 0]
fov = 40

[render]
width = 24
height = 16

[[light]]
name = "lamp"
type = "point"
position = [2, 4, 3]
intensity = 20

[[material]]
name = "silver"
type = "mirror"

[[material]]
name = "glass"
type = "dielectric"
ior = 1.5

[[material]]
name = "clay"
type = "diffuse"
color = [0.6, 0.4, 0.3]

[[mesh]]
name = "floor"
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
material = "clay"
"#;

fn folder(object: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), format!("{HEAD}\n{object}")).unwrap();
    folder
}

fn run(folder: &Path, line: &str) -> Output {
    Command::new(program()).current_dir(folder).args(line.split_whitespace()).output().unwrap()
}

/// Runs a command that must fail with one line, and returns the line.
fn refused(folder: &Path, line: &str) -> String {
    let before = names(folder);
    let output = run(folder, line);
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{line}: {told}");
    assert!(told.starts_with("error: ") && told.lines().count() == 1, "{line}: {told}");
    assert_eq!(names(folder), before, "{line}");
    told
}

const BALL: &str = "[[mesh]]\nname = \"ball\"\nshape = \"sphere\"\ncenter = [0, 0.6, 0]\nradius = 0.5\n";

#[test]
fn a_map_is_written_and_is_an_environment() {
    let folder = folder(&format!("{BALL}material = \"silver\""));
    for (kind, shape) in [("cube", (48, 8)), ("sphere", (8, 8)), ("latlong", (16, 8))] {
        let output = run(folder.path(), &format!("map scene.toml --at 0,2,0 --kind {kind} --size 8 -o {kind}.exr -q"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let film = vitrum::image::read(&folder.path().join(format!("{kind}.exr")), &Default::default()).unwrap().film;
        assert_eq!((film.width, film.height), shape, "{kind}");
        let scene = format!("{HEAD}\n[environment]\ntype = \"{kind}\"\nfile = \"{kind}.exr\"\n");
        std::fs::write(folder.path().join("inside.toml"), scene).unwrap();
        assert!(run(folder.path(), "render inside.toml -o inside.png -q").status.success(), "{kind}");
    }
}

#[test]
fn a_map_of_a_scene_with_a_warning_says_it_and_under_strict_refuses() {
    // An open sheet of glass, wound inside out, warns.
    let folder = folder(
        "[[mesh]]\nname = \"sheet\"\nshape = \"disc\"\ncenter = [0, 1, 0]\nnormal = [0, 0, -1]\nradius = 0.5\nmaterial = \"glass\"",
    );
    let line = "map scene.toml --at 0,2,0 --kind cube --size 8 -o map.exr";
    let told = String::from_utf8(run(folder.path(), line).stderr).unwrap();
    assert!(told.contains("warning: ") && told.contains("sheet"), "{told}");
    std::fs::remove_file(folder.path().join("map.exr")).unwrap();
    assert!(refused(folder.path(), &format!("{line} --strict")).contains("sheet"));
}

#[test]
fn wrong_wishes_for_a_map_are_refused() {
    let folder = folder(&format!("{BALL}material = \"silver\""));
    let at = |more: &str| format!("map scene.toml {more}");
    for (line, says) in [
        (at("--at 0,2 --kind cube -o a.exr"), "X,Y,Z"),
        (at("--at 0,nan,0 --kind cube -o a.exr"), "X,Y,Z"),
        (at("--at 0,1e300,0 --kind cube -o a.exr"), "--at"),
        (at("--at 0,2,0 --kind tube -o a.exr"), "--kind"),
        (at("--at 0,2,0 --kind cube -o a.gif"), "a.gif"),
        (at("--at 0,2,0 --kind cube -o scene.toml"), "-o"),
        (at("--at 0,2,0 --kind cube --size 0 -o a.exr"), "--size"),
        (at("--at 0,2,0 -o a.exr"), "--kind"),
    ] {
        assert!(refused(folder.path(), &line).contains(says), "{line}");
    }
}

#[test]
fn a_map_of_the_wrong_shape_is_refused_as_an_environment() {
    let folder = folder(&format!("{BALL}material = \"silver\""));
    assert!(run(folder.path(), "map scene.toml --at 0,2,0 --kind sphere --size 8 -o map.exr -q").status.success());
    for kind in ["cube", "latlong"] {
        let scene = format!("{HEAD}\n[environment]\ntype = \"{kind}\"\nfile = \"map.exr\"\n");
        std::fs::write(folder.path().join("inside.toml"), scene).unwrap();
        let told = refused(folder.path(), "render inside.toml -o a.png");
        assert!(told.contains("inside.toml:") && told.contains(&format!("vitrum map --kind {kind}")), "{told}");
    }
}

#[test]
fn a_reflector_that_a_system_does_not_serve_is_refused_by_name_with_a_cure() {
    let dented = "[[mesh]]\nname = \"vase\"\nshape = \"lathe\"\nsmooth = 180\ntessellation = 24\nprofile = [[0, 0], [0.4, 0.1], [0.2, 0.5], [0.4, 0.9], [0, 1]]\n";
    let rough = "[[mesh]]\nname = \"block\"\nshape = \"box\"\nsize = [1, 1, 1]\ncenter = [0, 0.6, 0]\n";
    for (object, material, flag, says) in [
        (BALL, "silver", "--reflection planar", "`ball` is a sphere"),
        (dented, "silver", "--reflection virtual", "`vase` is neither convex nor concave"),
        (rough, "silver", "--reflection virtual", "`block` has no normals to interpolate"),
        (BALL, "glass", "--refraction raised", "`ball` is a sphere"),
    ] {
        let folder = folder(&format!("{object}material = \"{material}\""));
        let told = refused(folder.path(), &format!("render scene.toml -o a.png {flag}"));
        assert!(
            told.contains(flag) && told.contains(says) && told.contains("take --re")
                || told.contains("or --refraction"),
            "{told}"
        );
        // The price of the same level is left out with the same reason.
        let axis = flag.trim_start_matches("--").split(' ').next().unwrap();
        let output = run(folder.path(), "explain scene.toml --quiet");
        let told = String::from_utf8(output.stdout).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(told.contains(&format!("{flag} (impossible: {says}")), "{axis}: {told}");
    }
    let zero = "[[mesh]]\nname = \"glass wall\"\nshape = \"plane\"\npoint = [0, 0, -2]\nnormal = [0, 0, 0]\nmaterial = \"silver\"";
    let folder = folder(zero);
    let told = refused(folder.path(), "render scene.toml -o a.png --reflection planar");
    assert!(told.contains("scene.toml:") && told.contains("normal"), "{told}");
}

#[test]
fn every_system_renders_and_tells_what_it_did() {
    let folder = folder(&format!(
        "{BALL}material = \"silver\"\n[[mesh]]\nname = \"slab\"\nshape = \"box\"\nsize = [0.5, 0.8, 0.2]\ncenter = [1, 0.5, 0]\nmaterial = \"glass\""
    ));
    for (flag, says) in [
        ("--reflection cube-map", "maps"),
        ("--reflection sphere-map", "maps"),
        ("--reflection virtual", "virtual"),
        ("--reflection planar", "mirrors"),
        ("--refraction map-one", "body maps"),
        ("--refraction map-two", "body maps"),
        ("--refraction raised", "Mrays/s"),
    ] {
        let output = run(folder.path(), &format!("render scene.toml -o a.png {flag}"));
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && told.contains(says), "{flag}: {told}");
    }
}

#[test]
fn mirror_levels_have_a_range_and_do_not_depend_on_threads() {
    let wall = |name: &str, z: f32, n: f32| {
        format!(
            "[[mesh]]\nname = \"{name}\"\nshape = \"plane\"\npoint = [0, 0, {z}]\nnormal = [0.05, 0, {n}]\nmaterial = \"silver\"\n"
        )
    };
    let folder = folder(&format!("{}{}", wall("far", -2.0, 1.0), wall("near", 5.0, -1.0)));
    for wrong in ["10001", "-1", "4294967295", "many"] {
        let told =
            refused(folder.path(), &format!("render scene.toml -o a.png --reflection planar --mirror-levels {wrong}"));
        assert!(told.contains("--mirror-levels"), "{told}");
    }
    let systems = |threads: u32| {
        let line = format!(
            "render scene.toml -o a.png --reflection planar --mirror-levels 9 --tile 8 --json --threads {threads}"
        );
        let output = run(folder.path(), &line);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        json["mirrors"]["levels"].to_string()
    };
    let one = systems(1);
    assert!(one.contains("mean_weight"), "{one}");
    assert!([2, 3, 8].into_iter().all(|threads| systems(threads) == one));
}

#[test]
fn the_page_of_all_systems_has_two_scenes_each_and_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "price --reflections -o page --size 24x16 --runs 1 -q");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(folder.path().join("page/reflections.html")).unwrap();
    assert_eq!(page.matches("<dt>why</dt>").count(), 18);
    assert_eq!(page.matches("data:image/png;base64,").count(), 3 * 18);
    assert!(!page.contains("NaN") && !page.contains("<script"));
    let json = std::fs::read_to_string(folder.path().join("page/reflections.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    for row in json["rows"].as_array().unwrap() {
        assert!(row["errors"]["rmse"].as_f64().unwrap().is_finite(), "{row}");
        let scene = folder.path().join(row["scene"].as_str().unwrap());
        assert!(scene.exists(), "{row}");
    }
    let told = refused(folder.path(), "price --reflections");
    assert!(told.contains("-o"), "{told}");
    assert!(refused(folder.path(), "price --reflections scene.toml -o page").contains("--reflections"));
}
