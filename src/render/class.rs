//! Kinds of surface that are shaded by different code, and the bins that hits are sorted into.

use super::base::has_base;
use crate::effects::Reach;
use crate::scene::{Interface, Material, MirrorSource, Scene};

/// What a surface does with the ray that arrives.
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
    /// All of them, in the order of their numbers.
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

    /// The name in reports.
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

    /// The kind of a material.
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

/// Bins that the hits of a chunk are sorted into: a class, with a base or without, so that a packet holds one kind and
/// what it never calls for is never called.
pub const BINS: usize = Class::ALL.len() * 2;

/// The bin of a material.
#[must_use]
pub fn bin_of(material: &Material) -> usize {
    Class::of(material) as usize * 2 + usize::from(has_base(material))
}

/// Whether surfaces of a bin have a base.
#[must_use]
pub fn bin_has_base(bin: usize) -> bool {
    bin % 2 == 1
}

/// The class of a bin.
#[must_use]
pub fn class_of(bin: usize) -> Class {
    Class::ALL[bin / 2]
}

/// Objects that are shaded together, eight hits at a time whichever of them was met, by one set of stages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedShading {
    /// What their surfaces do with light.
    pub surface: &'static str,
    /// Whether they send light of their own or of lamps besides.
    pub base: bool,
    /// Their numbers in the scene.
    pub objects: Vec<usize>,
}

/// Which objects of a scene are shaded together, of those that rays can meet.
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
