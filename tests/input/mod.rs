//! Odd and hostile input: every file gets a scene with counted warnings, or one line that names file, line and value.

mod alone;
mod files;
mod material;
mod model;
mod picture;
mod scene;

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use vitrum::Error;
use vitrum::geometry::{GeometryMask, Shape, TriMesh};
use vitrum::load::{self, LoadOptions, Loaded};
use vitrum::scene::{Colour, Dispersion, FresnelRule, Interface, LampSampling, LightKind, MirrorSource, Pattern, Rgb};

/// A folder with files to load.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        fs::write(self.path(name), content).unwrap();
        self
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, name: &str) -> vitrum::Result<Loaded> {
        load::scene(&self.path(name), &LoadOptions::default())
    }

    fn strict(&self, name: &str) -> vitrum::Result<Loaded> {
        load::scene(&self.path(name), &LoadOptions { strict: true, ..LoadOptions::default() })
    }
}

fn obj(text: impl AsRef<[u8]>) -> vitrum::Result<Loaded> {
    Folder::new().with("a.obj", text).load("a.obj")
}

/// One triangle of a material.
fn mtl(text: &str) -> vitrum::Result<Loaded> {
    let model = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    Folder::new().with("a.obj", model).with("a.mtl", text).load("a.obj")
}

fn toml(text: &str) -> vitrum::Result<Loaded> {
    Folder::new().with("a.toml", text).load("a.toml")
}

fn mesh(loaded: &Loaded, i: usize) -> &TriMesh {
    match &loaded.scene.geometry[i].shape {
        Shape::Mesh(mesh) => mesh,
        other => panic!("{other:?} is no mesh"),
    }
}

fn triangles(loaded: &Loaded) -> usize {
    (0..loaded.scene.geometry.len()).map(|i| mesh(loaded, i).triangles.len()).sum()
}

/// The error's one line, after checking its exit code, its place and that it holds every part.
#[track_caller]
fn refused(result: vitrum::Result<Loaded>, code: u8, parts: &[&str]) -> String {
    let error = result.expect_err("it was accepted");
    let text = error.to_string();
    assert_eq!(error.exit_code(), code, "{text}");
    assert!(!text.contains('\n'), "more than one line: {text}");
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in: {text}");
    }
    text
}

/// The scene, after checking that a warning holds every part.
#[track_caller]
fn warned(result: vitrum::Result<Loaded>, parts: &[&str]) -> Loaded {
    let loaded = result.unwrap();
    let all: Vec<String> = loaded.report.warnings.iter().map(ToString::to_string).collect();
    assert!(all.iter().any(|w| parts.iter().all(|p| w.contains(p))), "{parts:?} is in none of {all:#?}");
    loaded
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
