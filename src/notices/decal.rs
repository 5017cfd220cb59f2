//! Check for opaque surfaces of different materials at the same place.

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::geometry::contact::Contacts;

/// Two coplanar opaque surfaces that face the same side; the later one is visible.
pub(super) const CHECK: Check = Check { id: "coplanar-materials", find: Find::InScene(find) };

fn find(facts: &Facts) -> Vec<Finding> {
    let opaque = |o: u32| !facts.material(o as usize).is_transmissive();
    let material = |o: usize| facts.scene.objects[o].material;
    // Other pairs are not searched.
    let may_cover = |a: usize, b: usize| opaque(a as u32) && opaque(b as u32) && material(a) != material(b);
    let contacts = Contacts::find(&facts.scene.geometry, &may_cover);
    let pairs = contacts.pairs().iter().filter(|pair| pair.aligned > 0);
    pairs
        .map(|pair| {
            let [under, over] = pair.objects.map(|o| facts.name(o as usize));
            Finding {
                place: FileLocation::object(facts.scene, pair.objects[1] as usize),
                wrong: format!("{over} covers {under} at the same place"),
                because: String::from("of coplanar surfaces the one listed later is seen"),
                cure: String::from("list them the other way round, or move one of them"),
            }
        })
        .collect()
}
