//! Surfaces that send reflected light on.

use crate::scene::{Interface, Material, MirrorSource, Scene};

/// Returns true if a material reflects what stands around it.
#[must_use]
pub fn reflects(material: &Material) -> bool {
    match material.interface {
        Interface::Mirror { source, .. } => source == MirrorSource::Traced,
        Interface::Conductor { .. }
        | Interface::Dielectric { .. }
        | Interface::ThinDielectric { .. }
        | Interface::Coated { .. } => true,
        Interface::Opaque | Interface::Alpha { .. } => false,
    }
}

/// The objects of a scene that do, by their places in it.
pub(super) fn reflectors(scene: &Scene) -> impl Iterator<Item = usize> {
    (0..scene.objects.len()).filter(|&o| reflects(&scene.materials[scene.objects[o].material as usize]))
}
