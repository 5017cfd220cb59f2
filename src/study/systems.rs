//! The lecture notes' systems as levels of the reflection and the refraction axis: those that a scene bears.

use crate::measure::table::counted;
use crate::optics::RefractionModel;
use crate::render::Reflection;
use crate::scene::{MapKind, Scene};
use crate::systems::images::Images;
use crate::systems::maps::Maps;
use crate::systems::planar::Mirrors;

/// A level that stands for a system, and what a scene has for it.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Bearing {
    /// Options of `vitrum render` that ask for it.
    pub option: String,
    /// True if the scene bears it.
    pub possible: bool,
    /// The reason.
    pub because: String,
}

/// Returns what a scene has for each system that is no formula: none if nothing in it reflects or bends light.
#[must_use]
pub fn bearings(scene: &Scene) -> Vec<Bearing> {
    let of = |option: String, fit: Result<String, String>| {
        let possible = fit.is_ok();
        Bearing { option, possible, because: fit.unwrap_or_else(|why| why) }
    };
    let mut bearings = Vec::new();
    if scene.materials.iter().any(crate::scene::Material::reflects) {
        for level in [Reflection::SphereMap, Reflection::CubeMap, Reflection::Virtual, Reflection::Planar] {
            bearings.push(of(format!("--reflection {}", level.name()), reflection(scene, level)));
        }
    }
    if (0..scene.objects.len()).any(|o| scene.medium_of(o).is_some()) {
        for level in [RefractionModel::MapOne, RefractionModel::MapTwo, RefractionModel::Raised] {
            bearings.push(of(format!("--refraction {}", level.name()), refraction(scene, level)));
        }
    }
    bearings
}

fn named(scene: &Scene, object: u32, why: &str) -> String {
    format!("`{}` {why}", scene.objects[object as usize].name)
}

/// Returns what a scene has for a level of the reflection axis, or the reason why it does not bear it.
pub(super) fn reflection(scene: &Scene, level: Reflection) -> Result<String, String> {
    let first = |reason: Option<String>| reason.unwrap_or_else(|| String::from("nothing reflects"));
    match level {
        Reflection::Traced | Reflection::Environment | Reflection::None => Ok(String::from("every scene bears it")),
        Reflection::Planar => {
            let mirrors = Mirrors::of(scene);
            let curved = mirrors.curved.first().map(|(object, why)| named(scene, *object, &why.to_string()));
            match mirrors.list.len() as u64 {
                0 => Err(first(curved.map(|c| format!("{c}; nothing planar reflects")))),
                planes => Ok(counted(planes, "planar mirror")),
            }
        }
        Reflection::Virtual => {
            let (count, without) = Images::possible(scene);
            match count as u64 {
                0 => Err(first(without.map(|(object, why)| named(scene, object, why)))),
                reflectors => Ok(counted(reflectors, "curved reflector")),
            }
        }
        Reflection::CubeMap | Reflection::SphereMap => {
            let (wanted, without) = Maps::wanted(scene, MapKind::Cube);
            match wanted.len() as u64 {
                0 => Err(first(without.first().map(|&(object, why)| named(scene, object, why)))),
                maps => Ok(counted(maps, "reflector") + " with a centre"),
            }
        }
    }
}

/// Returns what a scene has for a level of the refraction axis, or the reason why it does not bear it.
pub(super) fn refraction(scene: &Scene, level: RefractionModel) -> Result<String, String> {
    match level {
        mapped if mapped.is_mapped() => {
            let (wanted, without) = Maps::wanted_by_bodies(scene);
            let first = without.first().map(|&(object, why)| named(scene, object, why));
            match wanted.len() as u64 {
                0 => Err(first.unwrap_or_else(|| String::from("nothing bends light"))),
                1 => Ok(String::from("1 body with a centre")),
                bodies => Ok(format!("{bodies} bodies with a centre")),
            }
        }
        RefractionModel::Raised => {
            let mirrors = Mirrors::of(scene);
            let bends = |object: u32| scene.medium_of(object as usize).is_some();
            let curved = mirrors.curved.iter().find(|(object, _)| bends(*object));
            match mirrors.list.iter().filter(|mirror| bends(mirror.object)).count() as u64 {
                0 => Err(curved.map_or_else(
                    || String::from("nothing bends light"),
                    |(object, why)| named(scene, *object, &why.to_string()) + "; nothing planar bends light",
                )),
                planes => Ok(counted(planes, "planar surface") + " of a body"),
            }
        }
        _ => Ok(String::from("every scene bears it")),
    }
}
