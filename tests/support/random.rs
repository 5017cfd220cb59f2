//! Random scenes with something of everything, small enough to be traced by the hundred.

use glam::{Mat4, Quat, Vec3};
use vitrum::geometry::{Shape, TriMesh};
use vitrum::load::shapes::{self, Wave};
use vitrum::optics::FresnelModel;
use vitrum::scene::{
    Camera, Colour, Dispersion, Environment, Falloff, FresnelRule, Highlight, HighlightModel, Interface, Light,
    LightKind, Material, Medium, MirrorSource, Projection, Rgb, Scene, ShadowRule, Texture,
};

use super::Rng;
use super::scenes::{add, empty, plane, sphere};

/// Indices of media: thinner and denser than air, and air itself. All of them are `f32` numbers, so that a pane in a
/// medium of its own index reflects nothing rather than 1e-16.
const INDICES: [f64; 6] = [1.0, 1.125, 1.375, 1.5, 2.5, 0.75];

fn pick<T: Copy>(rng: &mut Rng, of: &[T]) -> T {
    of[rng.below(of.len())]
}

fn chance(rng: &mut Rng, share: f32) -> bool {
    rng.unit() < share
}

fn colour(rng: &mut Rng) -> Rgb {
    Rgb::new(rng.unit(), rng.unit(), rng.unit())
}

fn between(rng: &mut Rng, lo: f32, hi: f32) -> f32 {
    lo + (hi - lo) * rng.unit()
}

/// A picture that changes slowly enough for rounding of texture coordinates not to matter.
fn picture(rng: &mut Rng, width: u32, height: u32) -> Texture {
    let pixels = (0..width * height).map(|_| colour(rng)).collect::<Vec<_>>();
    Texture::new("random", width, height, pixels)
}

/// The scene of a seed, and the Fresnel formula to render it with.
pub fn scene(seed: u64) -> (Scene, FresnelModel) {
    let rng = &mut Rng::new(seed);
    let mut scene = empty(0.0);
    scene.textures = vec![picture(rng, 5, 4), picture(rng, 8, 4)];
    media(rng, &mut scene);
    for _ in 0..6 {
        let material = material(rng, &scene);
        scene.materials.push(material);
    }
    things(rng, &mut scene);
    environment(rng, &mut scene);
    for _ in 0..rng.below(4) {
        let light = light(rng);
        scene.lights.push(light);
    }
    scene.ambient = colour(rng);
    view(rng, &mut scene);
    (scene, pick(rng, &[FresnelModel::Exact, FresnelModel::Exact, FresnelModel::Schlick, FresnelModel::Off]))
}

fn media(rng: &mut Rng, scene: &mut Scene) {
    if chance(rng, 0.2) {
        scene.media[0].ior = 1.375;
        scene.media[0].absorption = colour(rng) * 0.1;
        scene.media[0].priority = pick(rng, &[i32::MIN, 0]);
    }
    for _ in 0..1 + rng.below(4) {
        let absorption = if chance(rng, 0.5) { Rgb::ZERO } else { colour(rng) * 2.0 };
        let (ior, priority) = (pick(rng, &INDICES), rng.below(4) as i32 - 1);
        scene.media.push(Medium { name: "random".into(), ior, dispersion: Dispersion::None, absorption, priority });
    }
}

fn interface(rng: &mut Rng, scene: &Scene) -> Interface {
    let rule = if chance(rng, 0.8) { FresnelRule::Fresnel } else { FresnelRule::Fixed(colour(rng)) };
    let tint = if chance(rng, 0.5) { Rgb::ONE } else { colour(rng) };
    let ior = pick(rng, &INDICES) as f32;
    match rng.below(12) {
        0 | 1 => Interface::Opaque,
        2 => Interface::Mirror { reflectance: colour(rng), source: MirrorSource::Traced },
        3 => Interface::Mirror { reflectance: colour(rng), source: MirrorSource::Environment },
        4 => Interface::Conductor { eta: colour(rng) * 2.0 + 0.05, k: colour(rng) * 4.0 },
        5 => Interface::Coated { ior },
        6 => Interface::ThinDielectric { ior, rule, tint },
        7 => Interface::Alpha { opacity: rng.unit(), mask: chance(rng, 0.5).then_some(0) },
        _ => Interface::Dielectric { medium: rng.below(scene.media.len()) as u32, rule, tint },
    }
}

fn material(rng: &mut Rng, scene: &Scene) -> Material {
    let diffuse = match rng.below(6) {
        0 | 1 => Colour::Constant(Rgb::ZERO),
        2 => Colour::Image { texture: 0, scale: colour(rng) },
        3 => {
            let (even, odd, offset) = (colour(rng), colour(rng), rng.point());
            Colour::Checker { even, odd, size: between(rng, 0.3, 1.0), offset }
        }
        _ => Colour::Constant(colour(rng)),
    };
    let model = pick(rng, &[HighlightModel::Phong, HighlightModel::BlinnPhong]);
    let highlight = Highlight { colour: colour(rng), exponent: pick(rng, &[0.0, 1.0, 4.0, 12.0]), model };
    Material {
        name: "random".into(),
        ambient: if chance(rng, 0.5) { colour(rng) * 0.3 } else { Rgb::ZERO },
        diffuse,
        highlight: chance(rng, 0.3).then_some(highlight),
        emission: if chance(rng, 0.2) { colour(rng) } else { Rgb::ZERO },
        glow: None,
        relief: None,
        interface: interface(rng, scene),
    }
}

