//! Recorded ray of a pixel.

use glam::DVec3;

use super::Node;
use crate::render::RayKind;

/// Recorded ray, from its origin to its hit.
#[derive(Clone, Debug)]
pub struct Event {
    /// Ray whose surface sent it; `None` for a camera ray.
    pub parent: Option<Node>,
    /// Purpose of the ray.
    pub kind: RayKind,
    /// Number of reflections and refractions before it.
    pub depth: u32,
    /// Origin, in scene units, offset from the surface it left.
    pub origin: DVec3,
    /// Unit direction.
    pub dir: DVec3,
    /// Throughput per channel at the origin.
    pub weight: DVec3,
    /// Media around it, as indices into `Scene::media`, highest priority last. Empty in the medium that surrounds
    /// everything.
    pub media: Vec<u32>,
    /// Distance to the hit; infinite for a miss.
    pub t: f64,
    /// Throughput at the hit, after absorption.
    pub arrived: DVec3,
    /// Result of the intersection.
    pub met: Met,
    /// Division of light at the surface; `None` without a surface.
    pub split: Option<Split>,
    /// Contributions to the pixel at this hit.
    pub shares: Vec<Share>,
    /// Secondary rays that were not sent.
    pub cut: Vec<Cut>,
}

impl Event {
    /// Creates the record of a ray that has not been traced yet.
    #[must_use]
    pub fn sent(parent: Option<Node>, kind: RayKind, depth: u32, line: (DVec3, DVec3), weight: DVec3) -> Self {
        Self {
            parent,
            kind,
            depth,
            origin: line.0,
            dir: line.1,
            weight,
            media: Vec::new(),
            t: f64::INFINITY,
            arrived: weight,
            met: Met::Nothing,
            split: None,
            shares: Vec::new(),
            cut: Vec::new(),
        }
    }

    /// Returns the object that was hit, as an index into `Scene::objects`.
    #[must_use]
    pub fn object(&self) -> Option<u32> {
        match self.met {
            Met::Absent { object, .. } | Met::Surface { object, .. } => Some(object),
            Met::Nothing | Met::Spent => None,
        }
    }
}

/// Result of a ray's intersection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Met {
    /// Miss; the ray sees the environment.
    Nothing,
    /// Full absorption on the way to the hit, if any.
    Spent,
    /// Surface inside a medium of higher priority, which the ray passes.
    Absent {
        /// Index into `Scene::objects`.
        object: u32,
        /// Triangle within a mesh; 0 on other shapes.
        primitive: u32,
        /// Position in scene units.
        point: DVec3,
    },
    /// Surface that was shaded.
    Surface {
        /// Index into `Scene::objects`.
        object: u32,
        /// Triangle within a mesh; 0 on other shapes.
        primitive: u32,
        /// Position in scene units.
        point: DVec3,
        /// True if the ray arrived from outside.
        front: bool,
        /// Cosine of the angle of incidence, to the shading normal.
        cos_i: f64,
    },
}

/// Division of the arriving light at a surface, in shares per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Refractive indices on the ray's side and behind; `None` if the surface bounds no media.
    pub indices: Option<(f64, f64)>,
    /// Cosine of the angle of refraction; `None` where light is not bent.
    pub cos_t: Option<f64>,
    /// True if reflection is total.
    pub total: bool,
    /// Share of the reflected ray.
    pub reflected: DVec3,
    /// Share of the transmitted ray, after tint.
    pub transmitted: DVec3,
    /// Share that goes no further: taken by an opaque base, a tint or a metal.
    pub absorbed: DVec3,
}

impl Split {
    /// Division at an opaque surface, where no light continues.
    pub const OPAQUE: Self = Self {
        indices: None,
        cos_t: None,
        total: false,
        reflected: DVec3::ZERO,
        transmitted: DVec3::ZERO,
        absorbed: DVec3::ONE,
    };

    /// Returns the sum of all shares. It is 1, up to rounding, where energy is conserved.
    #[must_use]
    pub fn sum(&self) -> DVec3 {
        self.reflected + self.transmitted + self.absorbed
    }
}

/// Contribution to the pixel, including light that was blocked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Source of the light.
    pub source: Source,
    /// Contribution without occlusion.
    pub unshadowed: DVec3,
    /// Contribution as added, with all weights.
    pub radiance: DVec3,
    /// Object that blocks a lamp, as an index into `Scene::objects`.
    pub blocker: Option<u32>,
}

impl Share {
    /// Creates a contribution that cannot be occluded.
    #[must_use]
    pub fn free(source: Source, radiance: DVec3) -> Self {
        Self { source, unshadowed: radiance, radiance, blocker: None }
    }
}

/// Source of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Environment seen by a ray that hit nothing.
    Environment,
    /// Environment looked up by a mirror.
    MirroredEnvironment,
    /// Emission and reflected ambient light of the surface.
    Glow,
    /// Light, as an index into `Scene::lights`.
    Light(u32),
    /// Emissive shapes and sampled lamps that light the surface.
    Emitters,
    /// Environment that lights the surface.
    Sky,
}

impl Source {
    /// Returns true if objects cast shadows in this light.
    #[must_use]
    pub fn is_shadowed(self) -> bool {
        matches!(self, Self::Light(_) | Self::Emitters | Self::Sky)
    }
}

/// Secondary ray that was not sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Purpose it would have had.
    pub kind: RayKind,
    /// Throughput it would have had, which counts as truncated.
    pub weight: DVec3,
    /// True if the depth limit ended the ray. Neither this nor `too_light` is set if it passed too many surfaces.
    pub too_deep: bool,
    /// True if its weight was below the cut-off.
    pub too_light: bool,
}
