//! Matt surfaces that no light reaches, and the reason.

use super::support::{Folder, ids, kinds, notices_by_all, only_notice};

/// A ball on a plane, both matt, seen from above; the rest is `more`.
fn scene(more: &str) -> String {
    format!(
        r#"
[camera]
eye = [0, 1, 4]
target = [0, 0.3, 0]
[render]
width = 16
height = 12
[[material]]
name = "matt"
type = "diffuse"
color = 0.8
[[mesh]]
name = "ball"
shape = "sphere"
center = [0, 0.5, 0]
radius = 0.5
material = "matt"
[[mesh]]
name = "floor"
shape = "plane"
material = "matt"
{more}"#
    )
}

const ENVIRONMENT: &str = "[environment]\ntype = \"constant\"\ncolor = 1\n";
const EMITTER: &str = "[[material]]\nname = \"e\"\ntype = \"emissive\"\nemission = 20\n\
    [[mesh]]\nname = \"bulb\"\nshape = \"sphere\"\ncenter = [1.5, 2, 0]\nradius = 0.3\nmaterial = \"e\"\n";
const LAMP: &str = "[[light]]\nname = \"lamp\"\ntype = \"point\"\nposition = [0, 3, 3]\nintensity = 20\n";

/// A ball around the lamp.
fn shade(kind: &str) -> String {
    format!(
        "[[material]]\nname = \"s\"\n{kind}\n\
         [[mesh]]\nname = \"shade\"\nshape = \"sphere\"\ncenter = [0, 3, 3]\nradius = 0.2\nmaterial = \"s\"\n"
    )
}

#[test]
fn what_shines_is_enough_and_its_being_kept_from_lighting_is_named() {
    for more in [ENVIRONMENT, EMITTER] {
        assert_eq!(kinds(&scene(more)), [""; 0]);
        let lamps = scene(more).replace("height = 12", "height = 12\nlights_from = \"lamps\"");
        let notice = only_notice(&lamps);
        assert_eq!(notice.id, "unlit");
        assert_eq!(notice.finding.wrong, "no light reaches `ball` and 1 other matt object in view");
        assert!(notice.finding.because.contains("`lights_from` does not admit"), "{notice}");
        assert_eq!(notice.finding.place.line, 13, "the line of the ball");
        // The cure is one.
        let cured = lamps.replace("\"lamps\"", "\"all\"");
        assert!(notice.finding.cure.contains("lights_from = \"all\"") && kinds(&cured).is_empty(), "{notice}");
    }
    let notice = only_notice(&scene(""));
    assert!(notice.finding.because.contains("its environment is black"), "{notice}");
}

#[test]
fn a_picture_as_environment_lights_matt_surfaces() {
    let folder = Folder::with(&[("a.toml", &scene("[environment]\ntype = \"image\"\nfile = \"sky.pfm\"\n"))]);
    let mut sky = b"PF\n2 1\n-1.0\n".to_vec();
    sky.extend([1.0_f32; 6].iter().flat_map(|x| x.to_le_bytes()));
    std::fs::write(folder.path("sky.pfm"), sky).unwrap();
    assert_eq!(ids(&notices_by_all(&folder.path("a.toml"))), [""; 0]);
}

#[test]
fn an_emissive_shape_beside_a_lamp_lights_nothing_unless_the_scene_says_so() {
    let text = scene(&(LAMP.to_owned() + EMITTER));
    let notice = only_notice(&text);
    assert_eq!((notice.id, notice.finding.wrong.as_str()), ("lights-nothing", "`bulb` shines and lights nothing"));
    for level in ["lamps", "emissive", "all"] {
        let said = text.replace("height = 12", &format!("height = 12\nlights_from = \"{level}\""));
        assert_eq!(kinds(&said), [""; 0], "{level}");
    }
    let plane = EMITTER
        .replace("shape = \"sphere\"\ncenter = [1.5, 2, 0]\nradius = 0.3", "shape = \"plane\"\npoint = [0, -9, 0]");
    let notice = only_notice(&scene(&(ENVIRONMENT.to_owned() + &plane)));
    assert_eq!(notice.id, "lights-nothing");
    assert!(notice.finding.because.contains("no bounds"), "{notice}");
}

