//! Kinds of surface that are shaded by different code, and the bins that hits are sorted into.

use super::base::has_base;
use crate::scene::{Interface, Material, MirrorSource};

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
