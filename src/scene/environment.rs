//! Environment around the scene.

use super::Rgb;
use super::map::MapKind;

/// Radiance by direction for rays that hit nothing. It is visible directly, in reflections and by refraction. It lights
/// diffuse surfaces where the setting [`super::LightsFrom`] says so.
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    /// Constant radiance.
    Constant(Rgb),
    /// Gradient by height. With `s = (dir.y + 1) / 2` it is linear from `nadir` (s = 0) over `horizon` (s = 1/2) to
    /// `zenith` (s = 1).
    Gradient {
        /// Radiance from straight down.
        nadir: Rgb,
        /// Radiance from the horizon.
        horizon: Rgb,
        /// Radiance from straight up.
        zenith: Rgb,
    },
    /// Equirectangular picture. Its top row is straight up (+y), its middle column is towards -z, and columns advance
    /// towards +x.
    LatLong {
        /// Index into `Scene::textures`.
        texture: u32,
        /// Factor on the picture's colours.
        scale: Rgb,
        /// Rotation about +y in radians, from -z towards +x.
        rotation: f32,
    },
    /// An environment map.
    Map {
        /// Its shape.
        kind: MapKind,
        /// Index in `Scene::textures`.
        texture: u32,
        /// Factor on the map.
        scale: Rgb,
        /// Turn about +y, in radians, from -z towards +x.
        rotation: f32,
    },
}

impl Default for Environment {
    fn default() -> Self {
        Self::Constant(Rgb::ZERO)
    }
}
