//! Reflection systems in the summary of a render.

use crate::measure::table::{counted, grouped};
use crate::render::{MapsReport, Outcome, RayKind};
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
    #[serde(skip_serializing_if = "Option::is_none")]
    images: Option<Images>,
    /// Maps that refracted light is looked up in.
    #[serde(skip_serializing_if = "Option::is_none")]
    body_maps: Option<Maps>,
}

/// Virtual scenes behind mirror balls.
#[derive(serde::Serialize)]
struct Images {
    reflectors: usize,
    triangles: u64,
    points: Points,
    /// Triangles left out because a corner lies in a reflector, or has no reflection point or several.
    left_out: u64,
    /// Reflections of other reflectors, and of these where something else shows them.
    traced_reflections: u64,
    /// Reflectors without a virtual scene, with the reasons.
    traced: Vec<String>,
}

/// Points of the scene that were to be moved.
#[derive(serde::Serialize)]
struct Points {
    all: u64,
    seen: u64,
    inside_a_reflector: u64,
    without_reflection_point: u64,
    with_several: u64,
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

/// Maps that reflectors show, or bodies that bend light.
#[derive(serde::Serialize)]
struct Maps {
    kind: &'static str,
    maps: usize,
    texels: usize,
    seconds: f64,
    /// Number of rays that were traced, because there was no map or because they were inside a body.
    traced_rays: u64,
    /// Objects without a map, with the reasons.
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
                    mean_weight: level.weight() / camera,
                    largest_weight: level.heaviest,
                })
                .collect(),
            traced_elsewhere: planar.elsewhere,
            traced: planar.curved.iter().map(|(object, why)| named(*object, why)).collect(),
        });
        let of_maps = |report: &MapsReport| Maps {
            kind: report.maps.kind.name(),
            maps: report.maps.list.len(),
            texels: report.maps.list.iter().map(|map| map.picture.pixels.len()).sum(),
            seconds: report.time.as_secs_f64(),
            traced_rays: report.traced,
            traced: report.maps.without.iter().map(|&(object, why)| named(object, why)).collect(),
        };
        let (maps, body_maps) = (outcome.maps.as_ref().map(of_maps), outcome.body_maps.as_ref().map(of_maps));
        let images = outcome.images.as_ref().map(|report| Images {
            reflectors: report.reflectors,
            triangles: report.triangles,
            points: Points {
                all: report.points.all,
                seen: report.points.seen,
                inside_a_reflector: report.points.inside,
                without_reflection_point: report.points.none,
                with_several: report.points.several,
            },
            left_out: report.left_out,
            traced_reflections: report.traced,
            traced: report.without.iter().map(|&(object, why)| named(object, why)).collect(),
        });
        let any = mirrors.is_some() || maps.is_some() || images.is_some() || body_maps.is_some();
        any.then_some(Self { mirrors, maps, images, body_maps })
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
        let maps = [("maps", &self.maps), ("body maps", &self.body_maps)];
        for (name, maps) in maps.into_iter().filter_map(|(name, maps)| Some((name, maps.as_ref()?))) {
            let Maps { kind, maps: count, texels, seconds, traced_rays, traced } = maps;
            let (count, texels) = (counted(*count as u64, "map"), grouped(*texels as u64));
            let rays = match traced_rays {
                0 => String::new(),
                n => format!("; {} traced instead", counted(*n, "ray")),
            };
            lines.push((name, format!("{count} ({kind}, {texels} texels), taken in {seconds:.3} s{rays}")));
            lines.extend(traced.iter().map(|reason| ("traced", reason.clone())));
        }
        if let Some(images) = &self.images {
            let Images { reflectors, triangles, points, left_out, traced_reflections, traced } = images;
            let [triangles, seen, all, left_out] = [*triangles, points.seen, points.all, *left_out].map(grouped);
            let count = counted(*reflectors as u64, "virtual scene");
            lines.push(("virtual", format!("{count} of {triangles} triangles; {seen} of {all} points seen")));
            let [inside, none, several, rays] =
                [points.inside_a_reflector, points.without_reflection_point, points.with_several, *traced_reflections]
                    .map(grouped);
            lines.push((
                "",
                format!("reflection points: {none} points have none, {several} several; {inside} lie in a reflector"),
            ));
            lines.push(("", format!("{left_out} triangles left out; {rays} reflections traced")));
            lines.extend(traced.iter().map(|reason| ("traced", reason.clone())));
        }
        lines
    }
}
