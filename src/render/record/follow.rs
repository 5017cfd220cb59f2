//! Recorder for the eight-wide renderer, which traces one ray at a time.
//!
//! Each ray runs through the same functions as in a picture ([`crate::render::stages`]), in a stream of its own. The
//! effect of each stage is read from the queues and the sums. These do not depend on the other rays of a stream. So the
//! pixel equals that of the picture, to the bit, and no stage contains code for recording.

use std::mem::take;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;

use super::{Cut, Event, Met, Node, Share, Source, Split, Tree};
use crate::accel::{Coherence, Intersector};
use crate::geometry::{Hit8, Ray8};
use crate::math::LaneMask;
use crate::optics::{Boundary, RefractionModel};
use crate::render::RayKind;
use crate::render::lamp::before_lamp;
use crate::render::queue::{Chunk, State8};
use crate::render::shading::Shading;
use crate::render::shine::Shiner;
use crate::render::soft::SoftStages;
use crate::render::split::SplitStage;
use crate::render::surface::Surface8;
use crate::render::tile::Tile;
use crate::render::worker::Worker;
use crate::scene::Interface;
use crate::simd::{F32x8, Vec3x8};
use crate::{Error, Result};

/// Queued ray, alone in the first lane of its packet.
struct Waiting {
    chunk: Chunk,
    depth: usize,
    kind: RayKind,
    node: Node,
}

/// Secondary ray that a split stage sent while no limits applied.
struct Sent {
    kind: RayKind,
    weight: Vec3x8,
    dir: Vec3x8,
}

/// Traces and records all rays of a tile of one pixel. Leaves the sums in the worker's accumulator.
///
/// # Errors
/// Returns [`Error::Interrupted`] if the observer requests a stop.
pub fn record<I: Intersector>(worker: &mut Worker<I>, tile: &Tile) -> Result<Tree> {
    let mut tree = Tree::default();
    worker.shading.accumulator.reset(1);
    let mut blocks = Vec::new();
    tile.blocks(&mut blocks);
    let n = worker.shading.scene.settings.samples;
    for sample in 0..n * n {
        let mut chunk = Chunk::default();
        worker.shading.tile = *tile;
        worker.begin(sample);
        worker.camera_rays(tile, &blocks, sample..sample + 1, &mut chunk);
        let chunk = alone(&chunk, 0, 0);
        let node = tree.sent(event(&worker.shading, &chunk, None, RayKind::Camera, 0));
        let mut waiting = vec![Waiting { chunk, depth: 0, kind: RayKind::Camera, node }];
        while let Some(ray) = waiting.pop() {
            worker.follow(ray, &mut tree, &mut waiting)?;
        }
    }
    Ok(tree)
}

