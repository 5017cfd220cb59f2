//! Places far from the world's origin, and models of any size, look as they do near it and at size 1: all that counts is the
//! digits that a file gives.

use crate::support;

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use assert_cmd::Command;
use glam::DVec3;
use support::Rng;
use support::scenes::native;
use tempfile::TempDir;
use vitrum::geometry::Shape;
use vitrum::image::Film;
use vitrum::load::{self, LoadOptions, Loaded};
use vitrum::render::{Observer, Options, reference};
use vitrum::scene::{Colour, Scene};

/// By how much a channel may differ and still be the same.
const SAME: f32 = 2e-3;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("there is room"))
    }

    fn with(self, name: &str, text: &str) -> Self {
        fs::write(self.path(name), text).expect("there is room");
        self
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, name: &str) -> Loaded {
        load::scene(&self.path(name), &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
    }
}

/// An offset in millionths, which is added to places as text has them: nothing is rounded.
#[derive(Clone, Copy, Debug)]
struct Offset([i64; 3]);

/// The place of Augsburg on a map of Germany, with y up.
const SURVEY: Offset = Offset([451_234_500_000, 32_000_000, 5_411_234_250_000]);
const NONE: Offset = Offset([0; 3]);

fn decimal(millionths: i64) -> String {
    let (sign, size) = (if millionths < 0 { "-" } else { "" }, millionths.unsigned_abs());
    format!("{sign}{}.{:06}", size / 1_000_000, size % 1_000_000)
}

impl Offset {
    fn numbers(self, place: impl Into<DVec3>) -> [String; 3] {
        let place = place.into().to_array();
        std::array::from_fn(|i| decimal((place[i] * 1e6).round() as i64 + self.0[i]))
    }

    /// A place in a scene file.
    fn toml(self, place: impl Into<DVec3>) -> String {
        format!("[{}]", self.numbers(place).join(", "))
    }

    /// The vertices of a model.
    fn vertices(self, places: &[DVec3]) -> String {
        places.iter().fold(String::new(), |mut text, &p| {
            writeln!(text, "v {}", self.numbers(p).join(" ")).expect("a string grows");
            text
        })
    }

    fn place(self) -> DVec3 {
        DVec3::from(self.0.map(|m| m as f64 * 1e-6))
    }
}

/// A ring of radius 1 about the y axis, 0.3 thick, and its faces.
fn ring() -> (Vec<DVec3>, String) {
    let (around, across) = (40, 20);
    let turn = |i: usize, n: usize| (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
    let corner = |i: usize| {
        let ((s, c), (t, d)) = (turn(i / across, around), turn(i % across, across));
        (DVec3::new(c * (1.0 + 0.3 * d), 0.5 + 0.3 * t, s * (1.0 + 0.3 * d)) * 1e6).round() * 1e-6
    };
    let at = |i: usize, j: usize| i % around * across + j % across + 1;
    let faces = (0..around * across).fold(String::new(), |text, k| {
        let (i, j) = (k / across, k % across);
        text + &format!("f {} {} {} {}\n", at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j))
    });
    ((0..around * across).map(corner).collect(), faces)
}

/// A glass ring over a checker, all of it moved by `offset`; `ring` is what the scene says of the ring's mesh.
fn still_life(offset: Offset, ring: &str) -> String {
    format!(
        "camera = {{ eye = {}, target = {}, fov = 34 }}
         render = {{ width = 64, height = 48, depth = 8 }}
         environment = {{ color = 0.6 }}
         [[material]]
         name = 'glass'
         type = 'dielectric'
         ior = 1.5
         [[material]]
         name = 'floor'
         type = 'diffuse'
         checker = {{ even = 0.9, odd = 0.2, size = 0.5, offset = {} }}
         [[light]]
         type = 'point'
         position = {}
         intensity = 30
         [[mesh]]
         file = 'ring.obj'
         material = 'glass'
         smooth = 60
         {ring}
         [[mesh]]
         shape = 'plane'
         point = {}
         material = 'floor'\n",
        offset.toml([0.0, 2.0, 4.0]),
        offset.toml([0.0, 0.4, 0.0]),
        offset.toml([0.0; 3]),
        offset.toml([1.0, 3.0, 1.5]),
        offset.toml([0.0; 3]),
    )
}

/// The picture by every renderer, with its name.
fn pictures(scene: &Scene) -> Vec<(&'static str, Film)> {
    let options = Options::default();
    let wide = reference::render(scene, &options, &Observer::default()).expect("nobody interrupts a test");
    let mut all = vec![("native", native(scene, &options).film), ("f64", wide.film)];
    if let Some(accel) = support::backends::embree(vitrum::accel::Backend::Embree, &scene.geometry) {
        let picture = vitrum::render::render(scene, &accel, &options, &Observer::default());
        all.push(("embree", picture.expect("nobody interrupts a test").film));
    }
    all
}

