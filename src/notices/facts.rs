//! The input that all checks share.

use std::path::Path;

use crate::geometry::{Aabb, Shape};
use crate::load::LoadReport;
use crate::render::Options;
use crate::scene::{Material, Scene};

/// A scene as it was loaded, and the options of its picture.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// The scene or model file, as the user named it.
    pub file: &'a Path,
    /// The scene, with the settings that the picture is made with.
    pub scene: &'a Scene,
    /// Report of the loader.
    pub report: &'a LoadReport,
    /// Options of the render.
    pub options: &'a Options,
}

impl<'a> Facts<'a> {
    /// Material of an object.
    #[must_use]
    pub fn material(&self, object: usize) -> &'a Material {
        &self.scene.materials[self.scene.objects[object].material as usize]
    }

    /// Name of an object, quoted.
    #[must_use]
    pub fn name(&self, object: usize) -> String {
        format!("`{}`", self.scene.objects[object].name)
    }

    /// Bounds of an object: empty for planes and for what no ray can hit.
    #[must_use]
    pub fn bounds(&self, object: usize) -> Aabb {
        match &self.scene.geometry[object].shape {
            Shape::Mesh(mesh) => {
                let usable = (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i));
                usable.fold(Aabb::EMPTY, |bounds, i| mesh.corners(i).into_iter().fold(bounds, Aabb::with))
            }
            Shape::Sphere(sphere) if sphere.is_usable() => sphere.bounds(),
            Shape::Sphere(_) | Shape::Plane(_) => Aabb::EMPTY,
        }
    }
}
