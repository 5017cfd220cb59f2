//! Closed dielectrics that are inside out, and the objects of unmatched exits.

use assert_cmd::Command;
use serde_json::Value;

use super::support::{Folder, ids, notices_of};

const HEAD: &str = r#"
[camera]
eye = [0.3, 1, 5]
target = [0, 0, 0]
fov = 40
[render]
width = 24
height = 18
depth = 8
[environment]
type = "constant"
color = 1
[[material]]
name = "glass"
type = "dielectric"
ior = 1.5
absorption = [0.1, 0.5, 1]
"#;

/// Faces of a cube, outwards.
const FACES: [[u32; 4]; 6] = [[1, 5, 7, 3], [2, 4, 8, 6], [1, 2, 6, 5], [3, 7, 8, 4], [1, 3, 4, 2], [5, 6, 8, 7]];

/// The first `faces` of a cube of half size `h` around (`x`, 0, 0) as text of a model whose corners follow `before` others.
fn cube(x: f32, h: f32, faces: usize, outwards: bool, before: u32) -> String {
    let at = |bit: u32| if bit == 0 { -h } else { h };
    let corners = (0..8).map(|i: u32| format!("v {} {} {}\n", x + at(i & 1), at(i >> 1 & 1), at(i >> 2)));
    let face = |&[a, b, c, d]: &[u32; 4]| {
        let [a, b, c, d] = if outwards { [a, b, c, d] } else { [d, c, b, a] }.map(|i| i + before);
        format!("f {a} {b} {c} {d}\n")
    };
    corners.chain(FACES[..faces].iter().map(face)).collect()
}

fn mesh(name: &str, keys: &str) -> String {
    format!("[[mesh]]\nname = \"{name}\"\nmaterial = \"glass\"\n{keys}\n")
}

/// Summary of a render in JSON, and what it wrote to standard error.
fn rendered(folder: &Folder, scene: &str, arguments: &[&str]) -> (Value, String) {
    let output = Command::cargo_bin("vitrum")
        .expect("it is built")
        .args(["render", "--json", "--threads", "1", "-o"])
        .arg(folder.path("out.png"))
        .arg(folder.path(scene))
        .args(arguments)
        .assert()
        .success()
        .get_output()
        .clone();
    let json = serde_json::from_slice(&output.stdout).expect("JSON");
    (json, String::from_utf8(output.stderr).expect("text"))
}

fn has_embree() -> bool {
    let output =
        Command::cargo_bin("vitrum").expect("it is built").args(["doctor", "--json"]).output().expect("it runs");
    let findings: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    findings["backends"].as_array().expect("a list").iter().any(|name| name == "embree")
}

fn backends() -> Vec<&'static str> {
    let mut names = vec!["native", "reference"];
    if has_embree() {
        names.extend(["embree", "embree-fast"]);
    }
    names
}

#[test]
fn a_glass_whose_faces_point_inwards_is_named_with_the_cure_and_the_cure_works() {
    let scene = |keys: &str| format!("{HEAD}{}", mesh("jar", &format!("file = \"in.obj\"\n{keys}")));
    let folder = Folder::with(&[
        ("in.obj", &cube(0.0, 1.0, 6, false, 0)),
        ("out.obj", &cube(0.0, 1.0, 6, true, 0)),
        ("wrong.toml", &scene("")),
        ("cured.toml", &scene("flip = true")),
        ("right.toml", &scene("").replace("in.obj", "out.obj")),
        ("turned.toml", &scene("flip = true").replace("in.obj", "out.obj")),
    ]);
    for name in ["wrong.toml", "turned.toml"] {
        let notices = notices_of(&folder.path(name));
        assert_eq!(ids(&notices), ["inside-out"], "{name}");
        let text = notices[0].to_string();
        assert!(
            text.contains(".obj:") && text.contains("`jar` is inside out") && text.contains("`flip = true`"),
            "{text}"
        );
    }
    for name in ["cured.toml", "right.toml"] {
        assert!(!ids(&notices_of(&folder.path(name))).contains(&"inside-out"), "{name}");
    }
    for backend in backends() {
        let (json, told) = rendered(&folder, "wrong.toml", &["--backend", backend]);
        assert!(told.contains("warning: ") && told.contains("`jar` is inside out"), "{backend}: {told}");
        let losses = &json["losses"];
        let worst = &losses["unmatched_objects"][0];
        assert!(losses["unmatched_exits"].as_u64() > Some(50), "{backend}: {losses}");
        assert_eq!((&worst["object"], &worst["exits"]), (&Value::from("jar"), &losses["unmatched_exits"]), "{backend}");
        assert!(worst["cause"].as_str().expect("text").contains("inside out"), "{backend}: {worst}");
        assert!(told.contains("unmatched ") && told.contains("`jar` "), "{backend}: {told}");
        let (json, told) = rendered(&folder, "cured.toml", &["--backend", backend]);
        assert!(!told.contains("inside out") && !told.contains("unmatched"), "{backend}: {told}");
        assert_eq!(json["losses"]["unmatched_objects"], Value::Array(Vec::new()), "{backend}");
    }
    // The same words from the other commands; an error under --strict.
    let notice = notices_of(&folder.path("wrong.toml"))[0].to_string();
    let vitrum = || Command::cargo_bin("vitrum").expect("it is built");
    let verify =
        vitrum().args(["verify", "--threads", "1", "--json"]).arg(folder.path("wrong.toml")).assert().success();
    let report: Value = serde_json::from_slice(&verify.get_output().stdout).expect("JSON");
    assert_eq!(report["warnings"], Value::from(vec![notice.clone()]));
    let strict = vitrum().args(["render", "--strict"]).arg(folder.path("wrong.toml")).assert().code(2);
    let told = String::from_utf8(strict.get_output().stderr.clone()).expect("text");
    assert!(told.contains(&notice), "{told}");
}