impl<I: Intersector> Worker<'_, I> {
    fn follow(&mut self, mut ray: Waiting, tree: &mut Tree, waiting: &mut Vec<Waiting>) -> Result<()> {
        if self.observer.stop.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        self.shading.counts.add(ray.kind, ray.depth, 1);
        let coherence = if ray.depth == 0 { Coherence::Coherent } else { Coherence::Incoherent };
        let mut hits = [Hit8::default()];
        if self.stages.touching {
            self.shading.arrivals.hold_back(&mut ray.chunk);
        }
        self.accel.closest(&ray.chunk.rays, &mut hits, coherence, &mut self.scratch);
        if self.stages.touching {
            self.arrive(&mut ray.chunk, &mut hits);
        }
        let stages = self.stages;
        if let Some(medium) = stages.medium {
            medium(&self.shading, &mut ray.chunk, &hits);
        }
        let state = ray.chunk.states[0];
        let hit = hits[0].lane(0);
        tree.at(ray.node, |event| {
            event.t = f64::from((hits[0].t + state.lead).lane(0));
            event.arrived = widened(state.weight);
        });
        let Some(&bin) = self.bin_of.get(hit.geometry as usize) else {
            let before = self.added();
            if let Some(miss) = stages.miss {
                miss(&mut self.shading, &ray.chunk, &[0]);
            }
            let radiance = self.added_since(before);
            tree.at(ray.node, |event| event.shares.push(Share::free(Source::Environment, radiance)));
            return Ok(());
        };
        let stages = &stages.bins[bin as usize];
        match stages {
            Some(stages) => (stages.gather)(self.shading.scene, &ray.chunk, &hits, &[0], &mut self.surfaces),
            None => self.surfaces = vec![Surface8::one(self.shading.scene, &ray.chunk, &hits)],
        }
        if self.stages.touching {
            self.mark(&[0]);
        }
        self.see(&ray, tree);
        let Some(stages) = stages else { return Ok(()) };
        if let Some((_, split)) = stages.split {
            let before = self.added();
            split(&mut self.shading, &mut self.surfaces, ray.depth);
            let mirrored = self.added_since(before);
            if mirrored != DVec3::ZERO {
                let share = Share::free(Source::MirroredEnvironment, mirrored);
                tree.at(ray.node, |event| event.shares.push(share));
            }
            for (kind, depth, chunk) in drained(&mut self.shading) {
                let node = tree.sent(event(&self.shading, &chunk, Some(ray.node), kind, depth));
                waiting.push(Waiting { chunk, depth, kind, node });
            }
        }
        let Some(base) = stages.base else { return Ok(()) };
        let before = self.added();
        base(&mut self.shading, &self.surfaces, &mut self.bases);
        let glow = self.added_since(before);
        if glow != DVec3::ZERO {
            tree.at(ray.node, |event| event.shares.push(Share::free(Source::Glow, glow)));
        }
        // The march of shadow rays fills the worker's list with surfaces of its own.
        let surfaces = take(&mut self.surfaces);
        for &(light, shine) in &stages.lights {
            let before = self.added();
            shine(&mut self.shading, light, &surfaces, &self.bases);
            let shadow = self.shading.shadows.rays.first().copied();
            let waits: DVec3 = self.shading.shadows.states.iter().map(|state| widened(state.weight)).sum();
            self.flush_shadows(ray.depth, coherence);
            let radiance = self.added_since(before);
            let unshadowed = if shadow.is_some() { waits } else { radiance };
            if unshadowed == DVec3::ZERO {
                continue;
            }
            let blocker = shadow.filter(|_| radiance == DVec3::ZERO).and_then(|shadow| self.blocker(shadow));
            let share = Share { source: Source::Light(light as u32), unshadowed, radiance, blocker };
            tree.at(ray.node, |event| event.shares.push(share));
        }
        for (lamp, soft) in &stages.lamps {
            if let Some(share) = self.soft_share(*lamp, soft, ray.depth, coherence) {
                tree.at(ray.node, |event| event.shares.push(share));
            }
        }
        Ok(())
    }

    /// Adds the light of an area lamp to the surface and returns it as one contribution. Returns `None` if it is zero
    /// even without occlusion.
    fn soft_share(&mut self, lamp: usize, soft: &SoftStages, depth: usize, coherence: Coherence) -> Option<Share> {
        let sums = take(&mut self.shading.accumulator);
        self.shading.accumulator.reset(1);
        (soft.unoccluded)(&mut self.shading, lamp, &self.surfaces, &self.bases, depth);
        let unshadowed = from_fixed(self.shading.accumulator.sums(0).0);
        self.shading.accumulator = sums;
        if unshadowed == DVec3::ZERO {
            return None;
        }
        let before = self.added();
        let mut shadow = None;
        if soft.shadows {
            (soft.shadowed)(&mut self.shading, lamp, &self.surfaces, &self.bases, depth);
            shadow = self.shading.shadows.rays.first().copied();
            self.flush_shadows(depth, coherence);
        } else {
            (soft.unoccluded)(&mut self.shading, lamp, &self.surfaces, &self.bases, depth);
        }
        let radiance = self.added_since(before);
        let blocker = shadow.filter(|_| radiance == DVec3::ZERO).and_then(|shadow| self.blocker(shadow));
        let source = match Shiner::of(lamp, self.shading.scene) {
            None => Source::Light(lamp as u32),
            Some(Shiner::Emitters) => Source::Emitters,
            Some(Shiner::Around) => Source::Sky,
        };
        Some(Share { source, unshadowed, radiance, blocker })
    }

    /// Records the surface hit, its division of light, and the rays that the limits will end.
    fn see(&mut self, ray: &Waiting, tree: &mut Tree) {
        let surface = self.surfaces[0].clone();
        let cos_i = -surface.incident.dot(surface.shading);
        let (object, primitive) = (surface.hit[0].geometry, surface.hit[0].primitive);
        let point = surface.point.lane(0).as_dvec3();
        let split = self.stages.bins[self.bin_of[object as usize] as usize].as_ref().and_then(|bin| bin.split);
        let split = split.map(|(_, split)| split);
        let one = Vec3x8::splat(glam::Vec3::ONE);
        let unit = self.tried(split, &surface, one, ray.depth);
        let real = self.tried(split, &surface, surface.weight, ray.depth);
        let (max_depth, cutoff) = (self.shading.max_depth, self.shading.cutoff);
        let absent = unit.surface.base_lanes == 0;
        let split = self.split(&surface, &unit, cos_i);
        tree.at(ray.node, |event| {
            event.met = if event.arrived == DVec3::ZERO {
                Met::Spent
            } else if absent {
                Met::Absent { object, primitive, point }
            } else {
                let front = surface.front.lane(0);
                Met::Surface { object, primitive, point, front, cos_i: f64::from(cos_i.lane(0)) }
            };
            event.split = (!absent).then_some(split);
            for sent in real.sent.iter().filter(|_| !absent) {
                let heaviest = sent.weight.max_component().lane(0);
                let (too_deep, too_light) = (ray.depth >= max_depth, heaviest < cutoff);
                if too_deep || too_light {
                    event.cut.push(Cut { kind: sent.kind, weight: widened(sent.weight), too_deep, too_light });
                }
            }
            if real.lost != DVec3::ZERO {
                let kind = RayKind::Transmitted;
                event.cut.push(Cut { kind, weight: real.lost, too_deep: false, too_light: false });
            }
        });
    }

    /// Runs a split stage on a surface with light of some weight and without limits. Restores the state afterwards.
    fn tried(&mut self, split: Option<SplitStage>, surface: &Surface8, weight: Vec3x8, depth: usize) -> Tried {
        let mut surfaces = [Surface8 { weight, base_weight: weight, ..surface.clone() }];
        let Some(split) = split else {
            let [surface] = surfaces;
            return Tried { surface, sent: Vec::new(), lost: DVec3::ZERO };
        };
        let shading = &mut self.shading;
        let accumulator = take(&mut shading.accumulator);
        let kept = (shading.unmatched_exits.clone(), shading.max_depth, shading.cutoff);
        shading.accumulator.reset(1);
        (shading.max_depth, shading.cutoff) = (usize::MAX, 0.0);
        split(shading, &mut surfaces, depth);
        let sent = drained(shading).into_iter().map(|(kind, _, chunk)| Sent {
            kind,
            weight: chunk.states[0].weight,
            dir: chunk.rays[0].dir,
        });
        let sent = sent.collect();
        let lost = from_fixed(shading.accumulator.sums(0).1);
        shading.accumulator = accumulator;
        (shading.unmatched_exits, shading.max_depth, shading.cutoff) = kept;
        let [surface] = surfaces;
        Tried { surface, sent, lost }
    }

    /// Returns the division of light at a surface, from its stage's result for a weight of 1.
    fn split(&mut self, surface: &Surface8, unit: &Tried, cos_i: F32x8) -> Split {
        let shading = &mut self.shading;
        let of = |kind: RayKind| unit.sent.iter().find(|sent| sent.kind == kind);
        let share = |kind: RayKind| -> DVec3 {
            unit.sent.iter().filter(|sent| sent.kind == kind).map(|sent| widened(sent.weight)).sum()
        };
        let (reflected, transmitted) = (share(RayKind::Reflected), share(RayKind::Transmitted));
        let one = glam::Vec3::ONE;
        let tinted = |tint: glam::Vec3| ((one - reflected.as_vec3()) * (one - tint)).as_dvec3();
        let interface = shading.interface(surface, 0);
        let stack = surface.stack[0];
        let split = Split { reflected, transmitted, absorbed: widened(unit.surface.base_weight), ..Split::OPAQUE };
        match *interface {
            Interface::Opaque | Interface::Alpha { .. } => split,
            Interface::Mirror { reflectance, .. } => {
                Split { reflected: reflectance.as_dvec3(), absorbed: (one - reflectance).as_dvec3(), ..split }
            }
            Interface::Conductor { .. } => Split { absorbed: (one - reflected.as_vec3()).as_dvec3(), ..split },
            Interface::Coated { ior } => Split { indices: Some((shading.media.ior(stack), f64::from(ior))), ..split },
            Interface::ThinDielectric { ior, tint, .. } => {
                let indices = (shading.media.ior(stack), f64::from(ior));
                let total = Boundary::<F32x8>::new(indices.0, indices.1).cross(cos_i).total.any();
                Split { indices: Some(indices), total, absorbed: tinted(tint), ..split }
            }
            Interface::Dielectric { tint, .. } => {
                let Some(transition) = shading.transition(surface, 0) else { return split };
                let [from, to] = transition.media;
                let ior = |m: u32| shading.scene.media[m as usize].ior;
                let indices = if transition.unmatched {
                    (ior(from), ior(to))
                } else {
                    // A ray of one wavelength uses the indices at that wavelength.
                    let before = if shading.media.top(stack) == from { shading.media.ior(stack) } else { ior(from) };
                    let beyond = shading.media.ior(transition.beyond);
                    (before, if shading.media.top(transition.beyond) == to { beyond } else { ior(to) })
                };
                let crossing = transition.boundary.cross(cos_i.lane(0));
                let bent = of(RayKind::Transmitted).filter(|_| !crossing.total).map(|sent| {
                    if self.stages.refraction == RefractionModel::Stable {
                        crossing.cos_t
                    } else {
                        -sent.dir.dot(surface.shading).lane(0)
                    }
                });
                let absorbed = if crossing.total { DVec3::ZERO } else { tinted(tint) };
                let cos_t = bent.map(f64::from);
                // Light that the formula lost for lack of a direction counts as transmitted.
                let transmitted = transmitted + unit.lost;
                Split { indices: Some(indices), cos_t, total: crossing.total, transmitted, absorbed, ..split }
            }
        }
    }

    /// Returns the nearest object that blocks a shadow ray by itself.
    fn blocker(&mut self, mut shadow: Ray8) -> Option<u32> {
        shadow.active = 1;
        shadow.t_max = before_lamp(shadow.origin, shadow.dir, shadow.t_max);
        let mut hits = [Hit8::default()];
        self.accel.closest(&[shadow], &mut hits, Coherence::Incoherent, &mut self.scratch);
        let hit = hits[0].lane(0);
        hit.is_hit().then_some(hit.geometry)
    }

    /// Returns the current radiance sum of the pixel.
    fn added(&self) -> [i128; 3] {
        self.shading.accumulator.sums(0).0
    }

    /// Returns the radiance added since the sum was `before`.
    fn added_since(&self, before: [i128; 3]) -> DVec3 {
        let now = self.added();
        from_fixed(std::array::from_fn(|k| now[k] - before[k]))
    }
}

