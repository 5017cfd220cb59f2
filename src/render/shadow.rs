//! Light on its way to a surface: what is in between.

use super::lamp::before_lamp;
use super::outcome::{RayKind, Stage};
use super::queue::Chunk;
use super::split::lane_bits;
use super::stages::{March, STREAM};
use super::surface::HitRef;
use super::worker::{MOST_PASSES, Worker};
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit8};
use crate::math::Real;
use crate::simd::Mask8;

impl<I: Intersector> Worker<'_, I> {
    /// Traces the shadow rays that wait, sent by hits at `depth`, and adds what gets through to their pixels.
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

    /// Traces the shadow rays that are asked first, gives their places the answers, and adds what counts of their light.
    pub(super) fn answer_probes(&mut self, depth: usize, coherence: Coherence) {
        if self.shading.probes.queue.is_empty() {
            return;
        }
        let mut chunk = std::mem::take(&mut self.shadow_chunk);
        chunk.clear();
        self.shading.probes.queue.take(usize::MAX, &mut chunk);
        let mut weights = std::mem::take(&mut self.shadow_weights);
        weights.clear();
        weights.extend(chunk.states.iter().map(|state| state.weight));
        self.trace_shadows(&mut chunk, depth, coherence);
        let probes = &mut self.shading.probes;
        let packets = chunk.rays.iter().zip(&chunk.states).zip(&weights);
        for (((ray, state), before), askers) in packets.zip(probes.askers.chunks(8)) {
            let [same_x, same_y, same_z] =
                [state.weight.x.eq(before.x), state.weight.y.eq(before.y), state.weight.z.eq(before.z)];
            let whole = (same_x & same_y & same_z).bits();
            let mut counting = 0;
            for (lane, asker) in askers.iter().enumerate() {
                let arrives = ray.active >> lane & 1 != 0;
                probes.verdicts[asker.place as usize].add(arrives, whole >> lane & 1 != 0);
                counting |= u8::from(arrives && asker.counts) << lane;
            }
            self.shading.accumulator.add_light8(counting, &state.pixel, &state.weight);
        }
        probes.askers.clear();
        self.shadow_weights = weights;
        self.shadow_chunk = chunk;
    }

    /// Leaves those rays active whose light arrives, with the weight that it arrives with.
    fn trace_shadows(&mut self, chunk: &mut Chunk, depth: usize, coherence: Coherence) {
        self.shading.streams.count(Stage::Shadow);
        self.shading.counts.add(RayKind::Shadow, depth, chunk.len());
        let mut blocked = std::mem::take(&mut self.blocked);
        blocked.clear();
        blocked.resize(chunk.rays.len(), Mask8::NONE);
        self.cut_short(chunk);
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

    /// Ends the rays before whatever their lamps stand on, and keeps their lengths for [`Worker::restore`].
    fn cut_short(&mut self, chunk: &mut Chunk) {
        self.shadow_ends.clear();
        self.shadow_ends.extend(chunk.rays.iter().map(|ray| ray.t_max));
        for ray in &mut chunk.rays {
            ray.t_max = before_lamp(ray.origin, ray.dir, ray.t_max);
        }
    }

    /// Gives the rays their lengths back, which absorption goes by.
    fn restore(&self, chunk: &mut Chunk) {
        for (ray, &end) in chunk.rays.iter_mut().zip(&self.shadow_ends) {
            ray.t_max = end;
        }
    }

    /// Takes the unblocked rays over the transmissive surfaces in their way, weakening them at each. Every ray comes
    /// out with its whole weight settled; one that nothing gets through comes out inactive.
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
            self.accel.closest(&chunk.rays, &mut hits, coherence, &mut self.scratch);
            self.restore(chunk);

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
