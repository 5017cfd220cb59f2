//! What is to be pictured: plain data, joined by indices.

mod body;
mod build;
mod camera;
mod dispersion;
mod environment;
mod light;
mod material;
pub mod ranges;
mod settings;
mod texture;
mod validate;

pub use body::Bodies;
pub use camera::{Camera, Projection};
pub use dispersion::Dispersion;
pub use environment::Environment;
pub use light::{Falloff, Light, LightKind, Spread};
pub use material::{Colour, FresnelRule, Highlight, HighlightModel, Interface, Material, Medium, MirrorSource};
pub use settings::{LampSampling, Pattern, Settings, ShadowRule};
pub use texture::{Beyond, Texture};
pub use validate::{Part, Place, SceneError};

use glam::DVec3;

use crate::geometry::{Geometry, Shape};

/// Linear red, green and blue; radiance or a factor as its place says.
pub type Rgb = glam::Vec3;

/// A whole scene: lists of plain data that refer to each other by index.
///
/// The `add_` methods return indices; `load` reads a whole scene. [`Scene::validate`] checks a scene that was put together by
/// hand, for the renderers take valid ones only and may panic on others. A default scene holds air and nothing else.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Shapes; a hit's `geometry` is a place in this list.
    pub geometry: Vec<Geometry>,
    /// What each shape is, one for one with `geometry`.
    pub objects: Vec<Object>,
    /// Surfaces.
    pub materials: Vec<Material>,
    /// What fills space. Medium 0 is what surrounds everything (air, index 1, unless the scene says otherwise).
    pub media: Vec<Medium>,
    /// Lights that cast light on surfaces.
    pub lights: Vec<Light>,
    /// What rays that meet nothing see.
    pub environment: Environment,
    /// Colour that every surface's ambient factor is multiplied with; zero by default.
    pub ambient: Rgb,
    /// Pictures to look colours up in.
    pub textures: Vec<Texture>,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// How the picture is taken.
    pub settings: Settings,
    /// World coordinates of the place that counts as (0, 0, 0) in all of the above, in scene units: 0 unless the scene
    /// lies far from the world's own.
    pub origin: DVec3,
    /// A length of 1 in all of the above is 2 to this power in the world: 0 unless a model by itself is too small or too large
    /// for `f32` to reckon with.
    pub unit_exponent: i32,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            geometry: Vec::new(),
            objects: Vec::new(),
            materials: Vec::new(),
            media: vec![Medium::air()],
            lights: Vec::new(),
            environment: Environment::default(),
            ambient: Rgb::ZERO,
            textures: Vec::new(),
            camera: Camera::default(),
            settings: Settings::default(),
            origin: DVec3::ZERO,
            unit_exponent: 0,
        }
    }
}

/// How many primitives of each kind a scene holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShapeCounts {
    /// Triangles of all meshes.
    pub triangles: u64,
    /// Analytic spheres.
    pub spheres: u64,
    /// Infinite planes.
    pub planes: u64,
}

impl Scene {
    /// World coordinates of a place in the scene: what reports tell.
    #[must_use]
    pub fn world(&self, place: DVec3) -> DVec3 {
        self.origin + place * self.unit()
    }

    /// Length in the world of 1 in the scene.
    #[must_use]
    pub fn unit(&self) -> f64 {
        f64::from(self.unit_exponent).exp2()
    }

    /// Returns true if its coordinates are those of the world.
    #[must_use]
    pub fn is_in_world_coordinates(&self) -> bool {
        self.origin == DVec3::ZERO && self.unit_exponent == 0
    }

    /// How many primitives of each kind there are, hittable or not.
    #[must_use]
    pub fn shape_counts(&self) -> ShapeCounts {
        let mut counts = ShapeCounts::default();
        for geometry in &self.geometry {
            match &geometry.shape {
                Shape::Mesh(mesh) => counts.triangles += mesh.triangles.len() as u64,
                Shape::Sphere(_) => counts.spheres += 1,
                Shape::Plane(_) => counts.planes += 1,
            }
        }
        counts
    }
}

/// One shape's place in the scene.
#[derive(Clone, Debug)]
pub struct Object {
    /// The name messages use.
    pub name: String,
    /// Its surface, a place in [`Scene::materials`].
    pub material: u32,
    /// Where it comes from, for messages.
    pub origin: Origin,
}

/// Where a shape was read.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// The file as messages name it; empty for shapes made in memory.
    pub file: String,
    /// Line of the whole shape (in a scene file), from 1; 0 where unknown.
    pub line: u32,
    /// Line of each triangle (in a model file), from 1; empty for built-in shapes.
    pub triangle_lines: Vec<u32>,
}
