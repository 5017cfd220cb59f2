//! The program in a build without Embree: native is the default, and who asks for Embree is told how to get it.
#![cfg(not(feature = "embree"))]

use assert_cmd::Command;
use predicates::str::contains;

fn vitrum(arguments: &str) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("vitrum").expect("it is built");
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments.split(' ')).assert()
}

#[test]
fn the_default_back_end_is_native() {
    let done = vitrum("doctor --json").success();
    let findings: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).expect("JSON");
    assert_eq!(findings["default_backend"], "native");
    let names = findings["backends"].as_array().expect("a list");
    assert!(!names.iter().any(|name| name.as_str().expect("a name").starts_with("embree")), "{names:?}");
}

#[test]
fn every_command_that_is_asked_for_embree_says_how_to_build_it_in_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("a.png");
    for backend in ["embree", "embree-fast"] {
        let render = format!("render scenes/glass.toml --width 8 --height 8 -o {} --backend {backend}", out.display());
        vitrum(&render).code(4).stderr(contains("--features embree"));
    }
    vitrum("verify --group leaks --backend embree").code(4).stderr(contains("--features embree"));
    assert!(!out.exists());
}
