//! Contacts between surfaces, as far as they change a picture.

use crate::geometry::contact::Contacts;
use crate::scene::{Interface, Material, Scene};

/// Finds the touching surfaces of a scene that look different from surfaces with a gap.
///
/// Opaque surfaces of one material look the same whichever of them is hit, so they are left out.
#[must_use]
pub fn contacts(scene: &Scene) -> Contacts {
    Contacts::find(&scene.geometry, &|a, b| matters(scene, a, b))
}

/// Returns true if contact of two objects (or of duplicate faces within one) can be seen.
fn matters(scene: &Scene, a: usize, b: usize) -> bool {
    let [m, n] = [a, b].map(|o| scene.objects[o].material);
    m != n || lets_light_on(&scene.materials[m as usize])
}

/// Returns true if rays may continue behind a surface.
fn lets_light_on(material: &Material) -> bool {
    match material.interface {
        Interface::Dielectric { .. } | Interface::ThinDielectric { .. } | Interface::Alpha { .. } => true,
        Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => false,
    }
}
