//! Camera of a scene.

use glam::{DVec3, Vec3};

use super::map::MapKind;

/// Camera. In the picture x runs right and y down; the middle of the picture looks from `eye` at `target`.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Position in scene units.
    pub eye: Vec3,
    /// Point shown in the middle of the picture; differs from `eye`.
    pub target: Vec3,
    /// Up direction; not parallel to the view.
    pub up: Vec3,
    /// Mapping from directions to the picture.
    pub projection: Projection,
    /// Index of the medium around the eye, if the scene names it; else it is found from the shapes.
    pub medium: Option<u32>,
}

/// Mapping from directions to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays leave one point.
    Pinhole {
        /// Full vertical angle of view, in degrees, in 0..180 (both excluded).
        vfov: f32,
    },
    /// Rays are parallel, leaving a plane through `eye`.
    Orthographic {
        /// Height of the picture in scene units, above zero.
        height: f32,
    },
    /// Rays leave one point in all directions, as the texels of an environment map show them; the camera's frame is that of
    /// the map, and the picture has its shape.
    Map(MapKind),
}

impl Camera {
    /// Returns the unit vectors to the right, up and forward in the picture.
    #[must_use]
    pub fn frame(&self) -> [DVec3; 3] {
        let forward = (self.target.as_dvec3() - self.eye.as_dvec3()).normalize();
        let right = forward.cross(self.up.as_dvec3()).normalize();
        [right, right.cross(forward), forward]
    }
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: Vec3::new(0.0, 1.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Pinhole { vfov: 40.0 },
            medium: None,
        }
    }
}
