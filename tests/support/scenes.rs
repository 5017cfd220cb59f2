//! Small scenes made in memory, for tests whose answers are known by hand.

use glam::Vec3;
use vitrum::geometry::{Geometry, GeometryMask, Plane, Shape, Sphere, TriMesh};
use vitrum::render::{Observer, Options, Outcome, render};
use vitrum::scene::{
    Camera, Dispersion, Environment, FresnelRule, Interface, LightsFrom, Material, Medium, Object, Origin, Projection,
    Rgb, Scene, Settings,
};

use super::backends;

/// An empty scene in a constant environment, which lights no surface, seen from +z: 32 by 32 pixels, deep enough for
/// anything, no cut-off.
pub fn empty(environment: f32) -> Scene {
    Scene {
        media: vec![Medium::air()],
        environment: Environment::Constant(Rgb::splat(environment)),
        camera: Camera {
            eye: Vec3::new(0.3, 0.4, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Pinhole { vfov: 30.0 },
            medium: None,
        },
        settings: Settings {
            width: 32,
            height: 32,
            max_depth: 64,
            cutoff: 0.0,
            lights_from: LightsFrom::Lamps,
            ..Settings::default()
        },
        ..Scene::default()
    }
}

/// Adds a material and gives its number.
pub fn material(scene: &mut Scene, material: Material) -> u32 {
    scene.materials.push(material);
    scene.materials.len() as u32 - 1
}

/// A material that is black but for its interface.
pub fn bare(interface: Interface) -> Material {
    Material { interface, ..Material::black("bare") }
}

/// Adds a clear dielectric and gives its material's number.
pub fn glass(scene: &mut Scene, ior: f64, priority: i32, absorption: Rgb) -> u32 {
    scene.media.push(Medium { name: format!("medium {ior}"), ior, dispersion: Dispersion::None, absorption, priority });
    let medium = scene.media.len() as u32 - 1;
    material(scene, bare(Interface::Dielectric { medium, rule: FresnelRule::Fresnel, tint: Rgb::ONE }))
}

/// Adds a shape of a material.
pub fn add(scene: &mut Scene, shape: Shape, material: u32) {
    let transmissive = scene.materials[material as usize].is_transmissive();
    let mask = if transmissive { GeometryMask::TRANSMISSIVE } else { GeometryMask::OPAQUE };
    scene.geometry.push(Geometry { shape, mask });
    scene.objects.push(Object { name: format!("object {}", scene.objects.len()), material, origin: Origin::default() });
}

/// Adds an exact sphere.
pub fn sphere(scene: &mut Scene, centre: Vec3, radius: f32, material: u32) {
    add(scene, Shape::Sphere(Sphere { centre, radius }), material);
}

/// Adds an infinite plane.
pub fn plane(scene: &mut Scene, point: Vec3, normal: Vec3, material: u32) {
    add(scene, Shape::Plane(Plane { point, normal }), material);
}

/// Adds a box of twelve triangles, normals outward.
pub fn cuboid(scene: &mut Scene, lo: Vec3, hi: Vec3, material: u32) {
    add(scene, Shape::Mesh(cuboid_mesh(lo, hi)), material);
}

/// A box of twelve triangles, normals outward.
pub fn cuboid_mesh(lo: Vec3, hi: Vec3) -> TriMesh {
    let corner = |i: u32| {
        Vec3::new(
            if i & 1 == 0 { lo.x } else { hi.x },
            if i & 2 == 0 { lo.y } else { hi.y },
            if i & 4 == 0 { lo.z } else { hi.z },
        )
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { positions: (0..8).map(corner).collect(), triangles, ..TriMesh::default() }
}

/// Renders on the native path.
pub fn native(scene: &Scene, options: &Options) -> Outcome {
    render(scene, &backends::native(&scene.geometry), options, &Observer::default()).expect("nobody interrupts a test")
}
