//! Light on its way to a surface: what is in between.

use glam::Vec3;

use super::lamp::before_lamp;
use super::media::StackId;
use super::outcome::RayKind;
use super::queue::{Chunk, Rgb8};
use super::shade::{gather_boundaries, lane_bits};
use super::surface::{HitRef, Surface8};
use super::worker::{MOST_PASSES, Worker};
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit8};
use crate::math::Real;
use crate::optics::{Boundary, FresnelFormula, thin_reflectance, transmittance};
use crate::scene::{FresnelRule, Interface};
use crate::simd::{F32x8, Mask8, Vec3x8};

impl<I: Intersector> Worker<'_, I> {
    /// Traces the shadow rays that wait, sent by hits at `depth`, and adds what gets through to their pixels.
    pub(super) fn flush_shadows<F: FresnelFormula>(&mut self, depth: usize, coherence: Coherence) {
        if self.shadows.is_empty() {
            return;
        }
        let mut chunk = std::mem::take(&mut self.shadow_chunk);
        chunk.clear();
        self.shadows.take(usize::MAX, &mut chunk);
        self.counts.add(RayKind::Shadow, depth, chunk.len());

        let mut blocked = std::mem::take(&mut self.blocked);
        blocked.clear();
        blocked.resize(chunk.rays.len(), Mask8::NONE);
        self.cut_short(&mut chunk);
        self.accel.occluded(&chunk.rays, &mut blocked, coherence, &mut self.scratch);
        self.restore(&mut chunk);
        for (ray, blocked) in chunk.rays.iter_mut().zip(&blocked) {
            ray.active &= !blocked.bits();
        }
        self.blocked = blocked;

        if self.march_shadows {
            self.march::<F>(&mut chunk, coherence);
        }
        for (ray, state) in chunk.rays.iter().zip(&chunk.states) {
            self.accumulator.add_radiance8(ray.active, &state.pixel, &state.weight);
        }
        self.shadow_chunk = chunk;
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
    fn march<F: FresnelFormula>(&mut self, chunk: &mut Chunk, coherence: Coherence) {
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
                self.finish(chunk, packet, active & !hit);
                arrived[packet] |= active & !hit;
                chunk.rays[packet].active = hit;
                refs.extend((0..8).filter(|k| hit >> k & 1 != 0).map(|k| (packet * 8 + k) as HitRef));
            }
            let done = refs.is_empty() || step == MOST_PASSES;
            if !done {
                for eight in refs.chunks(8) {
                    self.pass_through::<F>(chunk, &hits, eight);
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

    /// The last stretch, to the light itself.
    fn finish(&self, chunk: &mut Chunk, packet: usize, lanes: u8) {
        let state = &mut chunk.states[packet];
        let t = chunk.rays[packet].t_max + state.lead;
        if let Some(left) = self.absorbed(lanes, &state.stack, t) {
            state.weight = state.weight.times(left);
        }
    }

    /// Weakens up to eight shadow rays at the transmissive surfaces they met, and starts them again behind.
    fn pass_through<F: FresnelFormula>(&mut self, chunk: &mut Chunk, hits: &[Hit8], refs: &[HitRef]) {
        let surface = Surface8::gather(self.scene, chunk, hits, refs);
        let t = F32x8::from_fn(|k| surface.hit[k].t);
        let lead =
            F32x8::from_fn(|k| refs.get(k).map_or(0.0, |&r| chunk.states[r as usize >> 3].lead.lane(r as usize & 7)));
        let mut weight = surface.weight;
        if let Some(left) = self.absorbed(surface.active, &surface.stack, t + lead) {
            weight = weight.times(left);
        }
        let mut beyond = surface.stack;
        let passed = self.passed::<F>(&surface, &mut beyond);
        weight = weight.times(passed);
        let origin = surface.below();
        let lead = surface.lead(surface.incident);
        for (k, &r) in refs.iter().enumerate() {
            let (packet, lane) = (r as usize >> 3, r as usize & 7);
            let ray = &mut chunk.rays[packet];
            let state = &mut chunk.states[packet];
            let rest = ray.t_max.lane(lane) - t.lane(k) - lead.lane(k);
            ray.origin.set_lane(lane, origin.lane(k));
            ray.t_max.set_lane(lane, rest);
            state.weight.set_lane(lane, weight.lane(k));
            state.stack[lane] = beyond[k];
            state.lead.set_lane(lane, lead.lane(k));
            if weight.lane(k) == Vec3::ZERO {
                ray.active &= !(1 << lane);
            }
        }
    }

    /// What each of eight transmissive surfaces lets through unbent, and the media behind it.
    fn passed<F: FresnelFormula>(&mut self, surface: &Surface8, beyond: &mut [StackId; 8]) -> Rgb8 {
        let mut boundaries = [Boundary::<f32>::new(1.0, 1.0); 8];
        let mut tint = Vec3x8::splat(Vec3::ONE);
        let mut fixed = Vec3x8::splat(Vec3::ZERO);
        let (mut by_rule, mut thin) = (0_u8, 0_u8);
        for k in 0..8 {
            let material = &self.scene.materials[surface.material[k] as usize];
            match material.interface {
                Interface::Dielectric { medium, rule, tint: colour } => {
                    let crossing = self.media.cross(surface.stack[k], medium, surface.front.lane(k));
                    beyond[k] = crossing.beyond;
                    self.unmatched_exits += u64::from(crossing.unmatched && surface.active >> k & 1 != 0);
                    if crossing.real {
                        boundaries[k] = crossing.thin_side;
                        tint.set_lane(k, colour);
                        if let FresnelRule::Fixed(share) = rule {
                            by_rule |= 1 << k;
                            fixed.set_lane(k, share);
                        }
                    }
                }
                Interface::ThinDielectric { ior, rule, tint: colour } => {
                    boundaries[k] = Boundary::new(self.media.ior(surface.stack[k]), f64::from(ior));
                    thin |= 1 << k;
                    tint.set_lane(k, colour);
                    if let FresnelRule::Fixed(share) = rule {
                        by_rule |= 1 << k;
                        fixed.set_lane(k, share);
                    }
                }
                Interface::Alpha { opacity } => tint.set_lane(k, Vec3::splat(1.0 - opacity)),
                Interface::Opaque
                | Interface::Mirror { .. }
                | Interface::Conductor { .. }
                | Interface::Coated { .. } => {
                    tint.set_lane(k, Vec3::ZERO);
                }
            }
        }
        let boundary = gather_boundaries(|k| boundaries[k]);
        let cos_i = -surface.incident.dot(surface.normal);
        let at = boundary.cross(cos_i);
        let face = F::dielectric(&boundary, &at);
        let reflectance = Real::select(Mask8::from_bits(thin), thin_reflectance(face), face);
        let reflected = Vec3x8::select(Mask8::from_bits(by_rule) & !at.total, fixed, Vec3x8::all(reflectance));
        (Vec3x8::splat(Vec3::ONE) - reflected).times(tint)
    }

    /// What the media on top of the stacks leave of light over `t`; `None` where none of `lanes` is in a medium that
    /// absorbs.
    pub(super) fn absorbed(&self, lanes: u8, stack: &[StackId; 8], t: F32x8) -> Option<Rgb8> {
        let mut coefficient = Vec3x8::splat(Vec3::ZERO);
        let mut any = false;
        for k in super::accumulate::set_lanes(lanes) {
            if let Some(absorption) = self.media.absorption(stack[k]) {
                coefficient.set_lane(k, absorption);
                any = true;
            }
        }
        any.then(|| transmittance(coefficient, t))
    }
}
