//! Materials that nothing uses, and models that lost faces.

use super::support::{Folder, ids, notices_of};

const LIT: &str = r#"
[camera]
eye = [0, 0, 5]
target = [0, 0, 0]
[render]
width = 8
height = 8
[[light]]
type = "directional"
direction = [0, 0, -1]
intensity = 1
[[material]]
name = "matt"
type = "diffuse"
color = 0.5
"#;

#[test]
fn a_material_that_no_mesh_names_is_named_with_its_line() {
    let scene = format!(
        "{LIT}[[mesh]]\nshape = \"sphere\"\nmaterial = \"matt\"\n[[material]]\nname = \"spare\"\ntype = \"diffuse\"\n"
    );
    let folder = Folder::with(&[("a.toml", &scene)]);
    let notices = notices_of(&folder.path("a.toml"));
    assert_eq!(ids(&notices), ["unused-material"]);
    let line = scene.lines().position(|l| l.contains("[[material]]")).unwrap() + 8;
    assert_eq!(scene.lines().nth(line - 1), Some("[[material]]"));
    let text = notices[0].to_string();
    assert!(text.contains(&format!("a.toml:{line}: the [[material]] `spare` is not used")), "{text}");
}

#[test]
fn a_material_that_only_the_camera_names_is_used() {
    let scene = LIT.replace("[camera]", "[camera]\nmedium = \"water\"")
        + "[[material]]\nname = \"water\"\ntype = \"dielectric\"\nior = 1.33\n[[mesh]]\nshape = \"sphere\"\nmaterial = \"matt\"\n";
    let folder = Folder::with(&[("a.toml", &scene)]);
    assert_eq!(ids(&notices_of(&folder.path("a.toml"))), [""; 0]);
}

/// A square of two triangles, and so many faces whose corners lie in line.
fn model(broken: usize, squares: usize) -> String {
    let mut text = String::from("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 0\n");
    for _ in 0..squares {
        text += "f 1 2 3\nf 1 3 4\n";
    }
    for _ in 0..broken {
        text += "f 1 5 3\n";
    }
    text
}

#[test]
fn a_model_that_loses_more_than_a_tenth_of_its_faces_is_named_and_one_that_loses_a_tenth_is_not() {
    // 2 of 20 faces have no area; then 3 of 21.
    for (broken, fires) in [(2, false), (3, true)] {
        let folder = Folder::with(&[("a.obj", &model(broken, 9))]);
        let notices = notices_of(&folder.path("a.obj"));
        assert_eq!(ids(&notices).contains(&"dropped-faces"), fires, "{broken} broken faces: {notices:?}");
        if fires {
            let text = notices[0].to_string();
            assert!(text.contains("a.obj: 3 of 21 faces are missing"), "{text}");
        }
    }
}

#[test]
fn faces_that_the_loader_leaves_out_count_as_well() {
    // Faces with two corners at one place are left out: 2 of 4 faces.
    let text = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\nf 1 1 2\nf 3 3 4\n";
    let folder = Folder::with(&[("a.obj", text)]);
    let notices = notices_of(&folder.path("a.obj"));
    assert_eq!(ids(&notices), ["dropped-faces"]);
    assert!(notices[0].to_string().contains("2 of 4 faces"), "{}", notices[0]);
}
