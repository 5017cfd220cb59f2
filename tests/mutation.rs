//! Files with something broken in them, by the thousand and the same every time: no panic, one line for an error, and
//! whatever is accepted is a sound scene.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use vitrum::geometry::Shape;
use vitrum::load::{self, Limits, LoadOptions};
use vitrum::scene::{Colour, Environment, Interface, Scene};

/// Small numbers from one seed (Marsaglia 2003, xorshift64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % n.max(1)
    }
}

/// Words that parsers trip over.
const WORDS: [&str; 30] = [
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1",
    "0",
    "-0.0",
    "1e-45",
    "3.5e38",
    "99999999999999999999",
    "-9223372036854775808",
    "4294967295",
    "1//",
    "/",
    "1/2/3/4",
    "\\",
    "\r",
    "\n",
    "\u{feff}",
    "é",
    "\0",
    "#",
    "[",
    "]]",
    "{",
    "=",
    "'",
    "\"\"\"",
    "../../../etc/passwd",
    "usemtl",
];

/// One change to a file: a flipped bit, a byte out or in, a word for another, two words swapped, a line twice.
fn mutated(seed: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(7) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            1 if !bytes.is_empty() => drop(bytes.remove(at)),
            2 => bytes.insert(at, random.below(256) as u8),
            3 | 4 => {
                let (start, end) = word_at(&bytes, at);
                bytes.splice(start..end, WORDS[random.below(WORDS.len())].bytes());
            }
            5 => {
                let (a, b) = (word_at(&bytes, at), word_at(&bytes, random.below(bytes.len())));
                let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
                if a.1 <= b.0 {
                    let (first, second) = (bytes[a.0..a.1].to_vec(), bytes[b.0..b.1].to_vec());
                    bytes.splice(b.0..b.1, first);
                    bytes.splice(a.0..a.1, second);
                }
            }
            _ => {
                let start = bytes[..at].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
                let end = bytes[at..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |i| at + i + 1);
                let line = bytes[start..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, line);
            }
        }
    }
    bytes
}

/// The word around a byte.
fn word_at(bytes: &[u8], at: usize) -> (usize, usize) {
    let breaks = |b: &u8| b.is_ascii_whitespace() || matches!(b, b'/' | b',' | b'=' | b'[' | b']');
    let start = bytes[..at].iter().rposition(breaks).map_or(0, |i| i + 1);
    let end = bytes[at..].iter().position(breaks).map_or(bytes.len(), |i| at + i);
    (start, end)
}

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

/// Runs `load` on the seed cut off at every byte and on `count` mutants of it, written over `target`.
fn attack(target: &Path, count: usize, mut load: impl FnMut() -> vitrum::Result<Option<Scene>>) {
    let seed = fs::read(target).unwrap();
    let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ seed.len() as u64);
    let mut accepted = 0;
    let step = seed.len().div_ceil(4000).max(1);
    let cuts = (0..=seed.len()).step_by(step).map(|n| seed[..n].to_vec()).collect::<Vec<_>>();
    let mutants = (0..count).map(|_| mutated(&seed, &mut random));
    for bytes in cuts.into_iter().chain(mutants) {
        // Some file systems wait for the disk when a file is cut short and written anew; not so for a new one.
        fs::remove_file(target).unwrap();
        fs::write(target, &bytes).unwrap();
        let shown = || String::from_utf8_lossy(&bytes).into_owned();
        match catch_unwind(AssertUnwindSafe(&mut load)) {
            Err(_) => panic!("it panicked on {}", shown()),
            Ok(Err(error)) => {
                let text = error.to_string();
                assert!(!text.contains('\n') && text.len() < 1000, "{text}\nof {}", shown());
                assert!(matches!(error.exit_code(), 2..=4), "{text}");
            }
            Ok(Ok(scene)) => {
                accepted += 1;
                if let Some(scene) = scene {
                    check(&scene, &shown);
                }
            }
        }
    }
    // A harness whose every input is refused at the door tests nothing.
    assert!(accepted > 20, "only {accepted} of {count} were accepted");
}

