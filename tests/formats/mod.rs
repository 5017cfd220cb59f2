//! Models in formats other than OBJ, from files that the tests write themselves.

mod attenuation;
mod gltf;
mod ply;
mod stl;

use std::path::PathBuf;

use glam::Vec3;
use tempfile::TempDir;
use vitrum::geometry::{Shape, TriMesh};
use vitrum::load::{self, LoadOptions, Loaded};

/// Folder with files to load.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        std::fs::write(self.path(name), content).unwrap();
        self
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, name: &str) -> vitrum::Result<Loaded> {
        load::scene(&self.path(name), &LoadOptions::default())
    }
}

fn load_as(name: &str, content: impl AsRef<[u8]>) -> vitrum::Result<Loaded> {
    Folder::new().with(name, content).load(name)
}

fn mesh(loaded: &Loaded, i: usize) -> &TriMesh {
    match &loaded.scene.geometry[i].shape {
        Shape::Mesh(mesh) => mesh,
        other => panic!("{other:?} is no mesh"),
    }
}

/// Corners of all triangles of a mesh.
fn corners(mesh: &TriMesh) -> Vec<[Vec3; 3]> {
    (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect()
}

fn warnings(loaded: &Loaded) -> Vec<String> {
    loaded.report.warnings.iter().map(ToString::to_string).collect()
}

#[track_caller]
fn warns(loaded: &Loaded, part: &str) {
    assert!(warnings(loaded).iter().any(|w| w.contains(part)), "`{part}` is in none of {:#?}", warnings(loaded));
}

#[track_caller]
fn refused(result: vitrum::Result<Loaded>, part: &str) {
    let text = result.expect_err("it was accepted").to_string();
    assert!(text.contains(part) && !text.contains('\n'), "`{part}` is not in one line: {text}");
}
