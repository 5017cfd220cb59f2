//! Secondary rays of a surface: queued, or ended by the depth limit or the cut-off.

use glam::DVec3;

use super::media::MediumStack;
use super::split::Lobe;
use super::trace::{Arrival, Branch, Pending, Tracer};
use crate::render::budget::{Division, divide};
use crate::render::record::{Cut, Recorder};
use crate::render::{Limit, RayKind};

impl<L: Recorder> Tracer<'_, '_, L> {
    /// Adds a secondary ray of the arriving wavelength.
    pub fn send(&mut self, at: &Arrival, kind: RayKind, dir: DVec3, lobe: Lobe, stack: MediumStack) {
        self.send_coloured(at, kind, dir, lobe, stack, at.ray.nm);
    }

    /// Adds a secondary ray.
    pub fn send_coloured(
        &mut self,
        at: &Arrival,
        kind: RayKind,
        dir: DVec3,
        lobe: Lobe,
        stack: MediumStack,
        nm: Option<f64>,
    ) {
        let weight = at.ray.weight * lobe.share;
        if weight != DVec3::ZERO {
            let polarisation = lobe.polarisation;
            self.branches.push(Branch { kind, dir, weight, nm, stack, polarisation, start: None, shown: None });
        }
    }

    /// Queues the surface's secondary rays, except for those that the depth limit or the cut-off ends.
    pub fn send_branches(&mut self, at: &Arrival) {
        let settings = &self.prepared.scene.settings;
        let depth = at.ray.depth + 1;
        let too_deep = at.ray.depth >= self.prepared.max_depth;
        let mut branches = std::mem::take(&mut self.branches);
        let proven = self.prepared.tolls.as_ref().ok().and_then(Option::as_ref).map(|tolls| {
            debug_assert!(branches.len() <= 2, "a budget is divided between two");
            let toll = |k: usize| branches.get(k).map_or(DVec3::ZERO, |b: &Branch| b.weight * tolls.at(depth as usize));
            divide(at.ray.budget.into(), [toll(0).into(), toll(1).into()])
        });
        for (k, branch) in branches.drain(..).enumerate() {
            let Branch { kind, dir, weight, nm, stack, polarisation, start, shown } = branch;
            let (too_light, budget) = match &proven {
                None => (weight.abs().max_element() < f64::from(settings.cutoff), at.ray.budget),
                Some(Division { cut, budget }) => (cut[k], budget[k].into()),
            };
            if too_deep || too_light {
                self.cut(at, kind, weight, too_deep, too_light);
                continue;
            }
            let dir = dir.normalize();
            let polarisation = polarisation.map(|carried| carried.along(dir));
            let origin = start.map_or_else(|| at.surface.start(dir), |start| start.origin);
            let image = start.map(|start| start.image);
            let through = if dir.dot(at.geometric) < 0.0 { at.onward } else { at.returning };
            let ray = Pending {
                origin,
                dir,
                weight,
                depth,
                kind,
                nm,
                stack,
                passed: 0,
                through,
                polarisation,
                budget,
                image,
                shown,
                node: 0,
            };
            self.queue(at.ray.node, ray);
        }
        self.branches = branches;
    }

    /// Counts a secondary ray's weight as truncated.
    pub fn cut(&mut self, at: &Arrival, kind: RayKind, weight: DVec3, too_deep: bool, too_light: bool) {
        let proven = matches!(self.prepared.tolls, Ok(Some(_)));
        let limit = match (too_deep, too_light && !proven) {
            (true, _) => Limit::Depth,
            (false, true) => Limit::Cutoff,
            (false, false) => Limit::Asked,
        };
        self.tally.end(limit, weight);
        self.note(at.ray.node, |event| event.cut.push(Cut { kind, weight, too_deep, too_light }));
    }
}
