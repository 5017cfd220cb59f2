//! Planar mirrors by matrix.

use glam::{DVec3, Vec3};
use vitrum::accel::Unbounded;
use vitrum::accel::native::Native;
use vitrum::geometry::{Shape, TriMesh};
use vitrum::optics::{FresnelModel, PlanarReflection};
use vitrum::render::{Observer, Options, RayKind, Reflection, reference, render};
use vitrum::scene::{
    Colour, Environment, Falloff, Interface, Light, LightKind, Material, MirrorSource, Projection, Rgb, Scene,
};
use vitrum::systems::planar::Mirrors;

use super::{difference, is_at_edge, outcomes};
use crate::support::scenes::{add, bare, cuboid, cuboid_mesh, empty, glass, material, native, plane, sphere};

fn mirror(share: f32) -> Material {
    bare(Interface::Mirror { reflectance: Rgb::splat(share), source: MirrorSource::Traced })
}

fn by_matrix() -> Options {
    Options { reflection: Reflection::Planar, ..Options::default() }
}

fn lamp(position: Vec3) -> Light {
    Light {
        name: String::from("lamp"),
        kind: LightKind::Point { position },
        intensity: Rgb::splat(9.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    }
}

/// A room with a checkered floor, a lamp, a box and a ball, seen towards -z.
fn room() -> Scene {
    let mut scene = empty(0.0);
    scene.environment = Environment::Gradient {
        nadir: Rgb::splat(0.1),
        horizon: Rgb::new(0.4, 0.3, 0.2),
        zenith: Rgb::new(0.1, 0.2, 0.6),
    };
    scene.camera.eye = Vec3::new(0.7, 1.3, 3.0);
    scene.camera.target = Vec3::new(-0.3, 0.7, -2.0);
    scene.camera.projection = Projection::Pinhole { vfov: 55.0 };
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (72, 48, 1);
    let checker =
        Colour::Checker { even: Rgb::splat(0.8), odd: Rgb::splat(0.1), size: 0.6, offset: Vec3::new(0.0, 0.3, 0.0) };
    let floor = material(&mut scene, Material { diffuse: checker, ..Material::default() });
    plane(&mut scene, Vec3::ZERO, Vec3::Y, floor);
    let matt = material(&mut scene, Material::default());
    cuboid(&mut scene, Vec3::new(-1.2, 0.0, -1.0), Vec3::new(-0.6, 0.9, -0.4), matt);
    sphere(&mut scene, Vec3::new(0.6, 0.4, -0.9), 0.4, matt);
    scene.lights.push(lamp(Vec3::new(1.0, 3.0, 1.0)));
    scene
}

/// Two facing mirrors, a little askew.
fn hall() -> Scene {
    let mut scene = room();
    let silver = material(&mut scene, mirror(0.9));
    let far = cuboid_mesh(Vec3::new(-2.0, 0.1, -3.1), Vec3::new(2.0, 2.2, -3.0));
    add(&mut scene, Shape::Mesh(turned(far, 0.1)), silver);
    cuboid(&mut scene, Vec3::new(-2.0, 0.1, 3.4), Vec3::new(2.0, 2.2, 3.5), silver);
    scene
}

fn turned(mut mesh: TriMesh, angle: f32) -> TriMesh {
    let turn = glam::Quat::from_rotation_y(angle) * glam::Quat::from_rotation_x(0.3 * angle);
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
    mesh
}

/// Scenes with planar mirrors of all kinds.
fn scenes() -> Vec<(&'static str, Scene)> {
    let wall = |interface: Interface| {
        let mut scene = room();
        let wall = material(&mut scene, bare(interface));
        plane(&mut scene, Vec3::new(0.0, 0.0, -3.0), Vec3::new(0.1, -0.05, 1.0).normalize(), wall);
        scene
    };
    let mut boxed = room();
    let silver = material(&mut boxed, mirror(0.8));
    let cube = turned(cuboid_mesh(Vec3::new(-0.5, 0.2, -2.0), Vec3::new(0.5, 1.2, -1.0)), 0.5);
    add(&mut boxed, Shape::Mesh(cube), silver);

    let mut flat = wall(Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced });
    flat.camera.projection = Projection::Orthographic { height: 2.5 };

    // The eye is in a smoke, which takes light on the whole way to the mirror and back.
    let mut smoky = hall();
    smoky.media[0].absorption = Rgb::new(0.02, 0.05, 0.1);

    let mut soft = hall();
    soft.settings.samples = 2;
    soft.lights[0].kind = LightKind::Sphere { position: Vec3::new(1.0, 3.0, 1.0), radius: 0.3 };

    let mut glassy = hall();
    let crown = glass(&mut glassy, 1.5, 0, Rgb::new(0.3, 0.1, 0.05));
    cuboid(&mut glassy, Vec3::new(0.0, 0.05, 0.2), Vec3::new(0.5, 1.0, 0.4), crown);

    vec![
        ("hall", hall()),
        ("metal wall", wall(Interface::Conductor { eta: Rgb::new(0.2, 0.9, 1.2), k: Rgb::new(3.9, 2.5, 2.3) })),
        ("coated wall", wall(Interface::Coated { ior: 1.5 })),
        ("mirrored box", boxed),
        ("orthographic", flat),
        ("smoke", smoky),
        ("soft shadows, four rays a pixel", soft),
        ("glass in the hall", glassy),
    ]
}

