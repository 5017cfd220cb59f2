//! One ray of a recorded pixel.

use glam::DVec3;

use super::Node;
use crate::render::RayKind;

/// A ray from where it was sent to what it met there.
#[derive(Clone, Debug)]
pub struct Event {
    /// The ray whose surface sent it; none for a camera ray.
    pub parent: Option<Node>,
    /// What it was sent for.
    pub kind: RayKind,
    /// How often light was reflected or refracted before it.
    pub depth: u32,
    /// Start, in scene units, off the surface it left.
    pub origin: DVec3,
    /// Unit direction.
    pub dir: DVec3,
    /// The share of what it brings that reaches the pixel, per channel, as it was sent.
    pub weight: DVec3,
    /// The media it is in, places in `Scene::media`, highest priority last; empty in what surrounds everything.
    pub media: Vec<u32>,
    /// Distance to what it met; infinite where it met nothing.
    pub t: f64,
    /// The weight on arrival: what the medium left of `weight`.
    pub arrived: DVec3,
    /// What it met.
    pub met: Met,
    /// How the surface divided the light; none where there was no surface.
    pub split: Option<Split>,
    /// What was added to the pixel here.
    pub shares: Vec<Share>,
    /// Rays that were not sent.
    pub cut: Vec<Cut>,
}

impl Event {
    /// A ray that was sent and has met nothing yet.
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

    /// The object it met, a place in `Scene::objects`.
    #[must_use]
    pub fn object(&self) -> Option<u32> {
        match self.met {
            Met::Absent { object, .. } | Met::Surface { object, .. } => Some(object),
            Met::Nothing | Met::Spent => None,
        }
    }
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Met {
    /// Nothing: it sees the environment.
    Nothing,
    /// Whatever it met, the medium on the way left nothing of its light.
    Spent,
    /// A surface that is not there, inside a medium of higher priority: the ray goes straight on.
    Absent {
        /// Place in `Scene::objects`.
        object: u32,
        /// Triangle within a mesh; 0 on other shapes.
        primitive: u32,
        /// Place, in scene units.
        point: DVec3,
    },
    /// A surface.
    Surface {
        /// Place in `Scene::objects`.
        object: u32,
        /// Triangle within a mesh; 0 on other shapes.
        primitive: u32,
        /// Place, in scene units.
        point: DVec3,
        /// Whether the ray came from outside.
        front: bool,
        /// Cosine of the angle of incidence, to the shading normal.
        cos_i: f64,
    },
}

/// How a surface divided the light that arrived, in parts of it, per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Indices of refraction on the ray's side and behind; none where the surface has no boundary between media.
    pub indices: Option<(f64, f64)>,
    /// Cosine of the angle of refraction; none where light is not bent.
    pub cos_t: Option<f64>,
    /// Whether reflection is total.
    pub total: bool,
    /// What the reflected ray carries on.
    pub reflected: DVec3,
    /// What the transmitted ray carries on, after tint.
    pub transmitted: DVec3,
    /// What stays: the part that reaches an opaque base, the part that a tint or a metal takes.
    pub absorbed: DVec3,
}

impl Split {
    /// An opaque surface: all of it stays.
    pub const OPAQUE: Self = Self {
        indices: None,
        cos_t: None,
        total: false,
        reflected: DVec3::ZERO,
        transmitted: DVec3::ZERO,
        absorbed: DVec3::ONE,
    };

    /// Reflected, transmitted and absorbed together: 1 but for rounding, or energy is lost or made.
    #[must_use]
    pub fn sum(&self) -> DVec3 {
        self.reflected + self.transmitted + self.absorbed
    }
}

/// Something that was added to the pixel, or would have been.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Where the light is from.
    pub source: Source,
    /// What would have been added with nothing in the way.
    pub unshadowed: DVec3,
    /// What was added, weights and all.
    pub radiance: DVec3,
    /// The object that blocks a lamp, a place in `Scene::objects`, where one does.
    pub blocker: Option<u32>,
}

impl Share {
    /// Light that nothing can be in the way of.
    #[must_use]
    pub fn free(source: Source, radiance: DVec3) -> Self {
        Self { source, unshadowed: radiance, radiance, blocker: None }
    }
}

/// Where light is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Beyond everything.
    Environment,
    /// The environment in a mirror that looks it up.
    MirroredEnvironment,
    /// The surface: emission, and ambient light.
    Glow,
    /// A light, a place in `Scene::lights`.
    Light(u32),
}

/// A ray that was not sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// What it would have been sent for.
    pub kind: RayKind,
    /// The weight it would have carried, which counts as truncated.
    pub weight: DVec3,
    /// Whether the depth limit ended it, or how light it was. (Neither: it passed too many surfaces that are not there.)
    pub too_deep: bool,
    /// Whether it was lighter than the cut-off.
    pub too_light: bool,
}
