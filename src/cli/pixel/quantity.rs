//! The numbers of a ray, in `f32` and `f64`.

use glam::DVec3;

use super::align::Row;
use super::findings::Findings;
use crate::math::ulp;
use crate::render::RayKind;
use crate::render::record::{Event, Met, Node, Source, Tree};

/// A number in both renderers.
#[derive(Clone, Debug, serde::Serialize)]
pub(super) struct Quantity {
    /// Name.
    pub name: String,
    /// Value in `f32`.
    pub f32: Option<f64>,
    /// Value in `f64`.
    pub f64: Option<f64>,
    /// Difference in ulps of `f32`, if both exist.
    pub ulps: Option<f64>,
    /// Difference relative to the number.
    pub relative: Option<f64>,
}

impl Quantity {
    fn new(name: impl Into<String>, narrow: Option<f64>, wide: Option<f64>) -> Self {
        let (mut ulps, mut relative) = (None, None);
        if let (Some(a), Some(b)) = (narrow, wide)
            && a.is_finite()
            && b.is_finite()
        {
            let off = (a - b).abs();
            ulps = Some(off / f64::from(ulp(b as f32))).filter(|u| u.is_finite());
            relative = (b != 0.0).then(|| off / b.abs());
        }
        Self { name: name.into(), f32: narrow, f64: wide, ulps, relative }
    }

    /// Formats the difference.
    pub fn difference(&self) -> String {
        match (self.ulps, self.relative) {
            (Some(0.0), _) => String::from("same"),
            (Some(ulps), _) if ulps < 999.5 => format!("{ulps:.1} ulp"),
            (_, Some(relative)) if relative < 1e4 => format!("{relative:.1e}"),
            (Some(_), _) => String::from("all of it"),
            _ => String::new(),
        }
    }
}

/// Numbers of one ray by one renderer.
type Numbers = Vec<(String, f64)>;

/// Returns the numbers of a row, in the order of the report. `totals` are those of [`crate::render::record::Tree`].
pub(super) fn of(findings: &Findings, row: &Row, totals: &[Vec<(DVec3, DVec3)>; 2]) -> Vec<Quantity> {
    fn side<'a>(node: Option<Node>, tree: &'a Tree, totals: &[(DVec3, DVec3)]) -> Option<(&'a Event, (DVec3, DVec3))> {
        node.map(|node| (&tree.events[node as usize], totals[node as usize]))
    }
    let narrow = side(row.narrow, &findings.narrow.tree, &totals[0]);
    let wide = side(row.wide, &findings.wide.tree, &totals[1]);
    let unit = findings.scene.unit();
    let (a, b) = (narrow.map(|side| numbers(side, unit)), wide.map(|side| numbers(side, unit)));
    let value = |side: &Option<Numbers>, name: &str| {
        side.as_ref().and_then(|n| n.iter().find(|(other, _)| other == name)).map(|&(_, x)| x)
    };
    let mut names: Vec<&String> = Vec::new();
    for (name, _) in b.iter().chain(&a).flatten() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let all: Vec<Quantity> = names.iter().map(|name| Quantity::new(*name, value(&a, name), value(&b, name))).collect();
    greys(all)
}

/// Returns the pixel's own numbers: radiance and truncated weight in both renderers.
pub(super) fn of_the_pixel(narrow: ([f64; 3], [f64; 3]), wide: ([f64; 3], [f64; 3])) -> Vec<Quantity> {
    let mut all = Vec::new();
    for (name, a, b) in [("radiance", narrow.0, wide.0), ("cut off", narrow.1, wide.1)] {
        let channels = ["r", "g", "b"].into_iter().zip(a.into_iter().zip(b));
        all.extend(channels.map(|(c, (a, b))| Quantity::new(format!("{name} {c}"), Some(a), Some(b))));
    }
    greys(all)
}

/// Merges the channels of quantities that are equal in all three.
fn greys(all: Vec<Quantity>) -> Vec<Quantity> {
    let mut joined: Vec<Quantity> = Vec::new();
    let mut rest = all.into_iter().peekable();
    while let Some(first) = rest.next() {
        let Some(stem) = first.name.strip_suffix(" r").map(str::to_owned) else {
            joined.push(first);
            continue;
        };
        let (second, third) = (rest.next(), rest.next());
        let like = |o: &Option<Quantity>| o.as_ref().is_some_and(|o| o.f32 == first.f32 && o.f64 == first.f64);
        if like(&second) && like(&third) {
            joined.push(Quantity { name: stem, ..first });
        } else {
            joined.push(first);
            joined.extend(second);
            joined.extend(third);
        }
    }
    joined
}

/// Returns the quantities that one renderer has for a ray. Lengths are converted to the world by `unit`.
fn numbers((event, (brings, cut)): (&Event, (DVec3, DVec3)), unit: f64) -> Numbers {
    let mut all = Numbers::new();
    let degrees = |cos: f64| cos.clamp(-1.0, 1.0).acos().to_degrees();
    colour(&mut all, "weight", event.weight);
    if event.t.is_finite() {
        all.push((String::from("t"), event.t * unit));
    }
    if event.arrived != event.weight {
        // Transmittance of the medium on the way.
        colour(&mut all, "on arrival", event.arrived);
    }
    if let Met::Surface { cos_i, .. } = event.met {
        all.push((String::from("angle in"), degrees(cos_i)));
    }
    if let Some(split) = &event.split {
        if let Some(cos) = split.cos_t {
            all.push((String::from("angle out"), degrees(cos)));
        }
        colour(&mut all, "R", split.reflected);
        colour(&mut all, "T", split.transmitted);
        colour(&mut all, "A", split.absorbed);
        colour(&mut all, "R + T + A", split.sum());
    }
    for share in &event.shares {
        colour(&mut all, &source(share.source), share.radiance);
    }
    for cut in &event.cut {
        let kind = if cut.kind == RayKind::Reflected { "cut refl." } else { "cut trans." };
        colour(&mut all, kind, cut.weight);
    }
    if brings != event.shares.iter().map(|s| s.radiance).sum() {
        colour(&mut all, "brings", brings);
    }
    if cut != event.cut.iter().map(|c| c.weight).sum() {
        colour(&mut all, "cut in all", cut);
    }
    all
}

/// Name of a source of light.
pub(super) fn source(source: Source) -> String {
    match source {
        Source::Environment => String::from("environment"),
        Source::MirroredEnvironment => String::from("mirrored env."),
        Source::Glow => String::from("own light"),
        Source::Light(i) => format!("light {}", i + 1),
        Source::Emitters => String::from("emissive shapes"),
        Source::Sky => String::from("sky light"),
    }
}

fn colour(all: &mut Numbers, name: &str, value: DVec3) {
    for (channel, x) in ["r", "g", "b"].into_iter().zip(value.to_array()) {
        let name = format!("{name} {channel}");
        match all.iter_mut().find(|(other, _)| *other == name) {
            // Sources of a kind are summed.
            Some((_, sum)) => *sum += x,
            None => all.push((name, x)),
        }
    }
}
