//! Input shared by all checks.

use std::path::Path;

use glam::{DVec3, Vec3};

use crate::geometry::{Aabb, Shape, TriMesh};
use crate::load::LoadReport;
use crate::render::Options;
use crate::scene::{Material, Scene};

/// Returns true if a ray can hit a triangle of a mesh: its corners are finite and not collinear.
#[must_use]
pub(super) fn has_area(mesh: &TriMesh, triangle: usize) -> bool {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
    mesh.is_usable(triangle) && (b - a).cross(c - a) != DVec3::ZERO
}

/// Scene as loaded, with the options of its picture.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// Scene or model file, as named by the user.
    pub file: &'a Path,
    /// Scene, with the settings of the picture.
    pub scene: &'a Scene,
    /// Report of the loader.
    pub report: &'a LoadReport,
    /// Options of the render.
    pub options: &'a Options,
}

impl<'a> Facts<'a> {
    /// Returns the material of an object.
    #[must_use]
    pub fn material(&self, object: usize) -> &'a Material {
        &self.scene.materials[self.scene.objects[object].material as usize]
    }

    /// Returns the name of an object in backquotes.
    #[must_use]
    pub fn name(&self, object: usize) -> String {
        format!("`{}`", self.scene.objects[object].name)
    }

    /// Returns the bounds of an object; empty for planes and for objects that no ray can hit.
    #[must_use]
    pub fn bounds(&self, object: usize) -> Aabb {
        match &self.scene.geometry[object].shape {
            Shape::Mesh(mesh) => {
                let usable = (0..mesh.triangles.len()).filter(|&i| has_area(mesh, i));
                usable.fold(Aabb::EMPTY, |bounds, i| mesh.corners(i).into_iter().fold(bounds, Aabb::with))
            }
            Shape::Sphere(sphere) if sphere.is_usable() => sphere.bounds(),
            Shape::Sphere(_) | Shape::Plane(_) => Aabb::EMPTY,
        }
    }
}
