//! The tree as JSON: a flat list of rays, each with the index of the one that sent it.

use glam::DVec3;

use super::condition::{Condition, TOLERANCE};
use super::findings::Findings;
use super::quantity::{self, Quantity};
use super::text::{self, Totals};
use crate::render::record::{Event, Met};
use crate::simd::level;

#[derive(serde::Serialize)]
pub(super) struct Report {
    version: &'static str,
    simd: &'static str,
    scene: String,
    x: u32,
    y: u32,
    /// Edge of the grid of rays in the pixel.
    samples: u32,
    /// The sample that is shown, from 1; null for all.
    sample: Option<u32>,
    backend: &'static str,
    /// Numbers of the whole pixel, over all of its rays.
    pixel: Vec<Quantity>,
    tolerance: f64,
    conditions: Vec<Condition>,
    rays: Vec<Ray>,
}

#[derive(serde::Serialize)]
struct Ray {
    id: usize,
    parent: Option<usize>,
    f32: Option<Side>,
    f64: Option<Side>,
    quantities: Vec<Quantity>,
}

/// A ray in one renderer.
#[derive(serde::Serialize)]
struct Side {
    kind: &'static str,
    depth: u32,
    origin: [f64; 3],
    direction: [f64; 3],
    media: Vec<String>,
    meets: String,
    object: Option<String>,
    point: Option<[f64; 3]>,
    indices: Option<(f64, f64)>,
    total_reflection: bool,
    shares: Vec<Share>,
    cut: Vec<Cut>,
}

#[derive(serde::Serialize)]
struct Share {
    source: String,
    unshadowed: [f64; 3],
    radiance: [f64; 3],
    blocked_by: Option<String>,
}

#[derive(serde::Serialize)]
struct Cut {
    kind: &'static str,
    weight: [f64; 3],
    too_deep: bool,
    too_light: bool,
}

/// Returns the report with all rays, folded away or not.
pub(super) fn report(findings: &Findings) -> Report {
    let totals: Totals = [findings.narrow.tree.totals(), findings.wide.tree.totals()];
    let rays = findings.rows.iter().enumerate().map(|(id, row)| Ray {
        id,
        parent: row.parent,
        f32: row.narrow.map(|n| side(findings, &findings.narrow.tree.events[n as usize])),
        f64: row.wide.map(|n| side(findings, &findings.wide.tree.events[n as usize])),
        quantities: quantity::of(findings, row, &totals),
    });
    Report {
        version: env!("CARGO_PKG_VERSION"),
        simd: level::BUILT,
        scene: findings.job.scene.display().to_string(),
        x: findings.job.x,
        y: findings.job.y,
        samples: findings.scene.settings.samples,
        sample: findings.job.sample,
        backend: findings.job.backend.name(),
        pixel: text::of_the_pixel(&findings.narrow, &findings.wide),
        tolerance: TOLERANCE,
        conditions: findings.conditions.clone(),
        rays: rays.collect(),
    }
}

fn side(findings: &Findings, event: &Event) -> Side {
    let scene = findings.scene;
    let object = |i: u32| scene.objects[i as usize].name.clone();
    let point: Option<DVec3> = match event.met {
        Met::Surface { point, .. } | Met::Absent { point, .. } => Some(point),
        Met::Nothing | Met::Spent => None,
    };
    Side {
        kind: event.kind.name(),
        depth: event.depth,
        origin: scene.world(event.origin).to_array(),
        direction: event.dir.to_array(),
        media: event.media.iter().map(|&m| scene.media[m as usize].name.clone()).collect(),
        meets: text::met(scene, event),
        object: event.object().map(object),
        point: point.map(|p| scene.world(p).to_array()),
        indices: event.split.and_then(|s| s.indices),
        total_reflection: event.split.is_some_and(|s| s.total),
        shares: event
            .shares
            .iter()
            .map(|share| Share {
                source: quantity::source(share.source),
                unshadowed: share.unshadowed.to_array(),
                radiance: share.radiance.to_array(),
                blocked_by: share.blocker.map(object),
            })
            .collect(),
        cut: event
            .cut
            .iter()
            .map(|cut| Cut {
                kind: cut.kind.name(),
                weight: cut.weight.to_array(),
                too_deep: cut.too_deep,
                too_light: cut.too_light,
            })
            .collect(),
    }
}
