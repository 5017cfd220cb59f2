//! The viewpoint.

use glam::Vec3;

use super::MapKind;

/// A camera. The picture's x runs right and y down; the middle of the picture looks from `eye` at `target`.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands, in scene units.
    pub eye: Vec3,
    /// What the middle of the picture shows; differs from `eye`.
    pub target: Vec3,
    /// Which way is up; not parallel to the view.
    pub up: Vec3,
    /// How directions map to the picture.
    pub projection: Projection,
    /// The medium the eye is in, where the scene names it; else found from the shapes around the eye.
    pub medium: Option<u32>,
}

/// How directions map to the picture.
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
