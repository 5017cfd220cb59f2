//! What surrounds the scene.

use super::{MapKind, Rgb};

/// Radiance by direction, for rays that meet nothing. Seen directly and in reflection and refraction; it lights no
/// diffuse surface (use ambient for that).
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    /// The same from everywhere.
    Constant(Rgb),
    /// Blended by height: with `s = (dir.y + 1) / 2`, linear from `nadir` (s = 0) over `horizon` (s = 1/2) to
    /// `zenith` (s = 1).
    Gradient {
        /// Straight down.
        nadir: Rgb,
        /// Level.
        horizon: Rgb,
        /// Straight up.
        zenith: Rgb,
    },
    /// An equirectangular picture: its top row is straight up (+y); its middle column is towards -z, and columns
    /// advance towards +x.
    LatLong {
        /// Place in `Scene::textures`.
        texture: u32,
        /// Factor on the picture.
        scale: Rgb,
        /// Turn about +y, in radians, from -z towards +x.
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
