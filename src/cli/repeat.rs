//! Options and commands that repeat a picture of a study.

use std::path::Path;

use crate::accel::BuildQuality;
use crate::measure::shell::quoted;
use crate::optics::RefractionModel;
use crate::render::Reflection;
use crate::scene::LightsFrom;
use crate::study::reflections::Plan;
use crate::study::reflections::bundled::System;
use crate::study::{Axis, Precision, Spheres, Variant};
use crate::systems::maps::Proxy;

/// Returns the options of `vitrum render` that repeat it.
pub(super) fn options(variant: &Variant) -> String {
    let mut flags = vec![
        format!("--samples {}", variant.samples),
        format!("--depth {}", variant.depth),
        match variant.proven {
            Some(error) => format!("--cutoff-error {error}"),
            None => format!("--cutoff {}", variant.cutoff),
        },
        format!("--fresnel {}", variant.level(Axis::Fresnel)),
        format!("--refraction {}", variant.level(Axis::Refraction)),
        format!("--reflection {}", variant.level(Axis::Reflection)),
        format!("--shadows {}", variant.level(Axis::Shadows)),
    ];
    if variant.lights_from != LightsFrom::Auto {
        flags.push(format!("--lights-from {}", variant.lights_from));
    }
    if let Spheres::Bands(n) = variant.spheres {
        flags.push(format!("--spheres {n}"));
    }
    flags.push(match (variant.precision, variant.walk()) {
        (Precision::Double, _) => String::from("--backend reference"),
        (_, Some((test, reciprocal))) => {
            format!("--backend native --triangles {} --reciprocal {}", test.name(), reciprocal.name())
        }
        _ => format!("--backend {}", variant.level(Axis::Backend)),
    });
    // The f64 renderer has no hierarchy to build.
    if variant.bvh != BuildQuality::Default && variant.precision == Precision::Single {
        flags.push(format!("--bvh {}", variant.bvh.name()));
    }
    flags.join(" ")
}

/// Returns the command that repeats a variant's picture of `scene`, for a shell.
pub(super) fn command(variant: &Variant, scene: &Path, size: [u32; 2]) -> String {
    let [width, height] = size;
    let scene = quoted(&scene.display().to_string());
    format!("vitrum render {scene} -o picture.exr --width {width} --height {height} {}", options(variant))
}

/// Returns this program's own command line, for a shell.
pub(super) fn own_command() -> String {
    let arguments = std::env::args_os().skip(1).map(|a| quoted(&a.to_string_lossy()));
    std::iter::once(String::from("vitrum")).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Returns the options of `vitrum render` that ask for a system of the notes.
fn system_options(system: &System) -> String {
    let mut flags = Vec::new();
    if system.reflection != Reflection::Traced {
        flags.push(format!("--reflection {}", system.reflection.name()));
    }
    if system.proxy != Proxy::None {
        flags.push(format!("--proxy {}", system.proxy.name()));
    }
    if system.refraction != RefractionModel::Stable {
        flags.push(format!("--refraction {}", system.refraction.name()));
    }
    flags.join(" ")
}

/// Returns the command that repeats a system's picture of the scene in `file`, for a shell.
pub(super) fn system(system: &System, file: &str, plan: &Plan) -> String {
    let [width, height] = plan.size;
    format!(
        "vitrum render {} -o picture.exr --backend {} --width {width} --height {height} --samples {} {}",
        quoted(file),
        plan.backend.name(),
        plan.samples,
        system_options(system)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Backend;
    use crate::geometry::triangle_test::TriangleModel;
    use crate::scene::Settings;
    use crate::study::Level;
    use crate::study::reflections::bundled::SYSTEMS;

    fn default() -> Variant {
        Variant::of(&Settings::default(), Backend::Native)
    }

    #[test]
    fn a_command_quotes_the_scene_and_has_the_levels() {
        let other = default().with(Level::Depth(4));
        assert!(command(&other, Path::new("it's.toml"), [3, 2]).contains(r"'it'\''s.toml' -o"));
        assert!(command(&other, Path::new("a.toml"), [3, 2]).contains("--depth 4 "));
        assert!(options(&other.with(Level::Precision(Precision::Double))).ends_with("--backend reference"));
    }

    #[test]
    fn every_system_of_the_notes_has_an_option() {
        for system in &SYSTEMS {
            assert!(!system_options(system).is_empty(), "{}", system.name);
        }
    }

    #[test]
    fn the_quality_of_a_hierarchy_is_told_where_there_is_one_and_it_is_not_the_default() {
        let fast = Variant { bvh: BuildQuality::Fast, ..default() };
        assert!(options(&fast).ends_with("--backend native --bvh fast"));
        assert!(options(&fast.with(Level::Triangles(Some(TriangleModel::Pluecker)))).ends_with(" --bvh fast"));
        assert!(!options(&default()).contains("--bvh"));
        assert!(options(&fast.with(Level::Precision(Precision::Double))).ends_with("--backend reference"));
        assert_eq!(fast.name(&fast), "default");
    }
}