#[test]
fn a_lamp_or_ambient_light_is_enough() {
    assert_eq!(kinds(&scene(LAMP)), [""; 0]);
    assert_eq!(kinds(&scene(&LAMP.replace("intensity", "shadows = false\nintensity"))), [""; 0]);
    let ambient = scene("[environment]\ntype = \"constant\"\ncolor = 1\nambient = 1\n");
    assert_eq!(kinds(&ambient.replace("color = 0.8", "color = 0.8\nambient = 0.3")), [""; 0]);
}

#[test]
fn a_lamp_with_an_extent_is_enough_with_and_without_shadows() {
    let ball = LAMP.replace("\"point\"", "\"sphere\"\nradius = 0.1");
    assert_eq!(kinds(&scene(&ball)), [""; 0]);
    assert_eq!(kinds(&scene(&ball.replace("intensity", "shadows = false\nintensity"))), [""; 0]);
}

#[test]
fn a_lamp_of_no_intensity_is_named() {
    let notice = only_notice(&scene(&LAMP.replace("= 20", "= 0")));
    assert!(notice.finding.because.contains("intensity 0"), "{notice}");
}

#[test]
fn what_stands_in_the_way_of_a_lamp_is_named_with_the_lamp() {
    let notice = only_notice(&scene(&(LAMP.to_owned() + &shade("type = \"diffuse\""))));
    assert_eq!((notice.id, notice.finding.because.as_str()), ("unlit", "`shade` is in the way of the light `lamp`"));
    // Glass lets it through, unless shadows are told to be opaque.
    let glass = LAMP.to_owned() + &shade("type = \"dielectric\"\nior = 1.5");
    assert_eq!(kinds(&scene(&glass)), [""; 0]);
    let opaque = scene(&glass).replace("height = 12", "height = 12\nshadows = \"opaque\"");
    let notice = only_notice(&opaque);
    assert!(notice.finding.cure.contains("shadows = \"straight\""), "{notice}");
}

#[test]
fn lamps_that_shine_from_below_the_floor_are_named() {
    let below =
        LAMP.replace("type = \"point\"\nposition = [0, 3, 3]", "type = \"directional\"\ndirection = [0, 1, -1]");
    let text = scene(&below).replace("[0, 0.5, 0]", "[0, -5, 0]");
    let notice = only_notice(&text);
    assert_eq!(notice.id, "unlit");
    assert!(notice.finding.because.contains("far sides"), "{notice}");
    assert_eq!(notice.finding.wrong, "no light reaches `floor`", "the ball is out of sight, under the floor");
}

#[test]
fn a_camera_in_a_matt_body_with_the_lamp_outside_is_told_so_and_nothing_else() {
    let text = scene(LAMP).replace("eye = [0, 1, 4]", "eye = [0.1, 0.6, 0.1]");
    let notice = only_notice(&text);
    assert_eq!(notice.id, "camera-inside");
    assert!(notice.finding.wrong.contains("inside `ball`"), "{notice}");
    // A mesh does as the exact shape.
    let mesh = text.replace("radius = 0.5", "radius = 0.5\ntessellation = 8");
    assert_eq!(only_notice(&mesh).id, "camera-inside");
}

#[test]
fn rooms_and_domes_around_the_camera_are_no_fault() {
    let room = "[[mesh]]\nname = \"room\"\nshape = \"box\"\nsize = [20, 20, 20]\nmaterial = \"matt\"\n";
    assert_eq!(kinds(&scene(&(LAMP.to_owned() + room))), [""; 0], "the lamp is in the room");
    assert_eq!(only_notice(&scene(room)).id, "unlit", "no lamp at all");
    let dome = EMITTER.replace("radius = 0.3", "radius = 30");
    assert_eq!(kinds(&scene(&dome)), [""; 0]);
}

#[test]
fn a_camera_in_a_mirror_ball_sees_nothing_but_mirrors() {
    let text = scene(LAMP)
        .replace("type = \"diffuse\"\ncolor = 0.8", "type = \"mirror\"\nreflectance = 0.9")
        .replace("[0, 1, 4]", "[0.1, 0.6, 0.1]");
    assert_eq!(only_notice(&text).id, "camera-inside");
}
