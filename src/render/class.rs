//! Classes of surface interaction, each shaded by its own code, and the bins that hits are sorted into.

use super::base::has_base;
use crate::effects::Reach;
use crate::scene::{Interface, Material, MirrorSource, Scene};

/// Interaction of a surface with the arriving ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Opaque,
    Mirror,
    MirrorOfEnvironment,
    Conductor,
    Dielectric,
    Thin,
    Coated,
    Alpha,
}

impl Class {
    /// All classes, in the order of their discriminants.
    pub const ALL: [Self; 8] = [
        Self::Opaque,
        Self::Mirror,
        Self::MirrorOfEnvironment,
        Self::Conductor,
        Self::Dielectric,
        Self::Thin,
        Self::Coated,
        Self::Alpha,
    ];

    /// Returns the name used in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Opaque => "opaque",
            Self::Mirror => "mirror",
            Self::MirrorOfEnvironment => "mirror of the environment",
            Self::Conductor => "metal",
            Self::Dielectric => "transparent",
            Self::Thin => "thin pane",
            Self::Coated => "coated",
            Self::Alpha => "cover with holes",
        }
    }

    /// Returns the class of a material.
    #[must_use]
    pub fn of(material: &Material) -> Self {
        match material.interface {
            Interface::Opaque => Self::Opaque,
            Interface::Mirror { source: MirrorSource::Traced, .. } => Self::Mirror,
            Interface::Mirror { source: MirrorSource::Environment, .. } => Self::MirrorOfEnvironment,
            Interface::Conductor { .. } => Self::Conductor,
            Interface::Dielectric { .. } => Self::Dielectric,
            Interface::ThinDielectric { .. } => Self::Thin,
            Interface::Coated { .. } => Self::Coated,
            Interface::Alpha { .. } => Self::Alpha,
        }
    }
}

/// Number of bins that the hits of a chunk are sorted into. A bin is a class, with or without a base. So all lanes of a
/// packet share one class, and stages that a bin does not need are never called.
pub const BINS: usize = Class::ALL.len() * 2;

/// Returns the bin of a material.
#[must_use]
pub fn bin_of(material: &Material) -> usize {
    Class::of(material) as usize * 2 + usize::from(has_base(material))
}

/// Returns true if the surfaces of a bin have a base.
#[must_use]
pub fn bin_has_base(bin: usize) -> bool {
    bin % 2 == 1
}

/// Returns the class of a bin.
#[must_use]
pub fn class_of(bin: usize) -> Class {
    Class::ALL[bin / 2]
}

/// Objects whose hits share packets, because the same stages shade them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedShading {
    /// Name of their class.
    pub surface: &'static str,
    /// True if the surfaces also have a base: emission, ambient light, or reflection of lamps.
    pub base: bool,
    /// Indices of the objects in the scene.
    pub objects: Vec<usize>,
}

/// Groups the objects of a scene that rays can hit by the stages that shade them.
#[must_use]
pub fn shared_shading(scene: &Scene, reach: &Reach) -> Vec<SharedShading> {
    let bin = |o: usize| bin_of(&scene.materials[scene.objects[o].material as usize]);
    let shared = |of: usize| SharedShading {
        surface: class_of(of).name(),
        base: bin_has_base(of),
        objects: (0..scene.objects.len()).filter(|&o| bin(o) == of && !reach.unmet[o]).collect(),
    };
    (0..BINS).map(shared).filter(|s| !s.objects.is_empty()).collect()
}
