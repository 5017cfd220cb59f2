//! Options of a scene made from a single model.

use std::path::PathBuf;

use glam::DVec3;

use super::surface::Surface;
use super::transform::Transform;
use crate::scene::Rgb;

/// Axis of the model that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// +y, as in the scene.
    #[default]
    Y,
    /// +z, as in programs for construction and maps.
    Z,
}

impl Up {
    /// Returns the rotation about x, in degrees, that turns the axis to +y.
    pub(super) fn turn(self) -> DVec3 {
        match self {
            Self::Y => DVec3::ZERO,
            Self::Z => DVec3::new(-90.0, 0.0, 0.0),
        }
    }

    /// Returns the transform that turns the axis to +y.
    pub(super) fn transform(self) -> Transform {
        match self {
            Self::Y => Transform::IDENTITY,
            Self::Z => Transform::from_parts(DVec3::ONE, self.turn(), DVec3::ZERO).unwrap_or(Transform::IDENTITY),
        }
    }
}

/// Light without falloff: an intensity of 1 shows a facing white surface as white, at any distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelLight {
    /// Position, in the coordinates of the turned model.
    pub position: DVec3,
    /// Intensity.
    pub intensity: f32,
}

/// Options of a scene made from a single model. Positions are in its coordinates, after its up axis was turned to +y.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelOptions {
    /// Axis that points up.
    pub up: Up,
    /// Largest angle in degrees between faces without normals that are shaded smoothly.
    pub smooth: Option<f64>,
    /// Position of the camera; by default where all is seen.
    pub eye: Option<DVec3>,
    /// Point in the middle of the picture; by default the middle of the model.
    pub target: Option<DVec3>,
    /// Full vertical angle of view in degrees, 40 by default.
    pub fov: Option<f64>,
    /// Materials in place of some of the model, by their names there.
    pub materials: Vec<(String, Surface)>,
    /// Colour of the surroundings, in place of a sky.
    pub background: Option<Rgb>,
    /// Equirectangular picture of the surroundings, in place of a sky.
    pub environment: Option<PathBuf>,
    /// Lights in place of the usual ones.
    pub lights: Vec<ModelLight>,
}

impl ModelOptions {
    /// Returns the option of the command line that differs from its default, if any does.
    #[must_use]
    pub fn given(&self) -> Option<&'static str> {
        let all = [
            ("--up", self.up != Up::Y),
            ("--smooth", self.smooth.is_some()),
            ("--eye", self.eye.is_some()),
            ("--target", self.target.is_some()),
            ("--fov", self.fov.is_some()),
            ("--material", !self.materials.is_empty()),
            ("--background", self.background.is_some()),
            ("--environment", self.environment.is_some()),
            ("--light", !self.lights.is_empty()),
        ];
        all.into_iter().find(|(_, given)| *given).map(|(name, _)| name)
    }
}
