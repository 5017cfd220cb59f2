//! Check for opaque surfaces of different materials at the same place.

use super::{Check, Facts, Find, Finding, Place};
use crate::effects;

/// Two coplanar opaque surfaces that face the same side; the later one is visible.
pub(super) const CHECK: Check = Check { id: "coplanar-materials", find: Find::InScene(find) };

fn find(facts: &Facts) -> Vec<Finding> {
    let opaque = |o: u32| !facts.material(o as usize).is_transmissive();
    let contacts = effects::contacts(facts.scene);
    let pairs = contacts.pairs().iter().filter(|pair| {
        let [a, b] = pair.objects;
        let materials = [a, b].map(|o| facts.scene.objects[o as usize].material);
        pair.aligned > 0 && opaque(a) && opaque(b) && materials[0] != materials[1]
    });
    pairs
        .map(|pair| {
            let [under, over] = pair.objects.map(|o| facts.name(o as usize));
            Finding {
                place: Place::object(facts.scene, pair.objects[1] as usize),
                wrong: format!("{over} covers {under} at the same place"),
                because: String::from("of coplanar surfaces the one listed later is seen"),
                cure: String::from("list them the other way round, or move one of them"),
            }
        })
        .collect()
}