/// Result of [`Worker::tried`].
struct Tried {
    /// Surface with the weight of its base.
    surface: Surface8,
    sent: Vec<Sent>,
    /// Weight of light for which the formula gave no direction.
    lost: DVec3,
}

/// Moves all rays out of the queues, each into a packet of its own.
fn drained(shading: &mut Shading) -> Vec<(RayKind, usize, Chunk)> {
    let mut rays = Vec::new();
    while let Some((depth, kind)) = shading.next_queue(usize::MAX) {
        let mut chunk = Chunk::default();
        shading.queue(kind, depth).take(usize::MAX, &mut chunk);
        for (packet, ray) in chunk.rays.iter().enumerate() {
            let lanes = (0..8).filter(|lane| ray.active >> lane & 1 != 0);
            rays.extend(lanes.map(|lane| (kind, depth, alone(&chunk, packet, lane))));
        }
    }
    // Transmitted rays first: rays are taken from the end, so the reflected one is traced first.
    rays.sort_by_key(|(kind, ..)| *kind == RayKind::Reflected);
    rays
}

/// Copies one ray to the first lane of a new packet.
fn alone(chunk: &Chunk, packet: usize, lane: usize) -> Chunk {
    let (from, state) = (&chunk.rays[packet], &chunk.states[packet]);
    let all = |x: F32x8| F32x8::from(x.lane(lane));
    let vector = |v: Vec3x8| Vec3x8::splat(v.lane(lane));
    let ray = Ray8 {
        origin: vector(from.origin),
        dir: vector(from.dir),
        t_min: all(from.t_min),
        t_max: all(from.t_max),
        active: 1,
        ..*from
    };
    let state = State8 {
        weight: vector(state.weight),
        pixel: [0; 8],
        stack: [state.stack[lane]; 8],
        lead: all(state.lead),
        passes: [state.passes[lane]; 8],
    };
    Chunk { rays: vec![ray], states: vec![state], extras: Vec::new() }
}

/// Creates the record of a ray that is about to be traced.
fn event(shading: &Shading, chunk: &Chunk, parent: Option<Node>, kind: RayKind, depth: usize) -> Event {
    let (ray, state) = (&chunk.rays[0], &chunk.states[0]);
    let line = (ray.origin.lane(0).as_dvec3(), ray.dir.lane(0).as_dvec3());
    let media = shading.media.entered(state.stack[0]).to_vec();
    Event { media, ..Event::sent(parent, kind, depth as u32, line, widened(state.weight)) }
}

/// Converts the first lane to `f64`.
fn widened(v: Vec3x8) -> DVec3 {
    v.lane(0).as_dvec3()
}

/// Converts from units of 2^-64. Exact for a single contribution, which has the digits of an `f32`.
fn from_fixed(sums: [i128; 3]) -> DVec3 {
    DVec3::from_array(sums.map(|s| s as f64 * 2.0_f64.powi(-64)))
}
