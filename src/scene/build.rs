//! Construction of scenes by code: each method adds one element and returns its index.

use super::light::Light;
use super::material::{Interface, Material, Medium};
use super::texture::Texture;
use super::{Object, Origin, Scene};
use crate::geometry::{Geometry, GeometryMask, Shape};

/// Returns the index of the last element of a list.
///
/// # Panics
/// Panics if the list has more than `u32::MAX` entries.
fn last<T>(list: &[T]) -> u32 {
    u32::try_from(list.len() - 1).expect("a scene has at most 2^32 things of a kind")
}

impl Scene {
    /// Adds a surface. The index is for [`Scene::add_object`].
    ///
    /// # Panics
    /// Panics if the scene has 2^32 materials.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        last(&self.materials)
    }

    /// Adds a medium. The index is for [`Interface::Dielectric`] and [`Camera::medium`](super::Camera::medium); 0 is the
    /// air around everything.
    ///
    /// # Panics
    /// Panics if the scene has 2^32 media.
    pub fn add_medium(&mut self, medium: Medium) -> u32 {
        self.media.push(medium);
        last(&self.media)
    }

    /// Adds a medium and a clear surface around it, and returns the surface's index.
    ///
    /// # Panics
    /// Panics if the scene has 2^32 media or materials.
    pub fn add_dielectric(&mut self, medium: Medium) -> u32 {
        let black = Material::black(&medium.name);
        let interface = Interface::dielectric(self.add_medium(medium));
        self.add_material(Material { interface, ..black })
    }

    /// Adds a picture. The index is for [`Colour::Image`](super::Colour::Image) and
    /// [`Environment::LatLong`](super::Environment::LatLong).
    ///
    /// # Panics
    /// Panics if the scene has 2^32 textures.
    pub fn add_texture(&mut self, texture: Texture) -> u32 {
        self.textures.push(texture);
        last(&self.textures)
    }

    /// Adds a light.
    ///
    /// # Panics
    /// Panics if the scene has 2^32 lights.
    pub fn add_light(&mut self, light: Light) -> u32 {
        self.lights.push(light);
        last(&self.lights)
    }

    /// Adds a shape with the surface at index `material`. The index returned is a hit's `geometry`.
    ///
    /// The shape's mask is set by the surface: one that lets light through is transmissive, others are opaque. Change the
    /// surface's kind afterwards and the mask no longer fits; [`Scene::validate`] says so.
    ///
    /// # Panics
    /// Panics if the scene has 2^32 objects.
    pub fn add_object(&mut self, name: &str, shape: impl Into<Shape>, material: u32) -> u32 {
        let mask = self.materials.get(material as usize).map_or(GeometryMask::OPAQUE, Material::mask);
        self.geometry.push(Geometry { shape: shape.into(), mask });
        self.objects.push(Object { name: name.into(), material, origin: Origin::default() });
        last(&self.objects)
    }
}

impl Material {
    /// Returns the mask of shapes with this material.
    #[must_use]
    pub fn mask(&self) -> GeometryMask {
        if self.is_transmissive() { GeometryMask::TRANSMISSIVE } else { GeometryMask::OPAQUE }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::Sphere;

    const BALL: Sphere = Sphere { centre: Vec3::ZERO, radius: 1.0 };

    #[test]
    fn a_new_scene_is_air_and_every_addition_returns_its_place() {
        let mut scene = Scene::default();
        assert_eq!((scene.media.as_slice(), scene.validate()), ([Medium::air()].as_slice(), Ok(())));
        let matt = scene.add_material(Material::default());
        let glass = scene.add_dielectric(Medium::new("glass", 1.5));
        assert_eq!((matt, glass), (0, 1));
        assert_eq!((scene.add_object("a", BALL, glass), scene.add_object("b", BALL, matt)), (0, 1));
        let masks: Vec<GeometryMask> = scene.geometry.iter().map(|g| g.mask).collect();
        assert_eq!(masks, [GeometryMask::TRANSMISSIVE, GeometryMask::OPAQUE]);
        assert_eq!(scene.materials[1].interface, Interface::dielectric(1));
        assert_eq!(scene.validate(), Ok(()));
    }
}