#[test]
fn the_picture_is_that_of_traced_mirrors_but_for_edges() {
    for (what, scene) in scenes() {
        for ((name, traced), (_, matrix)) in
            outcomes(&scene, &Options::default()).iter().zip(outcomes(&scene, &by_matrix()))
        {
            let (traced, picture) = (&traced.film, &matrix.film);
            let off: Vec<usize> = (0..traced.pixels.len()).filter(|&p| difference(traced, picture, p) > 1e-5).collect();
            assert!(off.len() * 50 <= traced.pixels.len(), "{what}, {name}: {} pixels differ", off.len());
            for p in off {
                assert!(is_at_edge(traced, p, 1e-3), "{what}, {name}: pixel {p} by {}", difference(traced, picture, p));
            }
            assert!(matrix.planar.is_some_and(|planar| planar.mirrors > 0), "{what}, {name}");
        }
    }
}

#[test]
fn as_many_rays_are_reflected_as_by_tracing() {
    let scene = hall();
    let rays = |options: &Options| native(&scene, options).rays;
    let (traced, matrix) = (rays(&Options::default()), rays(&by_matrix()));
    let [traced, matrix] = [traced, matrix].map(|rays| [RayKind::Camera, RayKind::Reflected].map(|kind| rays.of(kind)));
    assert_eq!(traced[0], matrix[0]);
    assert!(traced[1].abs_diff(matrix[1]) * 1000 <= traced[1], "{traced:?} {matrix:?}");
    let levels = native(&scene, &by_matrix()).planar.expect("it was asked for").levels;
    assert!(levels.len() > 3, "the mirrors are seen in each other");
    assert_eq!(levels.iter().map(|level| level.rays).sum::<u64>(), matrix[1], "nothing else reflects");
}

/// The notes' virtual objects: the scene itself through the matrix, its triangles wound the other way, seen from the eye
/// as it is. The mirror fills the picture, so that nothing else is seen.
#[test]
fn a_mirrored_camera_sees_what_the_eye_sees_of_virtual_objects() {
    let (foot, normal) = (Vec3::new(0.0, 0.0, -3.0), Vec3::new(0.1, -0.05, 1.0).normalize());
    let mut scene = room();
    // All but planes and spheres turn over under a matrix as they are: bodies of triangles alone.
    scene.geometry.drain(..1);
    scene.objects.drain(..1);
    scene.geometry.truncate(1);
    scene.objects.truncate(1);
    scene.lights[0].shadows = false;
    let mut virtual_scene = scene.clone();
    let silver = material(&mut scene, mirror(1.0));
    plane(&mut scene, foot, normal, silver);
    // Nothing but the mirror in front of the eye.
    let Shape::Mesh(mesh) = &mut scene.geometry[0].shape else { panic!("a box is a mesh") };
    mesh.positions.iter_mut().for_each(|p| p.z += 4.5);
    let middle = mesh.bounds().centre();

    let matrix = PlanarReflection::<f64>::new(foot.as_dvec3().into(), normal.as_dvec3().into());
    let image = |p: Vec3| DVec3::from(matrix.point(p.as_dvec3().into())).as_vec3();
    let mut mirrored = mesh.clone();
    mirrored.positions.iter_mut().for_each(|p| *p = image(*p));
    mirrored.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    virtual_scene.geometry[0].shape = Shape::Mesh(mirrored);
    let LightKind::Point { position } = &mut virtual_scene.lights[0].kind else { panic!("the lamp is a point") };
    *position = image(*position);
    for scene in [&mut scene, &mut virtual_scene] {
        (scene.camera.target, scene.camera.projection) = (image(middle), Projection::Pinhole { vfov: 8.0 });
    }
    virtual_scene.environment = Environment::Constant(Rgb::ZERO);
    scene.environment = Environment::Constant(Rgb::ZERO);

    let drawn = native(&virtual_scene, &Options::default()).film;
    assert!(drawn.pixels.iter().filter(|p| p[0] > 0.01).count() > 50, "the box is seen");
    for (name, outcome) in outcomes(&scene, &by_matrix()) {
        for p in 0..drawn.pixels.len() {
            let off = difference(&drawn, &outcome.film, p);
            assert!(off <= 1e-5 || is_at_edge(&drawn, p, 1e-3), "{name}: pixel {p} by {off}");
        }
    }
}

