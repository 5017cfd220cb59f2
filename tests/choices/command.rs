//! The choices as flags of the program.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use tempfile::TempDir;

pub const SCENE: &str = r#"
[camera]
eye = [0, 1, 5]
target = [0, 0.5, 0]

[render]
width = 16
height = 12
depth = 6

[environment]
type = "constant"
color = [0.5, 0.5, 0.5]

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

fn render(scene: &str, arguments: &[&str]) -> (TempDir, assert_cmd::assert::Assert) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let mut command = Command::cargo_bin("vitrum").unwrap();
    let done = command.current_dir(&folder).args(["render", "scene.toml", "-o", "out.png"]).args(arguments).assert();
    (folder, done)
}

#[test]
fn every_choice_is_taken_by_both_renderers_and_told_in_the_summary() {
    for backend in ["native", "reference"] {
        for (arguments, told) in [
            (&["--fresnel", "polarised"][..], "Fresnel polarised"),
            (&["--reflection", "none"], "reflection none"),
            (&["--reflection", "environment"], "reflection environment"),
            (&["--cutoff-error", "0.01"], "cut-off within 0.01 a channel"),
        ] {
            let (folder, done) = render(SCENE, &[arguments, &["--backend", backend]].concat());
            done.success().stderr(contains(told));
            assert!(folder.path().join("out.png").exists());
        }
    }
}

#[test]
fn a_proven_cut_off_that_makes_no_sense_is_refused() {
    for (arguments, told) in [
        (&["--cutoff-error", "0"][..], "not a finite number above 0"),
        (&["--cutoff-error", "-1"], "not a finite number above 0"),
        (&["--cutoff-error", "NaN"], "not a finite number above 0"),
        (&["--cutoff-error", "0.1", "--cutoff", "0.1"], "cannot be used with"),
        (&["--reflection", "some"], "environment"),
    ] {
        render(SCENE, arguments).1.code(2).stderr(contains(told));
    }
}

#[test]
fn a_lamp_on_the_floor_is_refused_in_one_line_and_nothing_is_written() {
    let on_the_floor = SCENE.replace("position = [3, 4, 3]", "position = [3, 0, 3]");
    for backend in ["native", "reference"] {
        let (folder, done) = render(&on_the_floor, &["--cutoff-error", "0.01", "--backend", backend, "--quiet"]);
        let one_line = predicate::function(|text: &str| text.trim_end().lines().count() == 1);
        done.code(2).stderr(contains("`lamp`").and(contains("`ground`")).and(contains("falloff")).and(one_line));
        assert!(!folder.path().join("out.png").exists());
    }
}

/// The stages that know everything ask no more of a scene than those it calls for.
#[test]
fn what_needs_undispersed_light_is_to_be_had_with_every_stage_and_where_dispersion_is_left_out() {
    for choice in [["--fresnel", "polarised"], ["--cutoff-error", "0.01"]] {
        let picture = |scene: &str, arguments: &[&str]| {
            let (folder, done) = render(scene, &[&choice[..], &["--backend", "native"], arguments].concat());
            done.success();
            // Pixels alone: the file also says what was left out.
            image::open(folder.path().join("out.png")).unwrap()
        };
        let plain = picture(SCENE, &[]);
        assert!(picture(SCENE, &["--effects", "all"]) == plain, "{choice:?}");
        let dispersing = SCENE.replace("ior = 1.5", "ior = 1.5\nabbe = 50");
        assert!(picture(&dispersing, &["--no-dispersion"]) == plain, "{choice:?}");
        let (_, refused) = render(&dispersing, &[&choice[..], &["--quiet"]].concat());
        let one_line = predicate::function(|text: &str| text.trim_end().lines().count() == 1);
        refused.code(2).stderr(contains(choice[0]).and(contains("--no-dispersion")).and(one_line));
    }
}
