//! Scenes built in code.

use glam::{DVec3, Vec3};
use vitrum::geometry::{Geometry, GeometryMask, Plane, Shape, Sphere, TriMesh};
use vitrum::optics::FresnelModel;
use vitrum::render::reference::{Prepared, Tally};
use vitrum::scene::{
    Colour, Dispersion, Environment, Falloff, FresnelRule, Interface, Light, LightKind, Material, Medium, Object,
    Origin, Rgb, Scene,
};

/// An empty black scene with nothing cut off, in air.
pub fn empty() -> Scene {
    let mut scene = Scene { media: vec![Medium::air()], ..Scene::default() };
    scene.settings.cutoff = 0.0;
    scene.settings.width = 1;
    scene.settings.height = 1;
    scene
}

pub fn white(scene: &mut Scene) {
    scene.environment = Environment::Constant(Rgb::ONE);
}

pub fn medium(scene: &mut Scene, ior: f64, absorption: f32, priority: i32) -> u32 {
    let absorption = Rgb::splat(absorption);
    scene.media.push(Medium { name: String::new(), ior, dispersion: Dispersion::None, absorption, priority });
    scene.media.len() as u32 - 1
}

/// A black surface with the given interface.
pub fn bare(interface: Interface) -> Material {
    Material { diffuse: Colour::Constant(Rgb::ZERO), interface, ..Material::default() }
}

pub fn dielectric(medium: u32) -> Material {
    bare(Interface::Dielectric { medium, rule: FresnelRule::Fresnel, tint: Rgb::ONE })
}

pub fn lambert(albedo: f32) -> Material {
    Material { diffuse: Colour::Constant(Rgb::splat(albedo)), ..Material::default() }
}

pub fn emitter(radiance: f32) -> Material {
    Material { emission: Rgb::splat(radiance), ..bare(Interface::Opaque) }
}

pub fn put(scene: &mut Scene, shape: Shape, material: Material) {
    let mask = if material.is_transmissive() { GeometryMask::TRANSMISSIVE } else { GeometryMask::OPAQUE };
    scene.geometry.push(Geometry { shape, mask });
    scene.objects.push(Object {
        name: String::new(),
        material: scene.materials.len() as u32,
        origin: Origin::default(),
    });
    scene.materials.push(material);
}

pub fn sphere(x: f32, y: f32, z: f32, radius: f32) -> Shape {
    Shape::Sphere(Sphere { centre: Vec3::new(x, y, z), radius })
}

pub fn plane(point: Vec3, normal: Vec3) -> Shape {
    Shape::Plane(Plane { point, normal })
}

/// The closed box between two corners.
pub fn block(lo: Vec3, hi: Vec3) -> Shape {
    let positions =
        (0..8).map(|i| Vec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), hi, lo)).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Shape::Mesh(TriMesh { positions, triangles, ..TriMesh::default() })
}

/// A box over -50..50 in x and y.
pub fn layer(z_lo: f32, z_hi: f32) -> Shape {
    block(Vec3::new(-50.0, -50.0, z_lo), Vec3::new(50.0, 50.0, z_hi))
}

/// A closed torus around the y axis, smooth normals on demand.
pub fn torus(big: f32, small: f32, n: u32, smooth: bool) -> Shape {
    let turn = |k: u32| (std::f32::consts::TAU * k as f32 / n as f32).sin_cos();
    let mut mesh = TriMesh::default();
    for i in 0..n {
        let (s, c) = turn(i);
        for j in 0..n {
            let (t, d) = turn(j);
            let normal = Vec3::new(c * d, t, s * d);
            mesh.positions.push(Vec3::new(c, 0.0, s) * big + normal * small);
            mesh.normals.push(normal);
        }
    }
    let at = |i: u32, j: u32| i % n * n + j % n;
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    if smooth {
        mesh.normal_indices.clone_from(&mesh.triangles);
    } else {
        mesh.normals.clear();
    }
    Shape::Mesh(mesh)
}

pub fn light(kind: LightKind, falloff: Falloff) -> Light {
    Light { name: String::new(), kind, intensity: Rgb::splat(3.0), falloff, shadows: true }
}

/// Traces a ray from an eye at `origin` towards `dir` (of any length), with exact Fresnel.
pub fn trace(scene: &Scene, origin: [f64; 3], dir: [f64; 3]) -> Tally {
    let mut scene = scene.clone();
    scene.camera.eye = DVec3::from(origin).as_vec3();
    Prepared::new(&scene, FresnelModel::Exact).trace(DVec3::from(origin), DVec3::from(dir).normalize())
}

/// The red radiance of [`trace`].
pub fn radiance(scene: &Scene, origin: [f64; 3], dir: [f64; 3]) -> f64 {
    trace(scene, origin, dir).radiance.x
}

/// Fresnel by the textbook, from the angle of incidence in radians; 1 where reflection is total.
pub fn fresnel(n1: f64, n2: f64, angle: f64) -> f64 {
    let sin_t = n1 / n2 * angle.sin();
    if sin_t >= 1.0 {
        return 1.0;
    }
    let (c, d) = (angle.cos(), sin_t.asin().cos());
    let s = (n1 * c - n2 * d) / (n1 * c + n2 * d);
    let p = (n1 * d - n2 * c) / (n1 * d + n2 * c);
    0.5 * (s * s + p * p)
}

#[track_caller]
pub fn close(got: f64, want: f64, within: f64) {
    assert!((got - want).abs() <= within, "got {got}, want {want}, off by {:e}", got - want);
}
