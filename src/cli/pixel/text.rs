//! The tree for a terminal of 80 columns.

use glam::DVec3;

use super::align::Row;
use super::condition::{Condition, TOLERANCE};
use super::findings::{Findings, Side};
use super::quantity::{self, Quantity};
use crate::render::RayKind;
use crate::render::record::{Event, Met, Source};
use crate::scene::{Interface, LightKind, Scene};

/// Number of levels that are indented. Deeper ones stand below each other, with their depths.
const SET_IN: usize = 11;

/// Width of a terminal.
const COLUMNS: usize = 80;

/// Radiance and truncated weight of each row and of all rays that follow, in each renderer.
pub(super) type Totals = [Vec<(DVec3, DVec3)>; 2];

/// Returns the whole report.
pub(super) fn report(findings: &Findings) -> String {
    let (job, settings) = (findings.job, &findings.scene.settings);
    let samples = settings.samples * settings.samples;
    let mut lines = vec![format!(
        "pixel ({}, {}) of {}, {} by {}, {}",
        job.x,
        job.y,
        job.scene.display(),
        settings.width,
        settings.height,
        match (samples, job.sample) {
            (1, _) => String::from("one ray"),
            (n, None) => format!("{n} rays"),
            (n, Some(k)) => format!("ray {k} of {n}"),
        }
    )];
    lines.push(format!(
        "{:<16} {:>13}  {:>13}  {:>9}",
        "",
        format!("{} f32", job.backend.name()),
        "reference f64",
        "apart"
    ));
    let (narrow, wide) = (&findings.narrow, &findings.wide);
    for quantity in of_the_pixel(narrow, wide) {
        lines.push(number(&quantity, ""));
    }
    let count = |side: &Side| side.tree.events.len();
    lines.push(format!("{:<16} {:>13}  {:>13}", "rays", count(narrow), count(wide)));
    lines.extend(conditions(findings));

    let totals: Totals = [narrow.tree.totals(), wide.tree.totals()];
    let mut folded_below = usize::MAX;
    for row in &findings.rows {
        if row.level > folded_below {
            continue;
        }
        folded_below = usize::MAX;
        let indent = "  ".repeat(row.level.min(SET_IN));
        lines.push(String::new());
        if row.level > 0 && folds(row, &totals, job.least) {
            folded_below = row.level;
            let (kind, many) = (name_of(findings, row), following(findings, row));
            lines.push(format!("{indent}{kind}: {many}, less than {} (--least)", job.least));
            continue;
        }
        lines.extend(told(findings, row, &indent));
        for quantity in quantity::of(findings, row, &totals) {
            lines.push(number(&quantity, &indent));
        }
        lines.extend(remarks(findings, row).into_iter().map(|remark| format!("{indent}  {remark}")));
    }
    lines.iter().map(|line| wrapped(line)).collect::<Vec<_>>().join("\n") + "\n"
}

/// Breaks a line at blanks so that each part fits the terminal; later parts are indented further.
fn wrapped(line: &str) -> String {
    let indent = " ".repeat(line.len() - line.trim_start().len() + 4);
    let mut parts = Vec::new();
    let mut rest = line.to_owned();
    while rest.chars().count() > COLUMNS {
        let end = rest.char_indices().nth(COLUMNS).map_or(rest.len(), |(i, _)| i);
        let Some(blank) = rest[..end].rfind(' ').filter(|&i| !rest[..i].trim().is_empty()) else {
            break;
        };
        let next = format!("{indent}{}", &rest[blank + 1..]);
        rest.truncate(blank);
        parts.push(rest);
        rest = next;
    }
    parts.push(rest);
    parts.join("\n")
}

/// Returns the numbers of the whole pixel, over all of its rays.
pub(super) fn of_the_pixel(narrow: &Side, wide: &Side) -> Vec<Quantity> {
    quantity::of_the_pixel((narrow.radiance, narrow.truncated), (wide.radiance, wide.truncated))
}

