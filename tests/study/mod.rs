//! Choices that the study compares really differ: for each choice two levels differ by the theoretical amount, computed
//! here by hand. The ledger detects wrong light.

mod ledger;
mod theory;

use glam::Vec3;
use vitrum::accel::Backend;
use vitrum::geometry::{Geometry, GeometryMask, Plane, Shape, TriMesh};
use vitrum::render::{Observer, Outcome};
use vitrum::scene::{Camera, Environment, Material, Medium, Object, Origin, Projection, Rgb, Scene, Settings};
use vitrum::study::{Engine, Variant};

/// A scene of a few shapes seen by parallel rays, without lights.
pub struct Small {
    pub scene: Scene,
}

impl Small {
    /// Nothing in a uniform room of radiance `around`, seen from `eye` towards the origin by a picture 2 units high.
    pub fn new(eye: Vec3, around: f32) -> Self {
        let camera = Camera {
            eye,
            target: Vec3::ZERO,
            up: if eye.x == 0.0 && eye.z == 0.0 { Vec3::NEG_Z } else { Vec3::Y },
            projection: Projection::Orthographic { height: 2.0 },
            medium: None,
        };
        let settings = Settings { width: 1, height: 1, samples: 1, max_depth: 64, cutoff: 0.0, ..Settings::default() };
        let environment = Environment::Constant(Rgb::splat(around));
        Self { scene: Scene { media: vec![Medium::air()], environment, camera, settings, ..Scene::default() } }
    }

    pub fn with(mut self, shape: Shape, mask: GeometryMask, material: Material) -> Self {
        let n = self.scene.materials.len() as u32;
        self.scene.geometry.push(Geometry { shape, mask });
        self.scene.objects.push(Object { name: material.name.clone(), material: n, origin: Origin::default() });
        self.scene.materials.push(material);
        self
    }

    pub fn size(mut self, edge: u32) -> Self {
        (self.scene.settings.width, self.scene.settings.height) = (edge, edge);
        self
    }

    pub fn default(&self) -> Variant {
        Variant::of(&self.scene.settings, Backend::Native)
    }

    pub fn shoot(&self, variant: Variant) -> Outcome {
        Engine::new(&self.scene, 1).shoot(&variant, &Observer::default()).expect("nothing interrupts").outcome
    }

    /// The red of a variant's first pixel.
    pub fn value(&self, variant: Variant) -> f64 {
        f64::from(self.shoot(variant).film.pixels[0][0])
    }

    /// Mean over all pixels.
    pub fn mean(&self, variant: Variant) -> f64 {
        let film = self.shoot(variant).film;
        film.pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / film.pixels.len() as f64
    }
}

pub fn plane(y: f32, normal: Vec3) -> Shape {
    Shape::Plane(Plane { point: Vec3::Y * y, normal })
}

/// Two triangles, facing up.
pub fn quad(corners: [Vec3; 4]) -> Shape {
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    Shape::Mesh(TriMesh { positions: corners.to_vec(), triangles, ..TriMesh::default() })
}
