//! Environment maps as reflections, and as environments.

use glam::Vec3;
use vitrum::accel::Unbounded;
use vitrum::accel::native::Native;
use vitrum::load;
use vitrum::render::{Observer, Options, Outcome, RayKind, Reflection, reference, render};
use vitrum::scene::{Camera, Environment, Interface, MapKind, MirrorSource, Projection, Rgb, Scene, Texture};
use vitrum::systems::maps::Proxy;

use super::{difference, fast_outcomes, outcomes};
use crate::support::scenes::{bare, cuboid, empty, glass, material, native, plane, sphere};

const KINDS: [Reflection; 2] = [Reflection::CubeMap, Reflection::SphereMap];

fn mirror() -> vitrum::scene::Material {
    bare(Interface::Mirror { reflectance: Rgb::splat(0.9), source: MirrorSource::Traced })
}

fn glowing(colour: Rgb) -> vitrum::scene::Material {
    vitrum::scene::Material { emission: colour, ..vitrum::scene::Material::black("glow") }
}

fn by(reflection: Reflection, proxy: Proxy) -> Options {
    Options { reflection, proxy, ..Options::default() }
}

/// A mirror ball of radius 0.5 in the middle of a room whose walls are `half` away, each of a colour of its own.
fn ball_in_room(half: f32) -> Scene {
    let mut scene = empty(0.0);
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (48, 48, 1);
    scene.camera.eye = Vec3::new(0.2, 0.3, 2.4);
    let silver = material(&mut scene, mirror());
    sphere(&mut scene, Vec3::ZERO, 0.5, silver);
    let walls = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    for (k, normal) in walls.into_iter().enumerate() {
        let colour = Rgb::new((k % 2) as f32, (k / 2 % 2) as f32, (k / 4) as f32) * 0.8 + 0.1;
        let wall = material(&mut scene, glowing(colour));
        plane(&mut scene, -normal * half, normal, wall);
    }
    scene
}

fn rmse(a: &Outcome, b: &Outcome) -> f64 {
    let squares = (0..a.film.pixels.len()).map(|p| f64::from(difference(&a.film, &b.film, p)).powi(2));
    (squares.sum::<f64>() / a.film.pixels.len() as f64).sqrt()
}

#[test]
fn surroundings_that_depend_on_the_direction_alone_are_seen_as_traced_rays_see_them() {
    let mut scene = empty(0.0);
    scene.environment = Environment::Gradient {
        nadir: Rgb::new(0.1, 0.0, 0.3),
        horizon: Rgb::splat(0.5),
        zenith: Rgb::new(0.2, 0.6, 1.0),
    };
    let silver = material(&mut scene, mirror());
    sphere(&mut scene, Vec3::new(0.1, -0.2, 0.3), 0.9, silver);
    for kind in KINDS {
        for proxy in Proxy::ALL {
            let traced = outcomes(&scene, &Options::default());
            for ((name, outcome), (_, traced)) in outcomes(&scene, &by(kind, proxy)).iter().zip(&traced) {
                assert_eq!(outcome.rays.of(RayKind::Reflected), 0, "{name}");
                for p in 0..traced.film.pixels.len() {
                    let off = difference(&outcome.film, &traced.film, p);
                    assert!(off < 0.03, "{name}, {kind:?}, proxy {}: {off}", proxy.name());
                }
            }
        }
    }
}

#[test]
fn the_error_falls_as_the_walls_go_away_and_a_box_for_the_room_takes_most_of_it() {
    for kind in KINDS {
        let error = |half: f32, proxy: Proxy| {
            let scene = ball_in_room(half);
            rmse(&native(&scene, &by(kind, proxy)), &native(&scene, &Options::default()))
        };
        let [near, middle, far] = [3.0, 12.0, 100.0].map(|half| error(half, Proxy::None));
        assert!(near > 1.3 * middle && middle > far, "{kind:?}: {near} {middle} {far}");
        let boxed = error(3.0, Proxy::Box);
        assert!(boxed < 0.6 * near, "{kind:?}: {boxed} with a box, {near} without");
    }
}

