//! Pictures that show nothing but the environment, and the reason.

use super::support::{Folder, ids, kinds, notices_by_all, only_notice};

/// A ball of radius 1 at the origin, seen from +z.
const BALL: &str = r#"
[camera]
eye = [0, 0, 5]
target = [0, 0, 0]
[render]
width = 16
height = 12
[environment]
type = "constant"
color = 1
[[light]]
type = "directional"
direction = [0, -1, -1]
intensity = 1
[[material]]
name = "paint"
type = "diffuse"
color = 0.5
[[mesh]]
name = "ball"
shape = "sphere"
material = "paint"
"#;

/// A cube with this material.
fn cube(material: &str) -> Folder {
    let mut model = String::from("mtllib m.mtl\nusemtl red\n");
    for k in 0..8 {
        let side = |bit: i32| 2 * (k >> bit & 1) - 1;
        model += &format!("v {} {} {}\n", side(0), side(1), side(2));
    }
    model += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    Folder::with(&[("a.obj", &model), ("m.mtl", &format!("newmtl red\nKd 0.8 0.1 0.1\n{material}\n"))])
}

#[test]
fn what_is_in_the_picture_is_no_fault() {
    assert_eq!(kinds(BALL), [""; 0]);
    assert_eq!(ids(&notices_by_all(&cube("d 1").path("a.obj"))), [""; 0]);
    // Hardly there, and yet to be seen.
    assert_eq!(ids(&notices_by_all(&cube("d 0.01").path("a.obj"))), [""; 0]);
}

#[test]
fn a_model_of_opacity_0_is_named_and_nothing_else_is_said() {
    let notices = notices_by_all(&cube("d 0").path("a.obj"));
    assert_eq!(ids(&notices), ["nothing-seen"]);
    assert!(notices[0].finding.because.contains("`red` of `a/red` has opacity 0"), "{}", notices[0]);
}

#[test]
fn a_body_of_the_index_around_it_cannot_be_seen() {
    let glass = |ior: f64| BALL.replace("\"diffuse\"\ncolor = 0.5", &format!("\"dielectric\"\nior = {ior}"));
    assert_eq!(kinds(&glass(1.5)), [""; 0]);
    let notice = only_notice(&glass(1.0));
    assert_eq!(notice.id, "nothing-seen");
    assert!(notice.finding.because.contains("refractive index"), "{notice}");
}

#[test]
fn faces_without_area_are_named() {
    let folder = Folder::with(&[("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n")]);
    let notices = notices_by_all(&folder.path("a.obj"));
    assert_eq!(ids(&notices), ["dropped-faces", "nothing-seen"]);
    assert!(notices[0].finding.wrong.contains("1 of 1 faces"), "{}", notices[0]);
    assert!(notices[1].finding.because.contains("can be hit"), "{}", notices[1]);
}

#[test]
fn a_camera_that_looks_away_or_past_is_told_where_to_look() {
    let aimed = |target: &str| only_notice(&BALL.replace("target = [0, 0, 0]", target));
    for (target, how) in [("target = [0, 0, 10]", "away from everything"), ("target = [10, 0, 5]", "past everything")] {
        let notice = aimed(target);
        assert_eq!(notice.id, "nothing-seen");
        assert!(notice.finding.because.contains(how), "{notice}");
        assert!(notice.finding.cure.contains("`target = [0, 0, 0]`"), "the middle of the ball: {notice}");
    }
}

#[test]
fn a_camera_that_looks_into_the_sky_over_a_floor_is_told_so() {
    let floor = BALL.replace("shape = \"sphere\"", "shape = \"plane\"\npoint = [0, -1, 0]");
    let notice = only_notice(&floor.replace("target = [0, 0, 0]", "target = [0, 9, 0]"));
    assert_eq!(notice.id, "nothing-seen");
    assert!(notice.finding.because.contains("away from everything"), "{notice}");
}

#[test]
fn a_scene_smaller_than_a_pixel_is_told_its_size() {
    // 12 pixels are 2 * 5 * tan(20 degrees) = 3.64 units at a distance of 5: the ball is 6.6e-3 pixels wide.
    // The middle of the picture lies between pixels, so that no ray meets it.
    let notice = only_notice(&BALL.replace("shape = \"sphere\"", "shape = \"sphere\"\nradius = 0.001"));
    assert_eq!(notice.id, "nothing-seen");
    assert!(notice.finding.because.contains("6.6e-3 pixels wide"), "{notice}");
}
