//! Lights that illuminate surfaces.

use glam::Vec3;

use super::Rgb;

/// Lamp. It is not visible itself. What else lights surfaces is the setting [`super::LightsFrom`].
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name used in messages.
    pub name: String,
    /// Position and shape.
    pub kind: LightKind,
    /// Intensity `I` per channel. For a point or spot light it is the radiant intensity (power per steradian), for a
    /// directional light the irradiance on a facing surface. An area lamp spreads it evenly over its surface: `I` is
    /// the intensity of the whole lamp in every direction or, for a rectangle with cosine emission, along its normal.
    /// Its radiance is `I / (pi radius^2)` or `I / area`.
    pub intensity: Rgb,
    /// Attenuation with distance, and the convention for reflection.
    pub falloff: Falloff,
    /// True if surfaces cast shadows in this light.
    pub shadows: bool,
}

/// Position and shape of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Point light, equal in all directions.
    Point {
        /// Position in scene units.
        position: Vec3,
    },
    /// Point light within a cone.
    Spot {
        /// Position in scene units.
        position: Vec3,
        /// Unit axis of the cone, along the light.
        direction: Vec3,
        /// Cosine of the half angle up to which the light has full strength.
        cos_inner: f32,
        /// Cosine of the half angle from which it is dark; at most `cos_inner`. Between them the factor is `s * s * (3
        /// - 2 s)`, `s = (cos - cos_outer) / (cos_inner - cos_outer)`.
        cos_outer: f32,
    },
    /// Light from infinitely far away.
    Directional {
        /// Unit direction of travel.
        direction: Vec3,
    },
    /// Ball of even radiance, equal in all directions. Points inside it receive none of its light.
    Sphere {
        /// Centre, in scene units.
        position: Vec3,
        /// Radius, in scene units, above zero.
        radius: f32,
    },
    /// Rectangle, or any other parallelogram.
    Rectangle {
        /// One corner, in scene units.
        corner: Vec3,
        /// Edge vectors from that corner, in scene units, not parallel. Their cross product points to the emitting
        /// side.
        edges: [Vec3; 2],
        /// Emission by direction.
        spread: Spread,
    },
}

impl LightKind {
    /// Returns true if the light has an extent, and thus soft shadows.
    #[must_use]
    pub fn is_extended(&self) -> bool {
        matches!(self, Self::Sphere { .. } | Self::Rectangle { .. })
    }

    /// Returns the position, or the middle of an area lamp; `None` for a directional light.
    #[must_use]
    pub fn position(&self) -> Option<Vec3> {
        match *self {
            Self::Point { position } | Self::Spot { position, .. } | Self::Sphere { position, .. } => Some(position),
            Self::Rectangle { corner, edges, .. } => Some(corner + (edges[0] + edges[1]) * 0.5),
            Self::Directional { .. } => None,
        }
    }
}

/// Emission of a rectangle by direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// By the cosine to the normal, on one side only, as a matt surface emits.
    Cosine,
    /// Equal in all directions and on both sides, like a sheet of point lights (and POV-Ray's area lights).
    Even,
}

/// Attenuation with distance, and the convention for a Lambertian surface of albedo `a`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Physical. A point or spot light at distance `d` gives `a / pi * I * cos_theta / d^2`, a directional one `a / pi
    /// * I * cos_theta`. A highlight gets `ks * I / d^2 * lobe` (no `pi`, because the lobe is not normalised).
    InverseSquare,
    /// Classic model of the lecture notes (and POV-Ray): `a * I * cos_theta` at any distance, without `pi`; a highlight
    /// gets `ks * I * lobe`.
    None,
}
