//! Camera and lights of a model file.

use glam::{DVec3, Vec3};

use crate::scene::{Projection, Rgb};

/// Camera and lights of a model file, in world coordinates.
#[derive(Debug, Default)]
pub(super) struct Extras {
    /// Camera, if the file has one.
    pub view: Option<View>,
    /// Lights.
    pub lamps: Vec<Lamp>,
    /// Names of its materials.
    pub names: Vec<String>,
}

/// Camera of a model file.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub eye: DVec3,
    /// Unit direction of view.
    pub forward: DVec3,
    /// Up direction, not parallel to `forward`.
    pub up: Vec3,
    pub projection: Projection,
}

/// Light of a model file.
#[derive(Clone, Debug)]
pub(super) struct Lamp {
    pub name: String,
    pub kind: LampKind,
    /// Radiant intensity in world units, or irradiance for a distant lamp.
    pub intensity: Rgb,
}

/// Place and shape of a lamp.
#[derive(Clone, Copy, Debug)]
pub(super) enum LampKind {
    Distant { direction: Vec3 },
    Point { place: DVec3 },
    Spot { place: DVec3, direction: Vec3, cos_inner: f32, cos_outer: f32 },
}
