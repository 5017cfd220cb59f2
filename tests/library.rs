//! The crate as a library: scenes put together by code, errors instead of panics, and the programs of `examples/`.

#[path = "../examples/depth_and_normals.rs"]
#[expect(dead_code, reason = "its `main` reads the command line")]
mod depth_and_normals;
#[path = "../examples/render_scene.rs"]
#[expect(dead_code, reason = "its `main` reads the command line")]
mod render_scene;
#[path = "../examples/trace_mesh.rs"]
#[expect(dead_code, reason = "its `main` prints")]
mod trace_mesh;

use std::path::Path;

use glam::Vec3;
use vitrum::geometry::{GeometryMask, Plane, Ray, Sphere, TriMesh};
use vitrum::image::{ReadOptions, read};
use vitrum::load::{self, LoadOptions};
use vitrum::render::Lens;
use vitrum::scene::{
    Camera, Colour, Environment, Falloff, Interface, Light, LightKind, Material, Medium, Part, Rgb, Scene, SceneError,
    Texture,
};

/// By hand: a torus of radii 1 and 0.4 seen from above along y, 1.5 units to each side of the middle.
#[test]
fn the_first_example_shows_a_torus_with_its_hole() {
    let rows = trace_mesh::picture(60, 60).unwrap();
    let at = |x: f32, z: f32| {
        let place = |v: f32| ((v + 1.5) / 3.0 * 60.0) as usize;
        rows[place(z)].as_bytes()[place(x)]
    };
    assert_eq!([at(0.0, 0.0), at(0.5, 0.0), at(1.45, 0.0), at(1.45, 1.45)], [b' '; 4]);
    assert_eq!([at(1.0, 0.0), at(-1.0, 0.0), at(0.0, 1.0), at(0.0, -1.0)], [b'#'; 4]);
    assert!(at(1.36, 0.0) != b'#' && at(1.36, 0.0) != b' ', "the rim is lower than the top");
}

#[test]
fn the_second_example_renders_what_its_scene_says() {
    let film = render_scene::picture(40, 30).unwrap();
    // The sky above the ball is bare.
    assert_eq!(film.at(0, 0), [0.4, 0.5, 0.7]);
    assert!(film.pixels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
    let (middle, floor) = (film.at(20, 15), film.at(2, 28));
    assert!(middle != [0.4, 0.5, 0.7] && floor != middle, "{middle:?} {floor:?}");
}

#[test]
fn the_third_example_writes_guides_that_fit_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let scene = render_scene::scene(40, 30).unwrap();
    depth_and_normals::write(&scene, folder.path()).unwrap();
    let [depth, normal, object] = ["depth", "normal", "object"]
        .map(|name| read(&folder.path().join(name).with_extension("pfm"), &ReadOptions::default()).unwrap().film);
    let lens = Lens::new(&scene.camera, 40, 30);
    let mut seen = [0; 3];
    for y in 0..30 {
        for x in 0..40 {
            let ray: Ray = lens.ray(x as f32 + 0.5, y as f32 + 0.5);
            let (t, n) = (depth.at(x, y)[0], Vec3::from(normal.at(x, y)));
            let point = ray.origin + ray.dir * t;
            match object.at(x, y)[0] {
                0.0 => assert!(t.is_infinite() && n == Vec3::ZERO),
                1.0 => assert!(point.y.abs() < 1e-4 && n == Vec3::Y, "{point}"),
                2.0 => assert!((point - Vec3::new(0.0, 0.75, 0.0)).distance(n * 0.7) < 1e-5, "{point} {n}"),
                other => panic!("object {other}"),
            }
            seen[object.at(x, y)[0] as usize] += 1;
        }
    }
    assert!(seen.iter().all(|&n| n > 100), "{seen:?}");
}

#[test]
fn every_bundled_scene_is_valid() {
    let mut count = 0;
    for folder in ["scenes", "scenes/hard", "tests/reference", "tests/data"] {
        for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") && !path.ends_with("sweep-1m.toml") {
                let scene = load::scene(&path, &LoadOptions::default()).unwrap().scene;
                assert_eq!(scene.validate(), Ok(()), "{}", path.display());
                count += 1;
            }
        }
    }
    assert!(count > 30, "{count}");
}

