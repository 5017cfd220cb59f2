//! The lecture notes' reflection systems as levels of the reflection axis.

use crate::render::Reflection;
use crate::scene::{MapKind, Scene};
use crate::systems::images::Images;
use crate::systems::maps::Maps;
use crate::systems::planar::Mirrors;

/// Returns the reason why a scene does not bear a reflection system, if it does not.
pub(super) fn unfit(scene: &Scene, reflection: Reflection) -> Option<String> {
    let named = |(object, why): (u32, String)| format!("`{}` {why}", scene.objects[object as usize].name);
    match reflection {
        Reflection::Traced | Reflection::Environment | Reflection::None => None,
        Reflection::Planar => {
            let mirrors = Mirrors::of(scene);
            let curved = mirrors.curved.first().map(|(object, why)| named((*object, why.to_string())));
            mirrors.list.is_empty().then(|| {
                curved.map_or_else(|| String::from("nothing reflects"), |c| format!("{c}; nothing planar reflects"))
            })
        }
        Reflection::Virtual => {
            let (count, first) = Images::possible(scene);
            let first = first.map(|(object, why)| named((object, why.into())));
            (count == 0).then(|| first.unwrap_or_else(|| String::from("nothing reflects")))
        }
        Reflection::CubeMap | Reflection::SphereMap => {
            let (wanted, without) = Maps::wanted(scene, MapKind::Cube);
            let first = without.first().map(|&(object, why)| named((object, why.into())));
            wanted.is_empty().then(|| first.unwrap_or_else(|| String::from("nothing reflects")))
        }
    }
}
