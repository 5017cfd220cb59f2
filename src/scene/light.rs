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
    /// facing surface for a directional one.
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
