//! Reflection systems in the summary of a render.

use crate::measure::table::{counted, grouped};
use crate::render::{Outcome, RayKind};
use crate::scene::Scene;

/// Number of mirror levels that the text lists; the last level is listed as well.
const MOST_LEVELS: usize = 6;

/// Results of the reflection systems of a render.
#[derive(serde::Serialize)]
pub(super) struct Systems {
    #[serde(skip_serializing_if = "Option::is_none")]
    mirrors: Option<Mirrors>,
    #[serde(skip_serializing_if = "Option::is_none")]
    maps: Option<Maps>,
}

/// Planar mirrors in which the camera was mirrored.
#[derive(serde::Serialize)]
struct Mirrors {
    planes: usize,
    levels: Vec<Level>,
    /// Number of reflections in planar mirrors that are seen in or through something else.
    traced_elsewhere: u64,
    /// Reflectors that are not planar, with the reasons.
    traced: Vec<String>,
}

#[derive(serde::Serialize)]
struct Level {
    passes: u64,
    rays: u64,
    /// Mean over the camera's rays of the weight at this level. With light of radiance 1 the picture would lack as much
    /// if it ended at the level before.
    mean_weight: f64,
    largest_weight: f32,
}

/// Maps that reflectors show.
#[derive(serde::Serialize)]
struct Maps {
    kind: &'static str,
    maps: usize,
    texels: usize,
    seconds: f64,
    /// Number of reflections that were traced, because there was no map or because they were inside a body.
    traced_reflections: u64,
    /// Reflectors without a map, with the reasons.
    traced: Vec<String>,
}

impl Systems {
    pub fn of(outcome: &Outcome, scene: &Scene) -> Option<Self> {
        let named = |object: u32, why: &str| format!("`{}` {why}", scene.objects[object as usize].name);
        let camera = outcome.rays.of(RayKind::Camera).max(1) as f64;
        let mirrors = outcome.planar.as_ref().map(|planar| Mirrors {
            planes: planar.mirrors,
            levels: planar
                .levels
                .iter()
                .map(|level| Level {
                    passes: level.passes,
                    rays: level.rays,
                    mean_weight: level.weight / camera,
                    largest_weight: level.heaviest,
                })
                .collect(),
            traced_elsewhere: planar.elsewhere,
            traced: planar.curved.iter().map(|(object, why)| named(*object, why)).collect(),
        });
        let maps = outcome.maps.as_ref().map(|report| Maps {
            kind: report.maps.kind.name(),
            maps: report.maps.list.len(),
            texels: report.maps.list.iter().map(|map| map.picture.pixels.len()).sum(),
            seconds: report.time.as_secs_f64(),
            traced_reflections: report.traced,
            traced: report.maps.without.iter().map(|&(object, why)| named(object, why)).collect(),
        });
        (mirrors.is_some() || maps.is_some()).then_some(Self { mirrors, maps })
    }

    /// Names and values for lines of text.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = Vec::new();
        if let Some(mirrors) = &self.mirrors {
            let elsewhere = match mirrors.traced_elsewhere {
                0 => String::new(),
                n => format!("; traced in or through other things: {} rays", grouped(n)),
            };
            lines.push(("mirrors", format!("{}{elsewhere}", counted(mirrors.planes as u64, "plane"))));
            let last = mirrors.levels.len();
            for (i, level) in mirrors.levels.iter().enumerate().filter(|&(i, _)| i < MOST_LEVELS || i + 1 == last) {
                let Level { rays, mean_weight, largest_weight, .. } = level;
                let name = if i == 0 { "levels" } else { "" };
                let rays = counted(*rays, "ray");
                lines.push((
                    name,
                    format!(
                        "{}: {rays}; without it lacks {mean_weight:.3} of light 1, {largest_weight:.3} at most",
                        i + 1
                    ),
                ));
            }
            lines.extend(mirrors.traced.iter().map(|reason| ("traced", reason.clone())));
        }
        if let Some(maps) = &self.maps {
            let Maps { kind, maps: count, texels, seconds, traced_reflections, traced } = maps;
            let (count, texels) = (counted(*count as u64, "map"), grouped(*texels as u64));
            let rays = match traced_reflections {
                0 => String::new(),
                n => format!("; {} reflections traced", grouped(*n)),
            };
            lines.push(("maps", format!("{count} ({kind}, {texels} texels), taken in {seconds:.3} s{rays}")));
            lines.extend(traced.iter().map(|reason| ("traced", reason.clone())));
        }
        lines
    }
}
