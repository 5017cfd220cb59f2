//! A model by itself: the options of its scene, and that scene as a file. Materials that a scene replaces, folders that it
//! allows, and colours in words.

use glam::{DVec3, Vec3};
use vitrum::load::{ModelLight, ModelOptions, Surface, Up};
use vitrum::scene::{Environment, Scene};

use super::*;

/// Two faces, of the materials `body` and `lid`, with z up.
fn jar() -> Folder {
    let model =
        "mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 3\nusemtl body\nf 1 2 3\nusemtl lid\nf 1 2 4\nf 2 3 4\n";
    Folder::new().with("a.obj", model).with("a.mtl", "newmtl body\nKd 1 0 0\nnewmtl lid\nKd 0 1 0\n")
}

fn load_with(folder: &Folder, model: ModelOptions) -> vitrum::Result<Loaded> {
    load::scene(&folder.path("a.obj"), &LoadOptions { model, ..LoadOptions::default() })
}

fn surface(text: &str) -> Surface {
    text.parse().unwrap()
}

/// Everything that a picture depends on, but for names of files.
fn told(scene: &Scene) -> String {
    let names: Vec<_> = scene.objects.iter().map(|o| (&o.name, o.material)).collect();
    let used: Vec<_> = scene.objects.iter().map(|o| &scene.materials[o.material as usize]).collect();
    let media: Vec<_> = scene.media.iter().map(|m| (m.ior, m.priority)).collect();
    let Scene { camera, lights, environment, settings, origin, geometry, .. } = scene;
    format!("{names:?} {used:?} {media:?} {camera:?} {lights:?} {environment:?} {settings:?} {origin} {geometry:?}")
}

#[test]
fn the_scene_file_of_a_model_is_the_scene_of_the_model() {
    let folder = jar();
    let options = [
        ModelOptions::default(),
        ModelOptions {
            up: Up::Z,
            smooth: Some(80.0),
            materials: vec![("body".into(), surface("glass:bk7")), ("Lid".into(), surface("diffuse:#c02020"))],
            background: Some(Rgb::new(0.1, 0.2, 0.3)),
            lights: vec![ModelLight { position: DVec3::new(3.0, 4.0, 5.1), intensity: 0.7 }],
            ..ModelOptions::default()
        },
        ModelOptions {
            eye: Some(DVec3::new(3.0, 0.1, 7.0)),
            target: Some(DVec3::new(0.3, 0.2, 0.1)),
            fov: Some(33.3),
            materials: vec![("*".into(), surface("metal:gold"))],
            ..ModelOptions::default()
        },
    ];
    for model in options {
        let bare = load_with(&folder, model.clone()).unwrap().scene;
        let options = LoadOptions { model: model.clone(), ..LoadOptions::default() };
        let here = folder.path("");
        let (text, _) = load::sketch(&folder.path("a.obj"), &here, &options).unwrap();
        fs::write(folder.path("a.toml"), &text).unwrap();
        let scene = folder.load("a.toml").unwrap().scene;
        assert_eq!(told(&scene), told(&bare), "{model:?}\n{text}");
        // From another folder the file names the model's own.
        let other = Folder::new();
        let (text, _) = load::sketch(&folder.path("a.obj"), &other.path(""), &options).unwrap();
        assert_eq!(told(&other.with("b.toml", text).load("b.toml").unwrap().scene), told(&bare));
    }
}

#[test]
fn options_of_a_model_place_its_camera_lights_surroundings_and_materials() {
    let folder = jar();
    let up = load_with(&folder, ModelOptions { up: Up::Z, ..ModelOptions::default() }).unwrap();
    assert!(
        up.scene.geometry.iter().enumerate().any(
            |(i, _)| mesh(&up, i).positions.contains(&Vec3::Y) || mesh(&up, i).positions.contains(&(Vec3::Y * 3.0))
        )
    );
    let eye = DVec3::new(1.0, 2.0, 9.0);
    let of = load_with(&folder, ModelOptions { eye: Some(eye), fov: Some(20.0), ..ModelOptions::default() }).unwrap();
    assert_eq!(of.scene.camera.eye, eye.as_vec3());
    let dark = ModelOptions { background: Some(Rgb::ZERO), ..ModelOptions::default() };
    assert_eq!(load_with(&folder, dark).unwrap().scene.environment, Environment::Constant(Rgb::ZERO));
    let glass = ModelOptions { materials: vec![("LID".into(), surface("glass:1.6"))], ..ModelOptions::default() };
    let loaded = load_with(&folder, glass).unwrap();
    let kinds: Vec<bool> = loaded
        .scene
        .objects
        .iter()
        .map(|o| matches!(loaded.scene.materials[o.material as usize].interface, Interface::Dielectric { .. }))
        .collect();
    assert_eq!(kinds, [false, true]);
    let unknown = ModelOptions { materials: vec![("cork".into(), surface("mirror"))], ..ModelOptions::default() };
    refused(load_with(&folder, unknown), 2, &["--material", "`cork`", "`body`, `lid`"]);
    let blind = ModelOptions { eye: Some(eye), target: Some(eye), ..ModelOptions::default() };
    refused(load_with(&folder, blind), 2, &["--eye", "--target"]);
}