/// Pixels that differ.
fn differing(a: &Film, b: &Film) -> usize {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let apart = |(a, b): (&[f32; 3], &[f32; 3])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > SAME * b.abs().max(1.0));
    a.pixels.iter().zip(&b.pixels).filter(|&pair| apart(pair)).count()
}

#[test]
fn a_glass_ring_in_a_survey_looks_as_it_does_at_the_origin() {
    let (corners, faces) = ring();
    let folder = |offset: Offset, corners: &[DVec3], placed: Offset, transform: &str| {
        let model = offset.vertices(corners) + &faces;
        Folder::new().with("ring.obj", &model).with("a.toml", &still_life(placed, transform)).load("a.toml").scene
    };
    let near = folder(NONE, &corners, NONE, "");
    assert_eq!(near.origin, DVec3::ZERO);
    let near = pictures(&near);
    let moved = |sign: f64| format!("transform = {{ translate = {} }}", NONE.toml(SURVEY.place() * sign));
    // Turned about y by -90 degrees and in millimetres: rotate = 90 and scale = 0.001 bring it back.
    let turned: Vec<DVec3> = corners.iter().map(|p| DVec3::new(-p.z, p.y, p.x) * 1e3).collect();
    let far_turned = Offset([-5_411_234_250_000_000, 32_000_000_000, 451_234_500_000_000]);
    for (name, offset, corners, placed, transform) in [
        ("far", SURVEY, &corners, SURVEY, String::new()),
        ("moved there", NONE, &corners, SURVEY, moved(1.0)),
        ("moved back", SURVEY, &corners, NONE, moved(-1.0)),
        ("turned", far_turned, &turned, SURVEY, String::from("transform = { scale = 0.001, rotate = [0, 90, 0] }")),
    ] {
        let scene = folder(offset, corners, placed, &transform);
        assert_eq!(scene.origin == DVec3::ZERO, placed.0 == NONE.0, "{name}: {}", scene.origin);
        for ((renderer, near), (_, far)) in near.iter().zip(pictures(&scene)) {
            let off = differing(near, &far);
            // Edges of facets seen through glass.
            assert!(off <= 12, "{name}, {renderer}: {off} of {} pixels", near.pixels.len());
        }
    }
}