#[test]
fn maps_taken_once_serve_other_cameras_and_are_those_that_would_be_taken_again() {
    let mut scene = ball_in_room(4.0);
    let options = by(Reflection::CubeMap, Proxy::None);
    let first = native(&scene, &options);
    let maps = first.maps.expect("they were asked for").maps;
    assert_eq!(maps.list.len(), 1);
    let again = native(&scene, &Options { maps: Some(maps.clone()), ..options.clone() });
    assert!(again.film == first.film && again.maps.expect("as before").time.is_zero());
    scene.camera.eye = Vec3::new(-2.0, 1.0, 1.2);
    let other = native(&scene, &Options { maps: Some(maps.clone()), ..options.clone() });
    let traced = native(&scene, &Options::default());
    let plain = native(&scene, &by(Reflection::None, Proxy::None));
    assert!(rmse(&other, &traced) < 0.5 * rmse(&plain, &traced));
    // Maps of one kind are no maps of the other.
    let accel = Unbounded::new(Native::build(&scene.geometry), &scene.geometry);
    let wrong = Options { maps: Some(maps), ..by(Reflection::SphereMap, Proxy::None) };
    let refused = render(&scene, &accel, &wrong, &Observer::default()).expect_err("cubes are no balls");
    assert!(refused.to_string().contains("cube maps and not sphere maps"), "{refused}");
}

#[test]
fn a_reflector_is_not_in_its_own_map_but_its_shadow_and_its_image_in_others_are() {
    // The ball alone in a room of light sees the room and not itself, whatever it is made of.
    let mut bright = empty(1.0);
    let silver = material(&mut bright, mirror());
    cuboid(&mut bright, Vec3::splat(-0.5), Vec3::splat(0.5), silver);
    sphere(&mut bright, Vec3::new(1.5, 0.0, 0.0), 0.4, silver);
    for (name, outcome) in outcomes(&bright, &by(Reflection::CubeMap, Proxy::None)) {
        let maps = outcome.maps.expect("they were asked for").maps;
        assert_eq!(maps.list.len(), 2, "{name}");
        for map in &maps.list {
            assert!(map.picture.pixels.iter().all(|p| p.x > 0.7), "{name}");
            // In the map, the other mirror shows 0.9 of the room, or what it shows of this one.
            assert!(map.picture.pixels.iter().any(|p| p.x < 0.91), "{name}");
        }
    }
}

#[test]
fn light_inside_glass_and_on_planes_is_traced_and_counted() {
    let mut scene = ball_in_room(4.0);
    let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::new(0.0, 0.0, 1.0), 0.3, crown);
    let silver = material(&mut scene, mirror());
    plane(&mut scene, Vec3::new(0.0, -2.0, 0.0), Vec3::new(0.0, 1.0, 0.1).normalize(), silver);
    for (name, outcome) in outcomes(&scene, &by(Reflection::CubeMap, Proxy::None)) {
        let report = outcome.maps.expect("they were asked for");
        assert!(report.traced > 0 && outcome.rays.of(RayKind::Reflected) > 0, "{name}");
        assert_eq!(report.maps.without, [(scene.objects.len() as u32 - 1, "has no centre")], "{name}");
    }
}

fn radiance(prepared: &reference::Prepared, at: Vec3, dir: Vec3) -> Rgb {
    Vec3::from(prepared.radiance_along(at.as_dvec3(), dir.as_dvec3()).map(|c| c as f32))
}

/// Largest angle between a direction and the texels that its lookup in a map of 64 rows reads: a texel's diagonal.
fn texels(kind: MapKind, dir: Vec3) -> f32 {
    let texel = match kind {
        MapKind::Cube => 2.0 / 64.0,
        MapKind::LatLong => std::f32::consts::PI / 64.0,
        // The radius on the map is 32 sin(a / 2) texels, for the angle `a` from +z.
        MapKind::Sphere => 2.0 / (32.0 * ((1.0 + dir.z) / 2.0).sqrt().max(1e-3)),
    };
    (texel * std::f32::consts::SQRT_2).min(std::f32::consts::PI)
}

/// Returns true if the radiance changes within an angle of a direction.
fn is_near_a_corner(room: &reference::Prepared, at: Vec3, dir: Vec3, angle: f32) -> bool {
    let (u, v) = dir.any_orthonormal_pair();
    let seen = radiance(room, at, dir);
    (0..96).any(|k| {
        let (sin, cos) = ((k % 32) as f32 * std::f32::consts::TAU / 32.0).sin_cos();
        let angle = angle * (k / 32 + 1) as f32 / 3.0;
        radiance(room, at, dir * angle.cos() + (u * cos + v * sin) * angle.sin()) != seen
    })
}

