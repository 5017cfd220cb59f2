//! Triangles far longer than they are wide do not shade themselves: what rounding does to a hit grows with that ratio,
//! and the start of the next ray has to clear it.

use glam::Vec3;
use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::geometry::{Geometry, GeometryMask, Shape};
use vitrum::load::shapes;
use vitrum::render::{Observer, Options, reference, render};
use vitrum::scene::{Camera, Falloff, Light, LightKind, Material, Medium, Object, Projection, Rgb, Scene};

/// A rod of 64 triangles of 1.9 by 0.007, leaning, lit from the left.
fn lit_rod() -> Scene {
    let mut mesh =
        shapes::lathe(&[[0.0, 0.0], [0.035, 0.0], [0.035, 1.9], [0.0, 1.9]], 32, 50.0).expect("a sound profile");
    let lean = glam::Quat::from_rotation_z(-0.37);
    for p in &mut mesh.positions {
        *p = lean * *p + Vec3::new(-0.2, 0.57, -0.12);
    }
    for n in &mut mesh.normals {
        *n = lean * *n;
    }
    let mut scene = Scene {
        geometry: vec![Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }],
        objects: vec![Object { name: "rod".into(), material: 0, origin: Default::default() }],
        materials: vec![Material::default()],
        media: vec![Medium::air()],
        lights: vec![Light {
            name: "lamp".into(),
            kind: LightKind::Point { position: Vec3::new(-2.4, 4.2, 2.2) },
            intensity: Rgb::ONE,
            falloff: Falloff::None,
            shadows: true,
        }],
        camera: Camera {
            eye: Vec3::new(0.9, 1.75, 3.6),
            target: Vec3::new(0.02, 1.4, 0.0),
            projection: Projection::Pinhole { vfov: 22.0 },
            ..Camera::default()
        },
        ..Scene::default()
    };
    (scene.settings.width, scene.settings.height) = (160, 160);
    scene
}

/// Case RT-16 of the catalogue.
#[test]
fn a_rod_of_slivers_is_lit_as_the_reference_lights_it() {
    let scene = lit_rod();
    let (options, observer) = (Options::default(), Observer::default());
    let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default()).expect("there is memory");
    let ours = render(&scene, &accel, &options, &observer).expect("renders").film;
    let theirs = reference::render(&scene, &options, &observer).expect("renders").film;
    let lit = theirs.pixels.iter().filter(|p| p[0] > 0.01).count();
    assert!(lit > 500, "{lit}");
    let apart = ours.pixels.iter().zip(&theirs.pixels).filter(|(a, b)| (a[0] - b[0]).abs() > 1e-3).count();
    assert_eq!(apart, 0, "of {lit} lit pixels");
}
