//! Scene description: plain data joined by indices.

mod body;
mod build;
mod camera;
mod content;
mod dispersion;
mod environment;
mod light;
pub mod map;
mod material;
pub mod ranges;
mod settings;
mod shine;
mod texels;
mod texture;
mod validate;

pub use body::Bodies;
pub use camera::{Camera, Projection};
pub use content::Content;
pub use dispersion::Dispersion;
pub use environment::Environment;
pub use light::{Falloff, Light, LightKind, Spread};
pub use map::MapKind;
pub use material::{Colour, FresnelRule, Highlight, HighlightModel, Interface, Material, Medium, MirrorSource, Relief};
pub use settings::{LampChoice, LampSampling, LightsFrom, Pattern, Settings, ShadowRule};
pub use shine::Shining;
pub use texels::Texels;
pub use texture::{Beyond, Texture, Wrap};
pub use validate::{Part, SceneEntry, SceneError};

use glam::DVec3;

use crate::Result;
use crate::geometry::{Geometry, Shape, TriMesh};
use crate::system::memory;

/// Most consecutive surfaces that a ray passes without a reflection or refraction, in both renderers. Longer chains end as
/// truncated weight, or block light.
pub const MOST_PASSES: u32 = 256;

/// Linear red, green and blue, as a radiance or a factor.
pub type Rgb = glam::Vec3;

/// A whole scene: lists of plain data that refer to each other by index.
///
/// The `add_` methods return indices; `load` reads a whole scene. [`Scene::validate`] checks a scene that was put together by
/// hand, for the renderers take valid ones only and may panic on others. A default scene holds air and nothing else.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Shapes; a hit's `geometry` is an index into this list.
    pub geometry: Vec<Geometry>,
    /// Names and materials, one for each shape in `geometry`.
    pub objects: Vec<Object>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Media. Medium 0 surrounds everything (air, index 1, unless the scene says otherwise).
    pub media: Vec<Medium>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Radiance for rays that hit nothing.
    pub environment: Environment,
    /// Ambient colour, multiplied by each surface's ambient factor; zero by default.
    pub ambient: Rgb,
    /// Pictures for colour lookups.
    pub textures: Vec<Texture>,
    /// Camera.
    pub camera: Camera,
    /// Settings of the picture.
    pub settings: Settings,
    /// World coordinates of the scene's origin, in scene units. It is 0 unless the scene lies far from the world's
    /// origin.
    pub origin: DVec3,
    /// Exponent of the scene unit: a length of 1 in the scene is 2 to this power in the world. It is 0 unless a model
    /// is too small or too large for `f32`.
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

/// Numbers of primitives by kind.
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
    /// Returns a copy, where there is memory for one.
    ///
    /// # Errors
    /// Fails with [`Error::Limit`](crate::Error::Limit) where there is not.
    pub fn try_clone(&self) -> Result<Self> {
        memory::need("a copy of the scene", self.bytes(), "take a smaller model or smaller pictures")?;
        Ok(self.clone())
    }

    /// Returns the bytes of the lists that grow with models and pictures.
    fn bytes(&self) -> u64 {
        let pictures: usize = self.textures.iter().map(|t| t.pixels.bytes()).sum();
        let lines: usize = self.objects.iter().map(|o| size_of_val(o.origin.triangle_lines.as_slice())).sum();
        let meshes =
            self.geometry.iter().filter_map(|g| if let Shape::Mesh(mesh) = &g.shape { Some(mesh) } else { None });
        (pictures + lines + meshes.map(TriMesh::bytes).sum::<usize>()) as u64
    }

    /// Returns the world coordinates of a point of the scene, as used in reports.
    #[must_use]
    pub fn world(&self, place: DVec3) -> DVec3 {
        self.origin + place * self.unit()
    }

    /// Returns the length in the world of 1 in the scene.
    #[must_use]
    pub fn unit(&self) -> f64 {
        f64::from(self.unit_exponent).exp2()
    }

    /// Returns true if scene coordinates are world coordinates.
    #[must_use]
    pub fn is_in_world_coordinates(&self) -> bool {
        self.origin == DVec3::ZERO && self.unit_exponent == 0
    }

    /// Returns the numbers of primitives by kind, including those that no ray can hit.
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

/// Name and material of one shape.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name used in messages.
    pub name: String,
    /// Index of the material in [`Scene::materials`].
    pub material: u32,
    /// File and line it was read from, for messages.
    pub origin: Origin,
}

/// File and lines from which a shape was read.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// File as named in messages; empty for shapes made in memory.
    pub file: String,
    /// Line of the whole shape in a scene file, from 1; 0 if unknown.
    pub line: u32,
    /// Line of each triangle in a model file, from 1; empty for built-in shapes.
    pub triangle_lines: Vec<u32>,
}