#[test]
fn a_map_of_a_scene_is_its_environment_again() {
    let mut scene = ball_in_room(3.0);
    scene.geometry.remove(0);
    scene.objects.remove(0);
    let (at, dirs) = (Vec3::new(0.3, -0.2, 0.5), vitrum::systems::maps::directions(9));
    for kind in MapKind::ALL {
        let mut view = scene.clone();
        view.camera =
            Camera { eye: at, target: at + Vec3::NEG_Z, up: Vec3::Y, projection: Projection::Map(kind), medium: None };
        [view.settings.width, view.settings.height] = kind.shape(64);
        let [fast, double] = ["native", "reference"].map(|wanted| {
            outcomes(&view, &Options::default()).into_iter().find(|(name, _)| *name == wanted).expect("it is there").1
        });
        let film = fast.film;
        let off = (0..film.pixels.len()).filter(|&p| difference(&film, &double.film, p) > 1e-5).count();
        assert!(off * 100 < film.pixels.len(), "{}: {off} texels differ in f64", kind.name());
        let (width, height) = (film.width, film.height);
        let pixels = film.pixels.into_iter().map(Rgb::from).collect::<Vec<_>>();
        let mut inside = empty(0.0);
        inside.textures.push(Texture::new("map", width, height, pixels));
        inside.environment = Environment::Map { kind, texture: 0, scale: Rgb::ONE, rotation: 0.0 };
        let prepared = [&inside, &scene].map(|s| reference::Prepared::with(s, &Options::default()));
        let differs = |dir: &Vec3| {
            let [map, room] = prepared.each_ref().map(|p| radiance(p, at, *dir));
            (map - room).abs().max_element() > 1e-5
        };
        let wrong = dirs.iter().filter(|dir| differs(dir)).count();
        let (near, far): (Vec<Vec3>, Vec<Vec3>) =
            dirs.iter().partition(|&&dir| is_near_a_corner(&prepared[1], at, dir, texels(kind, dir)));
        assert!(far.len() > near.len(), "{}: {} of {} are away from corners", kind.name(), far.len(), dirs.len());
        let astray: Vec<_> = far.into_iter().filter(differs).collect();
        assert!(astray.is_empty(), "{}: {astray:?}", kind.name());
        // What differs lies where walls meet, within a texel; those of the sphere map are the widest.
        let share = if kind == MapKind::Sphere { 5 } else { 8 };
        assert!(wrong * share < dirs.len(), "{}: {wrong} of {}", kind.name(), dirs.len());
        for (name, outcome) in fast_outcomes(&inside, &Options::default()) {
            let by_reference = reference::render(&inside, &Options::default(), &Observer::default()).expect("renders");
            assert!(
                (0..1024).all(|p| difference(&outcome.film, &by_reference.film, p) < 1e-4),
                "{name}, {}",
                kind.name()
            );
        }
    }
}

#[test]
fn a_picture_of_the_wrong_shape_is_no_map() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut pfm = b"PF\n6 2\n-1.0\n".to_vec();
    pfm.extend(std::iter::repeat_n(1.0_f32.to_le_bytes(), 36).flatten());
    std::fs::write(folder.path().join("map.pfm"), pfm).expect("writable");
    let scene = |kind: &str| {
        let file = folder.path().join("scene.toml");
        std::fs::write(&file, format!("[environment]\ntype = \"{kind}\"\nfile = \"map.pfm\"\n")).expect("writable");
        load::scene(&file, &load::LoadOptions::default()).map(|loaded| loaded.scene)
    };
    for (kind, shape) in [("cube", "12 by 2"), ("sphere", "2 by 2"), ("latlong", "4 by 2")] {
        let told = scene(kind).expect_err("6 by 2 is no map").to_string();
        assert!(told.contains("scene.toml:3") && told.contains("6 by 2 pixels") && told.contains(shape), "{told}");
        assert!(told.contains(&format!("vitrum map --kind {kind}")), "{told}");
    }
}

#[test]
fn a_map_from_inside_a_body_is_that_of_its_place_without_it() {
    // Coloured glass takes nothing from what its own map shows.
    let mut scene = ball_in_room(3.0);
    let dark = glass(&mut scene, 1.7, 0, Rgb::splat(9.0));
    scene.objects[0].material = dark;
    for (name, outcome) in outcomes(&scene, &by(Reflection::CubeMap, Proxy::None)) {
        let maps = outcome.maps.expect("it was asked for").maps;
        let seen = maps.list[0].picture.pixels.get(0);
        assert!(seen.max_element() > 0.09, "{name}: {seen}");
    }
}
