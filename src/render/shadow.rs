//! Occlusion of lamp light: tracing of shadow rays.

use super::lamp::before_lamp;
use super::outcome::{RayKind, Stage};
use super::queue::Chunk;
use super::shading::Shading;
use super::split::lane_bits;
use super::stages::{March, STREAM};
use super::surface::HitRef;
use super::worker::Worker;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit8};
use crate::scene::MOST_PASSES;
use crate::simd::Mask8;

impl<I: Intersector> Worker<'_, I> {
    /// Traces the queued shadow rays of hits at `depth`, and adds the light that arrives to their pixels.
    pub(super) fn flush_shadows(&mut self, depth: usize, coherence: Coherence) {
        if self.shading.shadows.is_empty() {
            return;
        }
        let mut chunk = std::mem::take(&mut self.shadow_chunk);
        chunk.clear();
        self.shading.shadows.take(usize::MAX, &mut chunk);
        self.trace_shadows(&mut chunk, depth, coherence);
        let packets = chunk.rays.iter().zip(&chunk.states);
        self.shading.accumulator.add_light(packets.map(|(ray, state)| (ray.active, &state.pixel, &state.weight)));
        self.shadow_chunk = chunk;
    }

    /// Traces the shadow rays. Rays whose light arrives stay active, with the weight that arrives.
    fn trace_shadows(&mut self, chunk: &mut Chunk, depth: usize, coherence: Coherence) {
        self.shading.streams.count(Stage::Shadow);
        self.shading.counts.add(RayKind::Shadow, depth, chunk.len());
        let mut blocked = std::mem::take(&mut self.blocked);
        blocked.clear();
        blocked.resize(chunk.rays.len(), Mask8::NONE);
        self.cut_short(chunk);
        if self.stages.march.is_none() && self.stages.touching {
            // A ray that would pass further layers of its own start is blocked by them, so held-back rays need not be
            // restored.
            self.shading.shadow_arrivals.hold_back(chunk);
        }
        self.accel.occluded(&chunk.rays, &mut blocked, coherence, &mut self.scratch);
        self.restore(chunk);
        for (ray, blocked) in chunk.rays.iter_mut().zip(&blocked) {
            ray.active &= !blocked.bits();
        }
        self.blocked = blocked;
        if let Some(march) = self.stages.march {
            self.march(march, chunk, coherence);
        }
    }

    /// Ends the rays slightly before their lamps, and saves their lengths for [`Worker::restore`].
    fn cut_short(&mut self, chunk: &mut Chunk) {
        self.shadow_ends.clear();
        self.shadow_ends.extend(chunk.rays.iter().map(|ray| ray.t_max));
        for ray in &mut chunk.rays {
            ray.t_max = before_lamp(ray.origin, ray.dir, ray.t_max);
        }
    }

    /// Restores the lengths of the rays, which absorption depends on.
    fn restore(&self, chunk: &mut Chunk) {
        for (ray, &end) in chunk.rays.iter_mut().zip(&self.shadow_ends) {
            ray.t_max = end;
        }
    }

    /// Marches the unblocked rays through the transmissive surfaces on their way, and multiplies their weights at each.
    /// Rays that arrive stay active with their final weight; fully absorbed rays become inactive.
    fn march(&mut self, stages: March, chunk: &mut Chunk, coherence: Coherence) {
        let mut arrived = std::mem::take(&mut self.arrived);
        arrived.clear();
        arrived.resize(chunk.rays.len(), 0);
        let mut hits = std::mem::take(&mut self.shadow_hits);
        for ray in &mut chunk.rays {
            ray.admits = GeometryMask::TRANSMISSIVE;
        }
        for step in 0.. {
            hits.clear();
            hits.resize(chunk.rays.len(), Hit8::default());
            self.cut_short(chunk);
            if self.stages.touching {
                self.shading.shadow_arrivals.hold_back(chunk);
            }
            self.accel.closest(&chunk.rays, &mut hits, coherence, &mut self.scratch);
            self.restore(chunk);
            if self.stages.touching {
                let mut arrivals = std::mem::take(&mut self.shading.shadow_arrivals);
                arrivals.arrive(&mut self.shading, chunk, &mut hits);
                self.shading.shadow_arrivals = arrivals;
            }

            let mut refs = std::mem::take(&mut self.shadow_refs);
            refs.clear();
            for packet in 0..chunk.rays.len() {
                let active = chunk.rays[packet].active;
                let hit = lane_bits(|k| hits[packet].lane(k).is_hit()) & active;
                if let Some(finish) = stages.finish {
                    finish(&self.shading, chunk, packet, active & !hit);
                }
                arrived[packet] |= active & !hit;
                chunk.rays[packet].active = hit;
                refs.extend((0..8).filter(|k| hit >> k & 1 != 0).map(|k| (packet * 8 + k) as HitRef));
            }
            let done = refs.is_empty() || step == MOST_PASSES;
            if !done {
                for stream in refs.chunks(STREAM) {
                    self.shading.streams.count(Stage::Pass);
                    (stages.gather)(self.shading.scene, chunk, &hits, stream, &mut self.shadow_surfaces);
                    if self.shading.carries {
                        self.shading.carry(chunk, stream, &mut self.shadow_surfaces);
                    }
                    if self.stages.touching {
                        let Shading { touching, shadow_arrivals, .. } = &mut self.shading;
                        shadow_arrivals.mark(touching, stream, &mut self.shadow_surfaces);
                    }
                    (stages.pass)(&mut self.shading, chunk, &hits, stream, &self.shadow_surfaces);
                }
            }
            self.shadow_refs = refs;
            if done {
                break;
            }
        }
        for (ray, &arrived) in chunk.rays.iter_mut().zip(&arrived) {
            ray.active = arrived;
        }
        self.arrived = arrived;
        self.shadow_hits = hits;
    }
}