#[test]
fn a_scene_replaces_one_material_of_a_model_and_the_others_stay() {
    let scene = "[[material]]\nname = 'gold'\ntype = 'conductor'\nmetal = 'gold'\n\
                 [[mesh]]\nfile = 'a.obj'\nmaterials = { lid = 'gold' }\n";
    let loaded = jar().with("a.toml", scene).load("a.toml").unwrap();
    let names: Vec<&str> =
        loaded.scene.objects.iter().map(|o| loaded.scene.materials[o.material as usize].name.as_str()).collect();
    assert_eq!(names, ["body", "gold"]);
    let wrong = scene.replace("lid =", "cork =");
    refused(jar().with("a.toml", wrong).load("a.toml"), 2, &["a.toml:7:", "`cork`", "`body`, `lid`"]);
    let both = scene.replace("materials =", "material = 'gold'\nmaterials =");
    refused(jar().with("a.toml", both).load("a.toml"), 2, &["a.toml:8:", "`material`", "not both"]);
    let unknown = scene.replace("= 'gold' }", "= 'silver' }");
    refused(jar().with("a.toml", unknown).load("a.toml"), 2, &["a.toml:7:", "`silver`"]);
}

#[test]
fn a_scene_names_folders_whose_files_it_may_read() {
    let outside = jar();
    let folder = outside.path("");
    let mesh = format!("[[mesh]]\nfile = '{}'\n", outside.path("a.obj").display());
    refused(Folder::new().with("s.toml", &mesh).load("s.toml"), 2, &["s.toml:2:", "outside", "[files] roots"]);
    let allowed = format!("[files]\nroots = ['{}']\n{mesh}", folder.display());
    assert_eq!(Folder::new().with("s.toml", allowed).load("s.toml").unwrap().scene.objects.len(), 2);
    refused(toml("[files]\nroots = ['nowhere']\n"), 2, &["a.toml:2:", "nowhere"]);
}

#[test]
fn colours_of_a_scene_may_be_codes_in_quotes() {
    let of = |color: &str| toml(&format!("[[material]]\nname = 'a'\ntype = 'diffuse'\ncolor = {color}\n"));
    assert_eq!(of("'#ff0000'").unwrap().scene.materials[0].diffuse, Colour::Constant(Rgb::X));
    refused(of("'#ff00'"), 2, &["a.toml:4:", "`color`", "#rrggbb"]);
    refused(of("'red'"), 2, &["a.toml:4:", "`red`", "#rrggbb"]);
}

#[test]
fn cylinders_cones_and_capsules_stand_where_they_are_put() {
    for (shape, low, high) in [("cylinder", 1.0, 4.0), ("cone", 1.0, 4.0), ("capsule", 0.5, 4.5)] {
        let scene = format!(
            "[[material]]\nname = 'm'\ntype = 'diffuse'\n[[mesh]]\nshape = '{shape}'\nmaterial = 'm'\nradius = 0.5\n\
             height = 3\ncenter = [1, 2.5, 0]\n"
        );
        let loaded = toml(&scene).unwrap();
        let bounds = mesh(&loaded, 0).bounds();
        assert!((bounds.lo - Vec3::new(0.5, low, -0.5)).length() < 1e-5, "{shape}: {bounds:?}");
        assert!((bounds.hi - Vec3::new(1.5, high, 0.5)).length() < 1e-5, "{shape}: {bounds:?}");
    }
}
