//! Lights that shine on surfaces.

use glam::Vec3;

use super::Rgb;

/// A light. It is not seen itself; emissive surfaces are seen and light nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The name messages use.
    pub name: String,
    /// Where it shines from.
    pub kind: LightKind,
    /// Intensity `I` per channel: radiant intensity of a point or spot light (power per steradian), irradiance on a
    /// facing surface for a directional one. A lamp with an extent shares it out evenly over its surface: `I` is what it
    /// sends into every direction as a whole, or, of a rectangle that shines by the cosine, along its normal. Its
    /// radiance is `I / (pi radius^2)`, or `I / area`.
    pub intensity: Rgb,
    /// How it weakens, and in which convention surfaces answer.
    pub falloff: Falloff,
    /// Whether surfaces between cast shadows.
    pub shadows: bool,
}

/// Where a light shines from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From a point, equally in all directions.
    Point {
        /// Place, in scene units.
        position: Vec3,
    },
    /// From a point, within a cone.
    Spot {
        /// Place, in scene units.
        position: Vec3,
        /// Unit axis of the cone, along the light.
        direction: Vec3,
        /// Cosine of the half angle up to which it is at full strength.
        cos_inner: f32,
        /// Cosine of the half angle from which it is dark; at most `cos_inner`. Between them the factor is
        /// `s * s * (3 - 2 s)`, `s = (cos - cos_outer) / (cos_inner - cos_outer)`.
        cos_outer: f32,
    },
    /// From infinitely far.
    Directional {
        /// Unit direction the light travels in.
        direction: Vec3,
    },
    /// From a ball of even radiance, equally in all directions. A point inside it gets none of its light.
    Sphere {
        /// Centre, in scene units.
        position: Vec3,
        /// Radius, in scene units, above zero.
        radius: f32,
    },
    /// From a rectangle, or any other parallelogram.
    Rectangle {
        /// One corner, in scene units.
        corner: Vec3,
        /// The edges from there, in scene units, not parallel. Their vector product points to the side that shines.
        edges: [Vec3; 2],
        /// How it shines into different directions.
        spread: Spread,
    },
}

impl LightKind {
    /// Whether it has an extent, and its shadows soft edges.
    #[must_use]
    pub fn is_extended(&self) -> bool {
        matches!(self, Self::Sphere { .. } | Self::Rectangle { .. })
    }

    /// Where it stands, its middle where it has an extent; none where it shines from infinitely far.
    #[must_use]
    pub fn position(&self) -> Option<Vec3> {
        match *self {
            Self::Point { position } | Self::Spot { position, .. } | Self::Sphere { position, .. } => Some(position),
            Self::Rectangle { corner, edges, .. } => Some(corner + (edges[0] + edges[1]) * 0.5),
            Self::Directional { .. } => None,
        }
    }
}

/// How a rectangle shines into different directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// As a matt surface does: by the cosine to its normal, on one side only.
    Cosine,
    /// Equally in all directions and on both sides, as a sheet of point lights would (and POV-Ray's area lights do).
    Even,
}

/// How a light weakens with distance, and which convention a Lambert surface of albedo `a` answers it in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Physical: a point or spot light at distance `d` gives `a / pi * I * cos_theta / d^2`; a directional one
    /// `a / pi * I * cos_theta`. A highlight gets `ks * I / d^2 * lobe` (no `pi`: its lobe is not normalised).
    InverseSquare,
    /// The lecture notes' (and POV-Ray's) classic model: `a * I * cos_theta` at any distance, without `pi`;
    /// a highlight gets `ks * I * lobe`.
    None,
}