#[test]
fn each_level_of_a_hall_of_mirrors_is_counted_and_the_last_says_what_is_missing() {
    let mut scene = empty(1.0);
    (scene.camera.eye, scene.camera.target) = (Vec3::ZERO, Vec3::NEG_Z);
    let silver = material(&mut scene, mirror(0.5));
    plane(&mut scene, Vec3::NEG_Z, Vec3::Z, silver);
    plane(&mut scene, Vec3::Z, Vec3::NEG_Z, silver);
    scene.camera.projection = Projection::Pinhole { vfov: 2.0 };
    let options = Options { mirror_levels: 3, ..by_matrix() };
    for (name, outcome) in outcomes(&scene, &options) {
        // Rays go back and forth between the mirrors for ever: the fourth reflection is missing.
        for lost in &outcome.truncated.pixels {
            assert_eq!(lost, &[0.0625; 3], "{name}");
        }
        assert!(outcome.film.pixels.iter().flatten().all(|&c| c == 0.0), "{name}");
        let planar = outcome.planar.expect("it was asked for");
        assert_eq!((planar.mirrors, planar.elsewhere), (2, 0), "{name}");
        if name == "reference" {
            continue;
        }
        let weights: Vec<f32> = planar.levels.iter().map(|level| level.heaviest).collect();
        assert_eq!(weights, [0.5, 0.25, 0.125], "{name}");
        for level in planar.levels {
            assert_eq!(level.rays, 32 * 32 * u64::from(scene.settings.samples.pow(2)), "{name}");
            assert!((level.weight() / level.rays as f64 - f64::from(level.heaviest)).abs() < 1e-9, "{name}");
        }
    }
}

#[test]
fn mirrors_behind_glass_and_in_balls_are_traced_and_counted() {
    let mut scene = hall();
    let before = native(&scene, &by_matrix()).planar.expect("it was asked for");
    assert_eq!((before.elsewhere, before.curved.len()), (0, 0));
    let silver = material(&mut scene, mirror(0.9));
    sphere(&mut scene, Vec3::new(-0.2, 1.2, -0.5), 0.4, silver);
    let after = native(&scene, &by_matrix()).planar.expect("as before");
    assert!(after.elsewhere > 0, "the hall is seen in the ball: {}", after.elsewhere);
    assert_eq!(after.curved, [(scene.objects.len() as u32 - 1, String::from("is a sphere"))]);
}

#[test]
fn neither_threads_nor_tiles_change_a_byte_of_it() {
    let scene = hall();
    let one = native(&scene, &Options { threads: 1, tile: 128, ..by_matrix() }).film;
    for (threads, tile) in [(2, 32), (3, 7), (1, 1)] {
        assert!(
            one == native(&scene, &Options { threads, tile, ..by_matrix() }).film,
            "{threads} threads, tiles of {tile}"
        );
    }
}

#[test]
fn a_scene_whose_reflectors_are_all_curved_is_refused_by_name() {
    let mut scene = room();
    let silver = material(&mut scene, mirror(0.9));
    sphere(&mut scene, Vec3::new(-0.2, 1.2, -0.5), 0.4, silver);
    let accel = Unbounded::new(Native::build(&scene.geometry), &scene.geometry);
    let error = render(&scene, &accel, &by_matrix(), &Observer::default()).expect_err("nothing is planar");
    let text = error.to_string();
    assert_eq!(text, reference::render(&scene, &by_matrix(), &Observer::default()).unwrap_err().to_string());
    assert_eq!(error.exit_code(), 2);
    assert!(text.contains("`object 3` is a sphere") && text.contains("--reflection traced"), "{text}");
    // Rays that carry polarisation are traced.
    let polarised = Options { fresnel: FresnelModel::Polarised, ..Options::default() };
    let matrix = Options { reflection: Reflection::Planar, ..polarised.clone() };
    assert!(native(&hall(), &matrix).film == native(&hall(), &polarised).film);
    // A scene in which nothing reflects is its traced picture.
    let matt = room();
    assert!(native(&matt, &by_matrix()).film == native(&matt, &Options::default()).film);
}

#[test]
fn a_matrix_after_another_mirrors_in_both_and_twice_in_one_is_nothing() {
    let mirrors = Mirrors::of(&hall());
    let p = DVec3::new(0.3, -1.7, 2.9);
    for a in &mirrors.list {
        let twice = a.matrix().after(&a.matrix());
        assert!((DVec3::from(twice.point(p.into())) - p).length() < 1e-14);
        assert!((a.matrix().determinant() + 1.0).abs() < 1e-14 && (twice.determinant() - 1.0).abs() < 1e-14);
        // By reflecting the point: as far behind the plane as it is before it.
        let image = p - a.normal * (2.0 * a.normal.dot(p - a.point));
        assert!((DVec3::from(a.matrix().point(p.into())) - image).length() < 1e-14);
        for b in &mirrors.list {
            let both = b.matrix().after(&a.matrix());
            let one_by_one = b.matrix().point(a.matrix().point(p.into()));
            assert!((DVec3::from(both.point(p.into())) - DVec3::from(one_by_one)).length() < 1e-13);
        }
    }
    assert_eq!(DVec3::from(PlanarReflection::identity().point(p.into())), p);
}