/// A valid scene with something of every kind.
fn sound() -> Scene {
    let mut scene = Scene::default();
    let texture = scene.add_texture(Texture::new("t", 2, 1, vec![Rgb::ONE; 2]));
    let glass = scene.add_dielectric(Medium::new("glass", 1.5));
    let papered =
        Material { diffuse: Colour::Image { texture, scale: Rgb::ONE }, name: "paper".into(), ..Material::default() };
    let paper = scene.add_material(papered);
    scene.add_object("ball", Sphere { centre: Vec3::ZERO, radius: 1.0 }, glass);
    scene.add_object("floor", Plane { point: Vec3::NEG_Y, normal: Vec3::Y }, paper);
    scene.add_object("leaf", TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]), paper);
    scene.environment = Environment::LatLong { texture, scale: Rgb::ONE, rotation: 0.0 };
    let kind = LightKind::Point { position: Vec3::Y };
    let falloff = Falloff::InverseSquare;
    scene.add_light(Light { name: "lamp".into(), kind, intensity: Rgb::ONE, falloff, shadows: true });
    assert_eq!(scene.validate(), Ok(()));
    scene
}

/// The one rule that a scene breaks, as text.
fn only(break_it: impl FnOnce(&mut Scene)) -> (SceneError, String) {
    let mut scene = sound();
    break_it(&mut scene);
    let mut errors = scene.errors();
    assert_eq!(errors.len(), 1, "{errors:?}");
    let error = errors.remove(0);
    let text = error.to_string();
    (error, text)
}

#[test]
fn indices_beyond_their_lists_name_the_entry_and_the_list() {
    let (error, text) = only(|s| s.objects[1].material = 7);
    let SceneError::Index { place, index: 7, len: 2, .. } = error else { panic!("{error:?}") };
    assert_eq!((place.part, place.index, place.name.as_str()), (Part::Object, 1, "floor"));
    assert!(text.starts_with("object 1 (`floor`): material is 7, but the list has 2 entries"), "{text}");
    only(|s| s.materials[0].interface = Interface::dielectric(2));
    only(|s| s.materials[1].diffuse = Colour::Image { texture: 1, scale: Rgb::ONE });
    only(|s| s.environment = Environment::LatLong { texture: 9, scale: Rgb::ONE, rotation: 0.0 });
    only(|s| s.camera.medium = Some(2));
    let corner =
        |index| move |s: &mut Scene| s.geometry[2].shape = TriMesh::new(vec![Vec3::X; 3], vec![[0, 1, index]]).into();
    let (error, _) = only(corner(3));
    assert!(matches!(error, SceneError::Index { index: 3, len: 3, .. }), "{error:?}");
}

#[test]
fn lists_that_do_not_fit_each_other_are_told() {
    assert!(matches!(only(|s| _ = s.objects.pop()).0, SceneError::Unpaired { shapes: 3, objects: 2 }));
    assert!(matches!(
        only(|s| s.textures[0].pixels = vec![Rgb::ONE].into()).0,
        SceneError::Length { len: 1, wanted: 2, .. }
    ));
    let mut scene = Scene::default();
    scene.media.clear();
    assert_eq!(scene.validate(), Err(SceneError::NoMedium));
    let (error, text) = only(|s| s.geometry[0].mask = GeometryMask::OPAQUE);
    assert!(matches!(error, SceneError::Mask { .. }) && text.contains("Material::mask()"), "{text}");
}

#[test]
fn values_out_of_range_name_field_value_and_range() {
    let (_, text) = only(|s| s.media[1].ior = 0.0);
    assert_eq!(text, "medium 1 (`glass`): ior is 0; it must be between 0.001 and 1000");
    let (_, text) = only(|s| s.camera.target = s.camera.eye);
    assert!(text.starts_with("the camera: target is [0, 1, 5]; it must be another point than the eye"), "{text}");
    only(|s| s.camera.up = s.camera.target - s.camera.eye);
    only(|s| s.camera = Camera { eye: Vec3::NAN, ..Camera::default() });
    only(|s| s.settings.width = 0);
    only(|s| s.settings.samples = 0);
    only(|s| s.settings.cutoff = f32::NAN);
    only(|s| s.lights[0].intensity = Rgb::new(1.0, -1.0, 1.0));
    only(|s| s.lights[0].kind = LightKind::Directional { direction: Vec3::ZERO });
    only(|s| s.geometry[0].shape = Sphere { centre: Vec3::ZERO, radius: -1.0 }.into());
    only(|s| s.geometry[1].shape = Plane { point: Vec3::ZERO, normal: Vec3::splat(1.0) }.into());
    only(|s| s.materials[1].emission = Rgb::splat(f32::INFINITY));
}