fn conditions(findings: &Findings) -> Vec<String> {
    let tell = |c: &Condition| match c.ulps {
        Some(ulps) => {
            format!("ill-conditioned: {ulps} ulp{} move it by over {TOLERANCE}", if ulps == 1.0 { "" } else { "s" })
        }
        None => format!("well-conditioned: {} ulps move it by {TOLERANCE} at most", c.looked),
    };
    match findings.conditions.as_slice() {
        [one] => vec![format!("camera ray {}", tell(one))],
        many => {
            let ill: Vec<String> =
                many.iter().filter(|c| c.is_ill()).map(|c| format!("ray {} {}", c.sample, tell(c))).collect();
            if ill.is_empty() { vec![format!("all {} camera rays are {}", many.len(), tell(&many[0]))] } else { ill }
        }
    }
}

/// Returns true if a row and all below it contribute too little to be shown.
pub(super) fn folds(row: &Row, totals: &Totals, least: f64) -> bool {
    let of = |node: Option<u32>, totals: &[(DVec3, DVec3)]| node.map_or(DVec3::ZERO, |n| totals[n as usize].0);
    let (a, b) = (of(row.narrow, &totals[0]), of(row.wide, &totals[1]));
    let cut = |node: Option<u32>, totals: &[(DVec3, DVec3)]| node.map_or(DVec3::ZERO, |n| totals[n as usize].1);
    let most = [a, b, a - b, cut(row.narrow, &totals[0]), cut(row.wide, &totals[1])];
    most.iter().all(|v| v.abs().max_element() < least)
}

/// Number of rays that a row stands for, itself included.
pub(super) fn following(findings: &Findings, row: &Row) -> String {
    let mut waiting = row.sent.clone();
    let mut n = 1;
    while let Some(place) = waiting.pop() {
        n += 1;
        waiting.extend(&findings.rows[place].sent);
    }
    if n == 1 { String::from("1 ray") } else { format!("{n} rays") }
}

/// Event of a row that descriptions use.
pub(super) fn event<'a>(findings: &'a Findings, row: &Row) -> &'a Event {
    let narrow = row.narrow.map(|n| &findings.narrow.tree.events[n as usize]);
    let wide = row.wide.map(|n| &findings.wide.tree.events[n as usize]);
    wide.or(narrow).expect("a row has a ray")
}

fn name_of(findings: &Findings, row: &Row) -> String {
    let event = event(findings, row);
    let only = match (row.narrow, row.wide) {
        (Some(_), None) => ", in f32 only",
        (None, Some(_)) => ", in f64 only",
        _ => "",
    };
    let inside: Vec<&str> = event.media.iter().map(|&m| findings.scene.media[m as usize].name.as_str()).collect();
    let inside = if inside.is_empty() { findings.scene.media[0].name.clone() } else { inside.join(" > ") };
    format!("{} {} in {inside}{only}", event.depth, event.kind.name())
}

/// Describes a row's ray and its hit.
fn told(findings: &Findings, row: &Row, indent: &str) -> Vec<String> {
    let mut lines = vec![format!("{indent}{}", name_of(findings, row))];
    let narrow = row.narrow.map(|n| &findings.narrow.tree.events[n as usize]);
    let wide = row.wide.map(|n| &findings.wide.tree.events[n as usize]);
    let meeting = |event: &Event| met(findings.scene, event);
    match (narrow, wide) {
        (Some(a), Some(b)) if !super::align::met_alike(a, b) => {
            lines.push(format!("{indent}  f32 {}", meeting(a)));
            lines.push(format!("{indent}  f64 {}", meeting(b)));
        }
        _ => lines.push(format!("{indent}  {}", meeting(event(findings, row)))),
    }
    if let Some(point) = place(event(findings, row)) {
        let apart =
            narrow.and_then(place).filter(|_| wide.is_some()).map(|p| p.distance(point) * findings.scene.unit());
        let apart = apart.map_or(String::new(), |d| format!(", {d:.1e} apart"));
        let at = findings.scene.world(point);
        let [x, y, z] = if findings.scene.unit_exponent == 0 {
            at.to_array().map(|x| format!("{x:.6}"))
        } else {
            at.to_array().map(|x| format!("{x:.6e}"))
        };
        lines.push(format!("{indent}  at ({x}, {y}, {z}){apart}"));
    }
    lines
}

fn place(event: &Event) -> Option<DVec3> {
    match event.met {
        Met::Surface { point, .. } | Met::Absent { point, .. } => Some(point),
        Met::Nothing | Met::Spent => None,
    }
}

