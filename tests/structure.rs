//! The house keeps its shape: rooms import only from the rooms below them.

mod build_flags;
mod catalogue;
mod mutants;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Allowed imports between rooms, as in `src/README.md`. A room may always import from itself, and from `error`, `choice`
/// and `system`.
const ARROWS: &[(&str, &[&str])] = &[
    ("system", &[]),
    ("math", &[]),
    ("simd", &["math"]),
    ("geometry", &["simd", "math"]),
    ("optics", &["simd", "math"]),
    ("accel", &["geometry", "simd", "math"]),
    ("measure", &["accel", "simd", "math"]),
    ("scene", &["geometry", "math"]),
    ("effects", &["scene", "optics", "geometry"]),
    ("image", &[]),
    ("load", &["scene", "geometry", "image", "optics", "math"]),
    ("render", &["effects", "scene", "optics", "accel", "geometry", "simd", "math", "image"]),
    ("notices", &["load", "render", "effects", "scene", "accel", "geometry"]),
    ("trial", &["render", "effects", "scene", "optics", "accel", "geometry", "simd", "math", "image", "measure"]),
    ("study", &["measure", "load", "render", "scene", "optics", "accel", "geometry", "simd", "math", "image"]),
    (
        "cli",
        &[
            "study", "trial", "measure", "notices", "load", "render", "effects", "accel", "image", "scene", "optics",
            "simd", "math",
        ],
    ),
];

fn rust_files(dir: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(dir).expect("src can be read") {
        let path = entry.expect("src can be listed").path();
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Rooms named after `crate::` in the code (not the comments) of one file, unit tests left out.
fn imports(text: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    code.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| line.split("crate::").skip(1))
        .flat_map(|rest| {
            // `crate::{a::B, c::D}` names a room at its start and after each comma.
            let list = rest.strip_prefix('{').map_or(vec![rest], |inner| inner.split(", ").collect());
            list.into_iter().map(leading_name).collect::<Vec<_>>()
        })
        .filter(|name| name.starts_with(char::is_lowercase))
        .collect()
}

fn leading_name(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

#[test]
fn rooms_import_only_from_rooms_below() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let mut wrong = Vec::new();
    for file in &files {
        let inside = file.strip_prefix(&src).expect("file lies in src");
        let room = inside.components().next().expect("file has a name").as_os_str().to_string_lossy().into_owned();
        if room.ends_with(".rs") {
            continue;
        }
        let Some((_, below)) = ARROWS.iter().find(|(name, _)| *name == room) else {
            wrong.push(format!("{}: room {room} is not in the list of arrows", inside.display()));
            continue;
        };
        for name in imports(&std::fs::read_to_string(file).expect("source can be read")) {
            if name != room
                && name != "error"
                && name != "choice"
                && name != "system"
                && !below.contains(&name.as_str())
            {
                wrong.push(format!("{} imports {name}", inside.display()));
            }
        }
    }
    assert!(files.len() > 30, "found {} files only", files.len());
    assert!(wrong.is_empty(), "arrows that go up or sideways:\n{}", wrong.join("\n"));
}

#[test]
fn the_list_of_arrows_has_no_cycle() {
    // A room is listed after every room that it may import.
    for (i, (room, below)) in ARROWS.iter().enumerate() {
        for name in *below {
            assert!(ARROWS[..i].iter().any(|(earlier, _)| earlier == name), "{room} may import {name}, listed later");
        }
    }
}

/// Cargo builds only the binaries that `Cargo.toml` names, so a file that no module list names would never run.
#[test]
fn every_test_file_belongs_to_a_binary() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let read = |file: &Path| std::fs::read_to_string(file).unwrap_or_default();
    let manifest = read(&tests.with_file_name("Cargo.toml"));
    let mut declared = String::new();
    let mut files = Vec::new();
    for entry in std::fs::read_dir(&tests).expect("tests can be read") {
        let path = entry.expect("tests can be listed").path();
        let root = format!("path = \"tests/{}\"", path.file_name().expect("a name").to_string_lossy());
        if manifest.contains(&root) {
            declared += &read(&path);
        } else if path.extension().is_some_and(|e| e == "rs") || path.join("mod.rs").exists() {
            files.push(path);
        }
    }
    assert!(files.len() > 30, "found {} only", files.len());
    for path in files {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        assert!(
            declared.lines().any(|l| l == format!("mod {name};")),
            "no binary has tests/{name}: see tests/README.md"
        );
        let Ok(folder) = std::fs::read_dir(&path) else { continue };
        let list = read(&path.join("mod.rs"));
        for inner in folder.map(|entry| entry.expect("tests can be listed").path()) {
            let inner = inner.file_stem().expect("a name").to_string_lossy().into_owned();
            let there = list.lines().any(|l| l.trim_start_matches("pub ") == format!("mod {inner};"));
            assert!(inner == "mod" || there, "tests/{name}/mod.rs does not declare {inner}");
        }
    }
}

/// Everything else names [`Backend`](vitrum::accel::Backend)s, which exist in every build.
#[test]
fn one_line_outside_the_room_of_embree_depends_on_its_feature() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let lines: Vec<String> = files
        .iter()
        .filter(|file| !file.starts_with(src.join("accel/embree")))
        .flat_map(|file| {
            let text = std::fs::read_to_string(file).expect("source can be read");
            let name = file.strip_prefix(&src).expect("file lies in src").display().to_string();
            let found = text.matches("feature = \"embree\"").count();
            std::iter::repeat_n(name, found).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(lines, ["accel/mod.rs"]);
}