fn mesh(rng: &mut Rng) -> TriMesh {
    let profile = [[0.0, -1.0], [0.5, -1.0], [0.3, 0.0], [0.6, 0.8], [0.0, 0.7]];
    let waves = [Wave { amplitude: 0.1, wavelength: 0.9, direction: 20.0, phase: 0.0 }];
    match rng.below(8) {
        0 | 1 => shapes::cuboid(1 + rng.below(2) as u32),
        2 => shapes::sphere(4 + rng.below(6) as u32),
        3 => shapes::torus(0.7, 0.3, 12),
        4 => shapes::lathe(&profile, 10, 50.0).expect("a sound profile"),
        5 => shapes::disc(9),
        6 => shapes::grid(2),
        _ => shapes::heightfield([2.0, 2.0], &waves, 0.0, Some(0.5), 6).expect("sound waves"),
    }
}

/// Shapes, many of them around the same place, so that they nest and overlap.
fn things(rng: &mut Rng, scene: &mut Scene) {
    let mut at = Vec3::ZERO;
    for _ in 0..2 + rng.below(5) {
        // Never quite the same place: where surfaces coincide, rounding decides which is met.
        at = if chance(rng, 0.6) { rng.point() } else { at + rng.point() * 0.01 };
        let size = between(rng, 0.2, 1.2);
        let material = rng.below(scene.materials.len()) as u32;
        match rng.below(10) {
            0..3 => sphere(scene, at, size, material),
            3 => {
                let normal = pick(rng, &[Vec3::Y, Vec3::Y, Vec3::Z, Vec3::X]);
                let normal = if chance(rng, 0.4) { rng.direction().normalize() } else { normal };
                plane(scene, at - normal * 1.5, normal, material);
            }
            _ => {
                let mut mesh = mesh(rng);
                if chance(rng, 0.4) {
                    (mesh.normals, mesh.normal_indices) = Default::default();
                }
                if chance(rng, 0.3) {
                    (mesh.uvs, mesh.uv_indices) = Default::default();
                }
                let turn = if chance(rng, 0.3) {
                    Quat::IDENTITY
                } else {
                    Quat::from_axis_angle(rng.direction().normalize(), rng.unit() * 6.0)
                };
                let place = Mat4::from_scale_rotation_translation(Vec3::splat(size), turn, at);
                mesh.positions.iter_mut().for_each(|p| *p = place.transform_point3(*p));
                mesh.normals.iter_mut().for_each(|n| *n = (turn * *n).normalize());
                add(scene, Shape::Mesh(mesh), material);
            }
        }
    }
}

fn environment(rng: &mut Rng, scene: &mut Scene) {
    scene.environment = match rng.below(3) {
        0 => Environment::Constant(colour(rng)),
        1 => Environment::Gradient { nadir: colour(rng), horizon: colour(rng), zenith: colour(rng) },
        _ => Environment::LatLong { texture: 1, scale: colour(rng), rotation: rng.signed() * 7.0 },
    };
}

fn light(rng: &mut Rng) -> Light {
    let position = rng.direction() * between(rng, 2.0, 4.0);
    let towards = rng.point() - position;
    let outer = between(rng, 0.3, 0.95);
    let kind = match rng.below(3) {
        0 => LightKind::Point { position },
        1 => LightKind::Directional { direction: towards.normalize() },
        _ => LightKind::Spot {
            position,
            direction: towards.normalize(),
            cos_inner: between(rng, outer, 0.99),
            cos_outer: outer,
        },
    };
    let falloff = pick(rng, &[Falloff::InverseSquare, Falloff::None]);
    Light { name: "random".into(), kind, intensity: colour(rng) * 3.0, falloff, shadows: chance(rng, 0.8) }
}

fn view(rng: &mut Rng, scene: &mut Scene) {
    let inside = chance(rng, 0.2);
    let eye = if inside { rng.point() * 0.5 } else { rng.direction() * between(rng, 3.0, 6.0) };
    let target = rng.point() * 0.3;
    let projection = if chance(rng, 0.25) {
        Projection::Orthographic { height: 3.0 }
    } else {
        Projection::Pinhole { vfov: if inside { 80.0 } else { 35.0 } }
    };
    let medium = chance(rng, 0.15).then(|| rng.below(scene.media.len()) as u32);
    scene.camera = Camera { eye, target, up: Vec3::Y, projection, medium };
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.samples) = (24, 18, 1 + rng.below(2) as u32);
    settings.max_depth = rng.below(13) as u32;
    settings.cutoff = pick(rng, &[0.0, 1e-3, 0.05]);
    settings.shadows = pick(rng, &[ShadowRule::Opaque, ShadowRule::Straight, ShadowRule::Straight]);
}