/// Describes the hit of a ray.
pub(super) fn met(scene: &Scene, event: &Event) -> String {
    let object = |i: u32| {
        let material = &scene.materials[scene.objects[i as usize].material as usize];
        format!("{} ({}, {})", scene.objects[i as usize].name, material.name, interface(&material.interface))
    };
    match event.met {
        Met::Nothing => String::from("meets nothing"),
        Met::Spent => String::from("is absorbed on the way"),
        Met::Absent { object: i, .. } => format!("passes {}, not there", object(i)),
        Met::Surface { object: i, primitive, front, .. } => {
            let side = if front { "outside" } else { "inside" };
            let total = if event.split.is_some_and(|s| s.total) { ", total reflection" } else { "" };
            let part = if primitive == 0 { String::new() } else { format!(", triangle {primitive}") };
            format!("meets {}{part}, {side}{total}", object(i))
        }
    }
}

fn interface(interface: &Interface) -> &'static str {
    match interface {
        Interface::Opaque => "opaque",
        Interface::Mirror { .. } => "mirror",
        Interface::Conductor { .. } => "metal",
        Interface::Dielectric { .. } => "dielectric",
        Interface::ThinDielectric { .. } => "thin pane",
        Interface::Coated { .. } => "coated",
        Interface::Alpha { .. } => "alpha",
    }
}

/// Explains numbers: indices, objects that block lamps, reasons why rays ended.
fn remarks(findings: &Findings, row: &Row) -> Vec<String> {
    let mut lines = Vec::new();
    let event = event(findings, row);
    if let Some((n1, n2)) = event.split.and_then(|s| s.indices) {
        lines.push(format!("index {n1} to {n2}"));
    }
    for share in &event.shares {
        let name = match share.source {
            Source::Light(light) => {
                let kind = kind_of(&findings.scene.lights[light as usize].kind);
                format!("light {} ({kind})", light + 1)
            }
            Source::Emitters => String::from("light of emissive shapes"),
            Source::Sky => String::from("light of the environment"),
            Source::Environment | Source::MirroredEnvironment | Source::Glow => continue,
        };
        if let Some(blocker) = share.blocker {
            lines.push(format!("{name} is blocked by {}", findings.scene.objects[blocker as usize].name));
        } else if share.radiance == DVec3::ZERO {
            lines.push(format!("{name} is lost in what it would have to pass"));
        } else if share.radiance != share.unshadowed {
            let left = share.radiance.max_element() / share.unshadowed.max_element();
            lines.push(format!("{name}: {:.1}% comes through", left * 100.0));
        }
    }
    for cut in &event.cut {
        let kind = if cut.kind == RayKind::Reflected { "reflected" } else { "transmitted" };
        let why = match (cut.too_deep, cut.too_light) {
            (true, _) => format!("--depth {}", findings.scene.settings.max_depth),
            (false, true) => format!("--cutoff {}", findings.scene.settings.cutoff),
            (false, false) => String::from("no direction found"),
        };
        lines.push(format!("the {kind} ray is cut off: {why}"));
    }
    lines
}

fn kind_of(light: &LightKind) -> &'static str {
    match light {
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
        LightKind::Directional { .. } => "directional",
        LightKind::Sphere { .. } => "sphere",
        LightKind::Rectangle { .. } => "rectangle",
    }
}

fn number(quantity: &Quantity, indent: &str) -> String {
    let cell = |x: Option<f64>| x.map_or(String::from("-"), digits);
    let (a, b) = (cell(quantity.f32), cell(quantity.f64));
    let name = if indent.is_empty() { quantity.name.clone() } else { format!("  {}", quantity.name) };
    let room = if indent.len() > 20 { 13 } else { 16 };
    format!("{indent}{name:<room$} {a:>13}  {b:>13}  {:>9}", quantity.difference()).trim_end().to_owned()
}

/// Nine digits, which tell every `f32` from its neighbours.
pub(super) fn digits(x: f64) -> String {
    if x == 0.0 {
        return String::from("0");
    }
    let size = x.abs();
    if !(1e-4..1e6).contains(&size) {
        return format!("{x:.6e}");
    }
    let before = size.log10().floor().max(0.0) as usize + 1;
    format!("{x:.*}", 9 - before.min(8))
}