#[test]
fn what_is_open_or_opaque_or_the_wall_of_a_hollow_is_not_accused() {
    let glass = |keys: &str| format!("{HEAD}{}", mesh("jar", keys));
    let hollow = cube(0.0, 1.0, 6, true, 0) + &cube(0.0, 0.5, 6, false, 8);
    let wall = mesh("wall", "shape = \"box\"\nsize = 1\nflip = true");
    let bottle = glass("shape = \"box\"\nsize = 2") + &wall;
    let folder = Folder::with(&[
        ("open.obj", &cube(0.0, 1.0, 5, false, 0)),
        ("ajar.obj", &cube(0.0, 1.0, 5, true, 0)),
        ("hollow.obj", &hollow),
        ("open.toml", &glass("file = \"open.obj\"")),
        ("ajar.toml", &glass("file = \"ajar.obj\"")),
        ("hollow.toml", &glass("file = \"hollow.obj\"")),
        (
            "mirror.toml",
            &glass("shape = \"box\"\nflip = true")
                .replace("dielectric\"\nior = 1.5", "mirror\"")
                .replace("absorption", "reflectance"),
        ),
        ("bottle.toml", &bottle),
        ("beside.toml", &bottle.replace("size = 1\n", "size = 1\ncenter = [3, 0, 0]\n")),
    ]);
    for name in ["open.toml", "ajar.toml", "hollow.toml", "mirror.toml", "bottle.toml"] {
        assert!(!ids(&notices_of(&folder.path(name))).contains(&"inside-out"), "{name}");
    }
    let notices = notices_of(&folder.path("beside.toml"));
    assert_eq!(ids(&notices), ["inside-out"]);
    assert!(
        notices[0].to_string().contains("beside.toml:") && notices[0].finding.wrong.contains("`wall`"),
        "{notices:?}"
    );
    // An open one, into which the camera looks, is named as the object of its exits, with that cause.
    let (json, _) = rendered(&folder, "ajar.toml", &["--backend", "native"]);
    let worst = &json["losses"]["unmatched_objects"][0];
    assert!(worst["cause"].as_str().expect("text").contains("not closed"), "{}", json["losses"]);
}

#[test]
fn of_two_separate_parts_of_a_mesh_the_one_that_is_inside_out_is_counted() {
    let folder = Folder::with(&[
        ("two.obj", &(cube(0.0, 1.0, 6, true, 0) + &cube(4.0, 1.0, 6, false, 8))),
        ("two.toml", &format!("{HEAD}{}", mesh("pair", "file = \"two.obj\""))),
    ]);
    let notices = notices_of(&folder.path("two.toml"));
    assert_eq!(ids(&notices), ["inside-out"]);
    assert!(notices[0].finding.wrong.contains("1 of the 2 separate parts of `pair`"), "{notices:?}");
}

#[test]
fn objects_of_unmatched_exits_come_worst_first() {
    // Boxes of growing size, all inside out.
    let boxes: String = (1..=7)
        .map(|i| {
            let (size, x) = (0.2 * f64::from(i), 1.6 * f64::from(i) - 6.4);
            mesh(&format!("box {i}"), &format!("shape = \"box\"\nsize = {size}\ncenter = [{x}, 0, -3]\nflip = true"))
        })
        .collect();
    let folder = Folder::with(&[(
        "a.toml",
        &format!("{HEAD}{boxes}").replace("width = 24", "width = 120").replace("height = 18", "height = 60"),
    )]);
    for backend in ["native", "reference"] {
        let (json, told) = rendered(&folder, "a.toml", &["--backend", backend]);
        let objects = json["losses"]["unmatched_objects"].as_array().expect("a list");
        let exits: Vec<u64> = objects.iter().map(|object| object["exits"].as_u64().expect("a number")).collect();
        assert!(objects.len() == 7 && exits.windows(2).all(|w| w[0] >= w[1]), "{backend}: {exits:?}");
        assert_eq!(exits.iter().sum::<u64>(), json["losses"]["unmatched_exits"].as_u64().expect("a number"));
        let worst = objects[0]["object"].as_str().expect("text");
        let last = objects[6]["object"].as_str().expect("text");
        assert!(told.contains(&format!("`{worst}` ")) && told.contains("and 2 other objects"), "{backend}: {told}");
        assert_eq!(last, "box 1", "{backend}: the smallest is met least");
    }
}
