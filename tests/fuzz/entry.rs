//! Entry points for arbitrary bytes, with the properties that must always hold: no panic, and either an error of one
//! line with an exit code, or a valid scene. Shared by `tests/mutation.rs` (stable Rust) and the targets beside this
//! file (libFuzzer).

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use glam::Vec3;
use tempfile::TempDir;
use vitrum::geometry::Shape;
use vitrum::load::{self, Limits, LoadOptions};
use vitrum::scene::{Colour, Environment, Interface, Scene};

/// The files that are read from strangers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A scene in TOML, with the project's small model beside it.
    Scene,
    /// A model in OBJ, with its materials beside it.
    Model,
    /// A model in glTF, as text or binary.
    Gltf,
    /// A model in PLY.
    Ply,
    /// A model in STL.
    Stl,
    /// Materials in MTL, with the model that names them beside them.
    Material,
    /// A picture of any kind, told by its first bytes.
    Picture,
}

impl Kind {
    /// The name the bytes are put under.
    fn file(self) -> &'static str {
        match self {
            Self::Scene => "sampler.toml",
            Self::Model => "house.obj",
            Self::Gltf => "model.gltf",
            Self::Ply => "model.ply",
            Self::Stl => "model.stl",
            Self::Material => "house.mtl",
            Self::Picture => "checks.pfm",
        }
    }
}

/// A folder with the project's small test files in it, in memory where the system has such a place.
pub fn folder() -> TempDir {
    let memory = Path::new("/dev/shm");
    let folder = tempfile::Builder::new().prefix("vitrum-fuzz-").tempdir_in(memory).or_else(|_| tempfile::tempdir());
    let folder = folder.expect("a folder for the files that are made up");
    for file in fs::read_dir(data()).expect("tests/data is there") {
        let path = file.expect("tests/data can be listed").path();
        if path.is_file() {
            fs::copy(&path, folder.path().join(path.file_name().expect("a file has a name")))
                .expect("files can be copied");
        }
    }
    folder
}

/// `tests/data`, from the package of the tests and from that of the targets.
pub fn data() -> &'static Path {
    let here = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data"));
    if here.is_dir() { here } else { Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../data")) }
}

thread_local! {
    static FOLDER: OnceCell<TempDir> = const { OnceCell::new() };
}

/// Limits small enough that no input of a few kilobytes can ask for much.
fn options() -> LoadOptions {
    let limits = Limits {
        file_bytes: 1 << 20,
        triangles: 20_000,
        texture_bytes: 1 << 20,
        film_pixels: 1 << 20,
        ..Limits::default()
    };
    LoadOptions { limits, ..LoadOptions::default() }
}

/// Loads the bytes as a file of their kind; whether they were accepted.
///
/// # Panics
/// Where something does not hold that must.
pub fn load(kind: Kind, bytes: &[u8]) -> bool {
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(self::folder).path();
        let path = folder.join(kind.file());
        // Some file systems wait for the disk when a file is cut short and written anew; not so for a new one.
        let _ = fs::remove_file(&path);
        fs::write(&path, bytes).expect("files can be written");
        let loaded = match kind {
            Kind::Scene | Kind::Model | Kind::Gltf | Kind::Ply | Kind::Stl => {
                load::scene(&path, &options()).map(|l| l.scene)
            }
            Kind::Material => load::scene(&folder.join(Kind::Model.file()), &options()).map(|l| l.scene),
            Kind::Picture => load::picture(&path, &options()).map(|t| Scene { textures: vec![t], ..Scene::default() }),
        };
        match &loaded {
            Ok(scene) => check(scene),
            Err(error) => {
                let text = error.to_string();
                assert!(!text.contains('\n') && text.len() < 1000, "{text}");
                assert!(matches!(error.exit_code(), 2..=4), "{text}");
            }
        }
        loaded.is_ok()
    })
}

/// Checks the invariants of a loaded scene.
fn check(scene: &Scene) {
    assert_eq!(scene.objects.len(), scene.geometry.len());
    for (object, geometry) in scene.objects.iter().zip(&scene.geometry) {
        assert!((object.material as usize) < scene.materials.len());
        match &geometry.shape {
            Shape::Mesh(mesh) => {
                let count = mesh.triangles.len();
                assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
                assert!(mesh.normal_indices.iter().flatten().all(|&i| (i as usize) < mesh.normals.len()));
                assert!(mesh.uv_indices.iter().flatten().all(|&i| (i as usize) < mesh.uvs.len()));
                assert!(mesh.normal_indices.is_empty() || mesh.normal_indices.len() == count);
                assert!(mesh.uv_indices.is_empty() || mesh.uv_indices.len() == count);
                let lines = object.origin.triangle_lines.len();
                assert!(lines == 0 || lines == count);
                assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3));
            }
            Shape::Sphere(sphere) => assert!(sphere.centre.is_finite() && sphere.radius > 0.0),
            Shape::Plane(plane) => assert!((plane.normal.length() - 1.0).abs() < 1e-3),
        }
    }
    for material in &scene.materials {
        if let Colour::Image { texture, .. } = material.diffuse {
            assert!((texture as usize) < scene.textures.len());
        }
        if let Interface::Dielectric { medium, .. } = material.interface {
            assert!((medium as usize) < scene.media.len());
        }
    }
    assert!(scene.media.iter().all(|m| (1e-3..=1e3).contains(&m.ior) && m.absorption.is_finite()));
    if let Environment::LatLong { texture, .. } = scene.environment {
        assert!((texture as usize) < scene.textures.len());
    }
    assert!(
        scene.textures.iter().all(|t| t.pixels.len() == (t.width * t.height) as usize && t.width > 0 && t.height > 0)
    );
    let camera = &scene.camera;
    let view = (camera.target - camera.eye).as_dvec3();
    assert!(view.is_finite() && view.cross(camera.up.as_dvec3()).length() > 0.0);
    let light = scene.lights.iter().map(|l| l.intensity).chain([scene.ambient]);
    assert!(light.into_iter().all(Vec3::is_finite));
}

/// Seeds of a kind: what `tests/data` has of it, by name; pictures by the names they would have.
pub fn seeds(kind: Kind) -> BTreeMap<String, Vec<u8>> {
    let ends = match kind {
        Kind::Scene => ".toml",
        Kind::Model => ".obj",
        Kind::Gltf => ".gltf",
        Kind::Ply => ".ply",
        Kind::Stl => ".stl",
        Kind::Material => ".mtl",
        Kind::Picture => ".pfm",
    };
    let files = fs::read_dir(data()).expect("tests/data is there").map(|e| e.expect("tests/data can be listed").path());
    files
        .filter(|path| path.to_string_lossy().ends_with(ends))
        .map(|path| (path.display().to_string(), fs::read(&path).expect("seeds can be read")))
        .collect()
}