/// What every loaded scene keeps.
fn check(scene: &Scene, shown: &dyn Fn() -> String) {
    assert_eq!(scene.objects.len(), scene.geometry.len());
    for (object, geometry) in scene.objects.iter().zip(&scene.geometry) {
        assert!((object.material as usize) < scene.materials.len());
        match &geometry.shape {
            Shape::Mesh(mesh) => {
                let count = mesh.triangles.len();
                assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()), "{}", shown());
                assert!(
                    mesh.normal_indices.iter().flatten().all(|&i| (i as usize) < mesh.normals.len()),
                    "{}",
                    shown()
                );
                assert!(mesh.uv_indices.iter().flatten().all(|&i| (i as usize) < mesh.uvs.len()), "{}", shown());
                assert!(mesh.normal_indices.is_empty() || mesh.normal_indices.len() == count, "{}", shown());
                assert!(mesh.uv_indices.is_empty() || mesh.uv_indices.len() == count, "{}", shown());
                let lines = object.origin.triangle_lines.len();
                assert!(lines == 0 || lines == count, "{}", shown());
                assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "{}", shown());
            }
            Shape::Sphere(sphere) => assert!(sphere.centre.is_finite() && sphere.radius > 0.0, "{}", shown()),
            Shape::Plane(plane) => assert!((plane.normal.length() - 1.0).abs() < 1e-3, "{}", shown()),
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
    assert!(scene.media.iter().all(|m| (1e-3..=1e3).contains(&m.ior) && m.absorption.is_finite()), "{}", shown());
    if let Environment::LatLong { texture, .. } = scene.environment {
        assert!((texture as usize) < scene.textures.len());
    }
    assert!(
        scene.textures.iter().all(|t| t.pixels.len() == (t.width * t.height) as usize && t.width > 0 && t.height > 0)
    );
    let camera = &scene.camera;
    let view = (camera.target - camera.eye).as_dvec3();
    assert!(view.is_finite() && view.cross(camera.up.as_dvec3()).length() > 0.0, "{}", shown());
}

/// A folder with the project's small test files in it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")).unwrap() {
        let path = file.unwrap().path();
        if path.is_file() {
            fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    folder
}

fn scene(path: PathBuf) -> impl FnMut() -> vitrum::Result<Option<Scene>> {
    move || load::scene(&path, &options()).map(|l| Some(l.scene))
}

fn picture(path: PathBuf) -> impl FnMut() -> vitrum::Result<Option<Scene>> {
    move || {
        let texture = load::picture(&path, &options())?;
        Ok(Some(Scene { textures: vec![texture], ..Scene::default() }))
    }
}

#[test]
fn broken_scene_files_are_survived() {
    let folder = folder();
    let path = folder.path().join("sampler.toml");
    attack(&path, 3000, scene(path.clone()));
}

#[test]
fn broken_models_are_survived() {
    let folder = folder();
    let path = folder.path().join("house.obj");
    attack(&path, 6000, scene(path.clone()));
}

#[test]
fn broken_materials_are_survived() {
    let folder = folder();
    attack(&folder.path().join("house.mtl"), 6000, scene(folder.path().join("house.obj")));
}

#[test]
fn broken_pictures_are_survived() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let image = image::Rgb32FImage::from_fn(9, 7, |x, y| image::Rgb([x as f32 / 9.0, y as f32 / 7.0, 0.5]));
    image.save(at("a.hdr")).unwrap();
    let bytes = image::DynamicImage::from(image).into_rgb8();
    bytes.save(at("a.png")).unwrap();
    bytes.save(at("a.jpg")).unwrap();
    exr::prelude::write_rgb_file(at("a.exr"), 9, 7, |x, y| (x as f32, y as f32, 0.5f32)).unwrap();
    let mut pfm = b"PF\n3 2\n-1.0\n".to_vec();
    pfm.extend((0..18).flat_map(|i| (i as f32).to_le_bytes()));
    fs::write(at("a.pfm"), pfm).unwrap();
    for (name, count) in [("a.png", 2000), ("a.jpg", 2000), ("a.hdr", 2000), ("a.exr", 2000), ("a.pfm", 2000)] {
        attack(&at(name), count, picture(at(name)));
    }
}