/// A random scene of matt, mirroring and transparent things, with everything that has a place in it.
fn random_scene(seed: u64, offset: Offset) -> String {
    let mut rng = Rng::new(seed);
    let mut number = |lo: f64, hi: f64| ((lo + (hi - lo) * f64::from(rng.unit())) * 1e3).round() * 1e-3;
    let mut text = format!(
        "camera = {{ eye = {}, target = {}, fov = 40 }}
         render = {{ width = 40, height = 30, light_samples = 8 }}
         environment = {{ type = 'gradient', nadir = 0.1, horizon = 0.5, zenith = 0.8, ambient = 0.2 }}\n",
        offset.toml([number(-2.0, 2.0), number(2.0, 4.0), number(5.0, 7.0)]),
        offset.toml([number(-0.5, 0.5), number(0.0, 1.0), 0.0]),
    );
    let materials = ["matt", "cubes", "mirror", "glass", "pane"];
    let _ = write!(
        text,
        "[[material]]
         name = 'matt'
         type = 'diffuse'
         color = [0.7, 0.5, {}]
         ambient = 1
         [[material]]
         name = 'cubes'
         type = 'diffuse'
         checker = {{ even = 0.8, odd = 0.1, size = {}, offset = {} }}
         [[material]]
         name = 'mirror'
         type = 'mirror'
         reflectance = 0.8
         [[material]]
         name = 'glass'
         type = 'dielectric'
         ior = 1.5
         [[material]]
         name = 'pane'
         type = 'thin'
         ior = 1.4\n",
        number(0.2, 0.9),
        number(0.3, 1.1),
        offset.toml([number(0.0, 0.9) + 0.017, number(0.0, 0.9) + 0.013, number(0.0, 0.9) + 0.019]),
    );
    let place =
        |number: &mut dyn FnMut(f64, f64) -> f64| DVec3::new(number(-2.0, 2.0), number(0.2, 2.0), number(-2.0, 1.0));
    let lights = [
        "type = 'point'\nposition = @\nintensity = 20",
        "type = 'spot'\nposition = @\ntarget = #\nintensity = 40\nouter = 60",
        "type = 'sphere'\nposition = @\nradius = 0.3\nintensity = 20",
        "type = 'rectangle'\nposition = @\nedges = [[1, 0, 0], [0, 0.2, 1]]\ntarget = #\nintensity = 20",
        "type = 'directional'\nposition = @\ntarget = #\nintensity = 1",
    ];
    for _ in 0..2 {
        let light = lights[(number(0.0, 4.99)) as usize];
        let from = offset.toml(place(&mut number) + DVec3::Y * 3.0);
        let light = light.replace('@', &from).replace('#', &offset.toml(place(&mut number)));
        let _ = writeln!(text, "[[light]]\n{light}");
    }
    let shapes = [
        "shape = 'box'\ncenter = @\nsize = [0.7, 0.5, 0.9]",
        "shape = 'sphere'\ncenter = @\nradius = 0.5",
        "shape = 'sphere'\ncenter = @\nradius = 0.5\ntessellation = 12",
        "shape = 'disc'\ncenter = @\nradius = 0.8\nnormal = [0.3, 1, 0.2]",
        "shape = 'torus'\nmajor = 0.6\nminor = 0.2\ntransform = { rotate = [$, $, 0], scale = 1.2, translate = @ }",
        "shape = 'lathe'\nprofile = [[0, 0], [0.5, 0], [0.3, 1], [0, 1]]\ntransform = { translate = @ }",
        "file = 'cube.obj'\ntransform = { rotate = [0, $, $], scale = [0.5, 0.7, 0.6], translate = @ }",
        "file = 'cube.obj'\nsmooth = 100\ntransform = { matrix = [1, 0.2, 0, %, 0, 1, 0, %, 0, 0, 1, %, 0, 0, 0, 1] }",
        "file = 'far.obj'",
    ];
    for _ in 0..5 {
        let mut shape = shapes[number(0.0, shapes.len() as f64 - 0.01) as usize].to_owned();
        let at = place(&mut number);
        shape = shape.replace('@', &offset.toml(at));
        for n in offset.numbers(at) {
            shape = shape.replacen('%', &n, 1);
        }
        while shape.contains('$') {
            shape = shape.replacen('$', &number(-80.0, 80.0).to_string(), 1);
        }
        let material = materials[number(0.0, 4.99) as usize];
        let _ = writeln!(text, "[[mesh]]\nmaterial = '{material}'\n{shape}");
    }
    let normal = DVec3::new(number(-0.05, 0.05), 1.0, number(-0.05, 0.05));
    let _ = writeln!(
        text,
        "[[mesh]]\nshape = 'plane'\nmaterial = 'cubes'\npoint = {}\nnormal = {}",
        offset.toml([number(-1.0, 1.0), 0.0, number(-1.0, 1.0)]),
        NONE.toml(normal)
    );
    text
}

#[test]
fn a_random_scene_moved_by_up_to_ten_million_looks_the_same() {
    let cube: Vec<DVec3> =
        (0..8).map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) - 0.5).collect();
    let faces = "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
    let load = |seed: u64, offset: Offset| {
        let loaded = Folder::new()
            .with("cube.obj", &(NONE.vertices(&cube) + faces))
            .with("far.obj", &(offset.vertices(&cube) + faces))
            .with("a.toml", &random_scene(seed, offset))
            .load("a.toml");
        // A lathe or a box of glass may stand open or alone; nothing is lost.
        assert!(loaded.report.warnings.iter().all(|w| !w.message.contains("32-bit")), "{:?}", loaded.report.warnings);
        loaded.scene
    };
    let (mut moved, mut pixels, mut apart) = (0, 0, 0);
    for seed in 0..60 {
        let mut rng = Rng::new(seed + 1000);
        let mut along = || {
            let size = 10f64.powf(7.0 * f64::from(rng.unit())) * f64::from(rng.signed()).signum();
            (size * 1e6) as i64
        };
        let offset = Offset([along(), along(), along()]);
        let (near, far) = (load(seed, NONE), load(seed, offset));
        moved += usize::from(far.origin != DVec3::ZERO);
        let (near, far) = (native(&near, &Options::default()).film, native(&far, &Options::default()).film);
        let off = differing(&near, &far);
        (pixels, apart) = (pixels + near.pixels.len(), apart + off);
        assert!(off <= 24, "seed {seed}, moved by {offset:?}: {off} of {} pixels differ", near.pixels.len());
    }
    assert!(moved > 20, "{moved}");
    assert!(apart * 500 < pixels, "{apart} of {pixels} pixels differ");
}

