//! Objects that reflect their surroundings.

use crate::scene::Scene;

/// Returns the indices of the objects whose material reflects.
pub(super) fn reflectors(scene: &Scene) -> impl Iterator<Item = usize> {
    (0..scene.objects.len()).filter(|&o| scene.materials[scene.objects[o].material as usize].reflects())
}
