//! Scenes that hold every kind of surface, made from a seed.

use glam::Vec3;
use vitrum::scene::{
    Colour, Falloff, FresnelRule, Highlight, HighlightModel, Interface, Light, LightKind, Material, MirrorSource, Rgb,
    Scene,
};

use crate::support::scenes::{add, bare, cuboid_mesh, empty, glass, material, plane, sphere};

pub struct Rng(u64);

impl Rng {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u32 << 24) as f32
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub fn vector(&mut self, low: f32, high: f32) -> Vec3 {
        Vec3::new(self.between(low, high), self.between(low, high), self.between(low, high))
    }
}

/// Glass, panes, metals, mirrors, coats and holes over a checkered floor, with two lamps and a sky.
pub fn scene(seed: u64) -> Scene {
    let mut rng = Rng::new(seed);
    let mut scene = empty(0.0);
    scene.environment = vitrum::scene::Environment::Gradient {
        nadir: rng.vector(0.0, 0.3),
        horizon: rng.vector(0.5, 1.0),
        zenith: rng.vector(0.2, 1.5),
    };
    (scene.settings.width, scene.settings.height) = (24, 24);
    scene.settings.max_depth = 8;
    let checker = Colour::Checker { even: rng.vector(0.5, 1.0), odd: rng.vector(0.0, 0.4), size: 0.7, offset: Vec3::Y };
    let highlight = Highlight { colour: rng.vector(0.0, 0.3), exponent: 20.0, model: HighlightModel::Phong };
    let floor = material(&mut scene, Material { diffuse: checker, highlight: Some(highlight), ..Material::default() });
    plane(&mut scene, Vec3::new(0.0, -1.3, 0.0), Vec3::Y, floor);
    for _ in 0..7 {
        let colour = rng.vector(0.3, 1.0);
        let surface = match (rng.unit() * 8.0) as u32 {
            0 => bare(Interface::Mirror { reflectance: colour, source: MirrorSource::Traced }),
            1 => bare(Interface::Conductor { eta: rng.vector(0.1, 2.0), k: rng.vector(1.0, 4.0) }),
            2 => {
                bare(Interface::ThinDielectric { ior: rng.between(1.2, 1.8), rule: FresnelRule::Fresnel, tint: colour })
            }
            3 => Material { interface: Interface::Coated { ior: 1.5 }, ..Material::default() },
            4 => Material { interface: Interface::Alpha { opacity: rng.unit(), mask: None }, ..Material::default() },
            _ => {
                let ior = f64::from(rng.between(1.1, 2.0));
                let absorption = rng.vector(0.0, 0.4);
                let number = glass(&mut scene, ior, 0, absorption);
                scene.materials[number as usize].clone()
            }
        };
        let surface = material(&mut scene, surface);
        let centre = rng.vector(-1.2, 1.2);
        if rng.unit() < 0.6 {
            let radius = rng.between(0.3, 0.7);
            sphere(&mut scene, centre, radius, surface);
        } else {
            let half = rng.vector(0.15, 0.5);
            add(&mut scene, vitrum::geometry::Shape::Mesh(cuboid_mesh(centre - half, centre + half)), surface);
        }
    }
    for falloff in [Falloff::InverseSquare, Falloff::None] {
        let strength = if falloff == Falloff::None { 0.4 } else { 20.0 };
        scene.lights.push(Light {
            name: String::from("lamp"),
            kind: LightKind::Point { position: Vec3::new(rng.between(-3.0, 3.0), 4.0, rng.between(0.0, 3.0)) },
            intensity: Rgb::splat(strength) * rng.vector(0.5, 1.0),
            falloff,
            shadows: true,
        });
    }
    scene
}