/// A ball of triangles as a model, each coordinate written with `digits` after the point of its mantissa.
fn ball(size: f64, centre: DVec3) -> String {
    let (stacks, slices) = (12, 24);
    let mut text = String::new();
    for i in 0..=stacks {
        for j in 0..slices {
            let (s, c) = (f64::from(i) / f64::from(stacks) * std::f64::consts::PI).sin_cos();
            let (t, d) = (f64::from(j) / f64::from(slices) * std::f64::consts::TAU).sin_cos();
            let p = DVec3::new(s * d, c, s * t) * size + centre;
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
    }
    let at = |i: i32, j: i32| i * slices + j % slices + 1;
    for (i, j) in (0..stacks).flat_map(|i| (0..slices).map(move |j| (i, j))) {
        let _ = writeln!(text, "f {} {} {} {}", at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
    }
    text
}

fn model(text: &str) -> Scene {
    let mut scene = Folder::new().with("a.obj", text).load("a.obj").scene;
    (scene.settings.width, scene.settings.height) = (64, 48);
    scene
}

#[test]
fn a_model_of_any_size_is_seen_whole() {
    let one = pictures(&model(&ball(1.0, DVec3::ZERO)));
    for size in [1e-20, 1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12, 1e15, 1e25] {
        let scene = model(&ball(size, DVec3::ZERO));
        for ((renderer, one), (_, other)) in one.iter().zip(pictures(&scene)) {
            let off = differing(one, &other);
            assert!(off <= 4, "{size:e}, {renderer}: {off} of {} pixels differ", one.pixels.len());
        }
    }
}

#[test]
fn a_model_far_away_is_seen_whole_and_round() {
    let near = pictures(&model(&ball(1.0, DVec3::ZERO)));
    for centre in [
        DVec3::new(431_000.25, 301.1, 5_411_000.5),
        DVec3::new(-2_487_002.88, -4_684_673.67, 3_529_638.98),
        DVec3::new(0.0, 0.0, 1e9),
    ] {
        let scene = model(&ball(1.0, centre));
        assert!(scene.origin.distance(centre) <= 2.0, "{}", scene.origin);
        for ((renderer, near), (_, far)) in near.iter().zip(pictures(&scene)) {
            let off = differing(near, &far);
            assert!(off <= 8, "{centre}, {renderer}: {off} of {} pixels differ", near.pixels.len());
        }
    }
}

#[test]
fn neither_a_stray_vertex_nor_a_stray_face_keeps_the_origin_away() {
    let centre = DVec3::new(431_000.25, 301.1, 5_411_000.5);
    let scene = model(&(ball(1.0, centre) + "v 0 0 0\n"));
    assert!(scene.origin.distance(centre) <= 2.0, "{}", scene.origin);
    let scene = model(&(ball(1.0, centre) + "v 0 0 0\nv 1 0 0\nv 0 0 1\nf -3 -2 -1\n"));
    assert!(scene.origin.distance(centre) <= 2.0, "{}", scene.origin);
}

const MATT: &str = "[[material]]\nname = 'm'\ntype = 'diffuse'\n";

#[test]
fn shapes_too_far_apart_are_named_with_what_they_lose() {
    let shape = |name: &str, x: f64, size: f64| {
        format!("[[mesh]]\nname = '{name}'\nshape = 'box'\nmaterial = 'm'\nsize = {size}\ncenter = [{x}, 0, 0]\n")
            .replace(&format!("size = {size}"), &format!("size = [{size}, {size}, {size}]"))
    };
    let load = |shapes: &[String]| Folder::new().with("a.toml", &(MATT.to_owned() + &shapes.concat())).load("a.toml");
    let loaded = load(&[shape("hut", 0.0, 2.0), shape("tower", 4e6, 40.0), shape("hill", 4e6, 2000.0)]);
    let told: Vec<String> = loaded.report.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(loaded.scene.origin, DVec3::ZERO);
    // 4e6 lies where `f32` has steps of 0.25.
    let [one] = told.as_slice() else { panic!("{told:?}") };
    assert!(one.contains("a.toml:") && one.contains("`tower`, 40 across") && one.contains("0.125 (0.313 %"), "{one}");
    // From a place between them both are good enough.
    let loaded = load(&[shape("hut", 0.0, 2.0), shape("hill", 8000.0, 2000.0)]);
    assert!(loaded.report.warnings.is_empty(), "{:?}", loaded.report.warnings);
}

#[test]
fn a_camera_that_looks_along_its_up_gets_another_and_says_so() {
    let scene = |camera: &str| {
        let floor = "checker = { even = [1, 0, 0], odd = [0, 0, 1], size = 50, offset = [0, -1, 0] }\n";
        let mesh = "[[mesh]]\nshape = 'grid'\nsize = [9, 9]\nmaterial = 'm'\n[[light]]\ntype = 'directional'\n\
                    direction = [0, -1, 0]\nintensity = 1\nfalloff = 'none'\n";
        Folder::new().with("a.toml", &format!("[camera]\n{camera}\n{MATT}{floor}{mesh}"))
    };
    let down = scene("eye = [0, 5, 0]\ntarget = [0, 0, 0]\nfov = 30");
    let Loaded { scene: mut seen, report } = down.load("a.toml");
    let told = report.warnings[0].to_string();
    assert!(told.contains("a.toml:3: ") && told.contains("[0, 1, 0], is along its view, [0, -1, 0]"), "{told}");
    assert!(told.contains("[0, 0, -1] is up instead"), "{told}");
    (seen.settings.width, seen.settings.height) = (4, 4);
    // As on a map: +x to the right, -z at the top. Cubes are red where x and z have the same sign.
    let film = native(&seen, &Options::default()).film;
    assert_eq!(film.at(0, 0), [1.0, 0.0, 0.0]);
    assert_eq!(film.at(3, 0), [0.0, 0.0, 1.0]);
    assert_eq!(film.at(3, 3), [1.0, 0.0, 0.0]);
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    assert!(load::scene(&down.path("a.toml"), &strict).is_err());
    // A hair off the axis makes no other choice.
    for eye in ["[0.0001, 5, 0]", "[0, 5, -0.0001]"] {
        let camera = scene(&format!("eye = {eye}")).load("a.toml").scene.camera;
        assert_eq!(camera.up, glam::Vec3::NEG_Z, "{eye}");
    }
    let level = scene("eye = [0, 0, 5]\nup = [0, 0, 1]").load("a.toml").scene.camera;
    assert_eq!(level.up, glam::Vec3::Y);
}

#[test]
fn reports_tell_places_in_the_world() {
    let (corners, faces) = ring();
    let folder =
        Folder::new().with("ring.obj", &(SURVEY.vertices(&corners) + &faces)).with("a.toml", &still_life(SURVEY, ""));
    let run = |args: &[&str]| {
        let mut command = Command::cargo_bin("vitrum").expect("it was built");
        let output = command.current_dir(folder.0.path()).args(args).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        [output.stdout, output.stderr].map(|b| String::from_utf8_lossy(&b).into_owned())
    };
    let [json, told] = run(&["render", "a.toml", "-o", "a.png", "--json"]);
    assert!(told.contains("origin     (451234, 32, 5411234), taken off"), "{told}");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["origin"], serde_json::json!([451_234.0, 32.0, 5_411_234.0]));
    let [json, _] = run(&["pixel", "a.toml", "32", "47", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let eye: Vec<f64> = (0..3).map(|i| json["rays"][0]["f32"]["origin"][i].as_f64().expect("a number")).collect();
    assert!((DVec3::from_slice(&eye) - SURVEY.place() - DVec3::new(0.0, 2.0, 4.0)).length() < 1e-5, "{eye:?}");
    let [text, _] = run(&["pixel", "a.toml", "32", "47"]);
    assert!(text.contains("at (451234.") && text.contains(", 32.0000"), "{text}");
}

#[test]
fn a_plane_alone_far_away_keeps_its_checker_under_the_camera() {
    let scene = |offset: Offset| {
        let text = format!(
            "camera = {{ eye = {}, target = {} }}\nrender = {{ width = 32, height = 24 }}\n[[light]]\ntype = 'directional'\ndirection = [0, -1, 0]\nintensity = 1
             [[material]]\nname = 'm'\ntype = 'diffuse'\nchecker = {{ even = 1, odd = 0, size = 0.7, offset = {} }}
             [[mesh]]\nshape = 'plane'\nmaterial = 'm'\npoint = {}\n",
            offset.toml([0.0, 2.0, 4.0]),
            offset.toml([0.0; 3]),
            offset.toml([0.1, 0.35, 0.2]),
            offset.toml([0.0; 3])
        );
        Folder::new().with("a.toml", &text).load("a.toml").scene
    };
    let (near, far) = (scene(NONE), scene(SURVEY));
    assert!(far.origin != DVec3::ZERO && matches!(far.geometry[0].shape, Shape::Plane(_)));
    assert!(matches!(far.materials[0].diffuse, Colour::Checker { offset, .. } if offset.abs().max_element() <= 0.7));
    for ((name, near), (_, far)) in pictures(&near).iter().zip(pictures(&far)) {
        assert!(differing(near, &far) <= 1, "{name}");
    }
}
