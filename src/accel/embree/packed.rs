//! Rays kept in Embree's own layout, so that a benchmark times the calls alone.

use super::hierarchy::{Embree, query};
use super::options::Width;
use super::packet::{self, Interval};
use super::scene::Scene;
use super::sys::{QueryArguments, RtcRay1, RtcRay8, RtcRay16, RtcRayHit1, RtcRayHit8, RtcRayHit16, Valid};
use crate::accel::Coherence;
use crate::geometry::{Hit, Hit8, Ray8};
use crate::simd::{Mask8, set_lanes};
use bytemuck::Zeroable;

/// Rays in Embree's layout, with room for the hits. A call overwrites them, so [`Embree::pack`] must precede each call.
#[derive(Default)]
pub struct Packed {
    calls: Calls,
    /// Active lanes of each packet call.
    live: Vec<u16>,
}

/// Structs, one for each call.
#[derive(Default)]
enum Calls {
    #[default]
    None,
    Closest1(Vec<RtcRayHit1>),
    Closest8(Vec<RtcRayHit8>),
    Closest16(Vec<RtcRayHit16>),
    Occluded1(Vec<RtcRay1>),
    Occluded8(Vec<RtcRay8>),
    Occluded16(Vec<RtcRay16>),
}

/// Lane masks of full packets.
const FULL8: Valid<8> = Valid([-1; 8]);
const FULL16: Valid<16> = Valid([-1; 16]);

/// Makes `calls` hold `$n` zeroed structs of the variant, and returns them.
macro_rules! room {
    ($calls:expr, $variant:ident, $n:expr) => {{
        if !matches!($calls, Calls::$variant(_)) {
            $calls = Calls::$variant(Vec::new());
        }
        let Calls::$variant(room) = &mut $calls else { unreachable!("it was just set") };
        room.resize_with($n, Zeroable::zeroed);
        room
    }};
}

impl Embree {
    /// Stores `rays` in `packed` for calls of the given width, which find any hit or the nearest one. [`Width::Auto`]
    /// means 8.
    pub fn pack(&self, rays: &[Ray8], width: Width, any_hit: bool, packed: &mut Packed) {
        let intervals = || rays.iter().map(|r| (r, Interval::of(r, self.mode)));
        let Packed { calls, live } = packed;
        live.clear();
        match width {
            Width::One => {
                let count = intervals().map(|(_, i)| i.live.count_ones() as usize).sum();
                let each = intervals().flat_map(|(r, i)| set_lanes(i.live).map(move |lane| (r, i, lane)));
                if any_hit {
                    let mut one = RtcRayHit1::zeroed();
                    for (to, (rays, interval, lane)) in room!(*calls, Occluded1, count).iter_mut().zip(each) {
                        one.load(lane, rays, &interval);
                        *to = one.ray;
                    }
                } else {
                    for (to, (rays, interval, lane)) in room!(*calls, Closest1, count).iter_mut().zip(each) {
                        to.load(lane, rays, &interval);
                    }
                }
            }
            Width::Auto | Width::Eight => {
                live.extend(intervals().map(|(_, i)| u16::from(i.live)));
                if any_hit {
                    for (to, (rays, interval)) in room!(*calls, Occluded8, rays.len()).iter_mut().zip(intervals()) {
                        to.load(0, rays, &interval);
                    }
                } else {
                    for (to, (rays, interval)) in room!(*calls, Closest8, rays.len()).iter_mut().zip(intervals()) {
                        to.hit.clear();
                        to.ray.load(0, rays, &interval);
                    }
                }
            }
            Width::Sixteen => {
                let calls_needed = rays.len().div_ceil(2);
                live.resize(calls_needed, 0);
                for (k, (_, interval)) in intervals().enumerate() {
                    live[k / 2] |= u16::from(interval.live) << (8 * (k % 2));
                }
                if any_hit {
                    let room = room!(*calls, Occluded16, calls_needed);
                    for (k, (rays, interval)) in intervals().enumerate() {
                        room[k / 2].load(k % 2, rays, &interval);
                    }
                } else {
                    let room = room!(*calls, Closest16, calls_needed);
                    for (k, (rays, interval)) in intervals().enumerate() {
                        room[k / 2].hit.clear();
                        room[k / 2].ray.load(k % 2, rays, &interval);
                    }
                }
            }
        }
    }

    /// Makes the calls: the part that is timed.
    pub fn trace_packed(&self, packed: &mut Packed, coherence: Coherence) {
        let query = query(coherence);
        // Packed rays admit all kinds of geometry. If the library supports masks, there is only one scene.
        for scene in self.parts.iter().map(|(_, scene)| scene) {
            Self::trace_scene(scene, packed, &query);
        }
    }

    #[inline(always)]
    fn trace_scene(scene: &Scene, packed: &mut Packed, query: &QueryArguments) {
        let live = &packed.live;
        match &mut packed.calls {
            Calls::None => {}
            Calls::Closest1(calls) => calls.iter_mut().for_each(|c| scene.intersect1(c, query)),
            Calls::Occluded1(calls) => calls.iter_mut().for_each(|c| scene.occluded1(c, query)),
            Calls::Closest8(calls) => {
                for (call, &live) in calls.iter_mut().zip(live) {
                    with8(live, |valid| scene.intersect8(valid, call, query));
                }
            }
            Calls::Occluded8(calls) => {
                for (call, &live) in calls.iter_mut().zip(live) {
                    with8(live, |valid| scene.occluded8(valid, call, query));
                }
            }
            Calls::Closest16(calls) => {
                for (call, &live) in calls.iter_mut().zip(live) {
                    with16(live, |valid| scene.intersect16(valid, call, query));
                }
            }
            Calls::Occluded16(calls) => {
                for (call, &live) in calls.iter_mut().zip(live) {
                    with16(live, |valid| scene.occluded16(valid, call, query));
                }
            }
        }
    }

    /// Reads the hits from `packed`, which was made from `rays`. All lanes miss if the calls were for any hit.
    pub fn unpack(&self, packed: &Packed, rays: &[Ray8], hits: &mut [Hit8]) {
        let mut place = 0;
        for (k, (rays, hits)) in rays.iter().zip(hits).enumerate() {
            for lane in set_lanes(rays.active) {
                hits.set_lane(lane, &Hit::MISS);
            }
            match &packed.calls {
                Calls::Closest1(calls) => {
                    for lane in set_lanes(Interval::of(rays, self.mode).live) {
                        hits.set_lane(lane, &calls[place].hit());
                        place += 1;
                    }
                }
                Calls::Closest8(calls) => calls[k].hit.store(&calls[k].ray, 0, rays.active, hits),
                Calls::Closest16(calls) => calls[k / 2].hit.store(&calls[k / 2].ray, k % 2, rays.active, hits),
                _ => {}
            }
            self.rename(rays.active, hits);
        }
    }

    /// Reads the occluded rays from `packed`, which was made from `rays`. There are none if the calls were for the
    /// nearest hit.
    pub fn unpack_blocked(&self, packed: &Packed, rays: &[Ray8], blocked: &mut [Mask8]) {
        let mut place = 0;
        for (k, (rays, blocked)) in rays.iter().zip(blocked).enumerate() {
            let live = Interval::of(rays, self.mode).live;
            *blocked = match &packed.calls {
                Calls::Occluded1(calls) => {
                    let mut bits = 0;
                    for lane in set_lanes(live) {
                        bits |= u8::from(calls[place].tfar[0] < 0.0) << lane;
                        place += 1;
                    }
                    Mask8::from_bits(bits)
                }
                Calls::Occluded8(calls) => calls[k].blocked(0, live),
                Calls::Occluded16(calls) => calls[k / 2].blocked(k % 2, live),
                _ => Mask8::NONE,
            };
        }
    }
}

#[inline(always)]
fn with8(live: u16, call: impl FnOnce(&Valid<8>)) {
    if live == 0xff { call(&FULL8) } else { call(&packet::valid(live)) }
}

#[inline(always)]
fn with16(live: u16, call: impl FnOnce(&Valid<16>)) {
    if live == u16::MAX { call(&FULL16) } else { call(&packet::valid(live)) }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::tests::library;
    use super::super::{Embree, Mode, Options, Scratch, Width};
    use super::Packed;
    use crate::accel::{Coherence, Intersector};
    use crate::geometry::{Geometry, GeometryMask, Hit8, Ray, Ray8, Shape, Sphere, TriMesh};
    use crate::simd::Mask8;

    /// Walls and a ball. One triangle of the walls cannot be hit, so that ids are renamed.
    fn shapes() -> Vec<Geometry> {
        let corners = |z: f32| [Vec3::new(-9.0, -9.0, z), Vec3::new(9.0, -9.0, z), Vec3::new(0.0, 9.0, z)];
        let positions = [-6.0, -9.0].into_iter().flat_map(corners).collect();
        let wall = TriMesh { positions, triangles: vec![[0, 0, 1], [0, 1, 2], [3, 4, 5]], ..TriMesh::default() };
        let ball = Sphere { centre: Vec3::new(0.0, 0.0, -3.0), radius: 1.0 };
        let all = |shape| Geometry { shape, mask: GeometryMask::ALL };
        vec![all(Shape::Mesh(wall)), all(Shape::Sphere(ball))]
    }

    #[test]
    fn packed_rays_hit_what_streams_hit_by_every_width() {
        if library("packed rays").is_none() {
            return;
        }
        // 43 rays: an odd number of packets, the last not full; one can hit nothing at all.
        let mut rays: Vec<Ray> = (0..43_u8)
            .map(|k| Ray::new(Vec3::ZERO, Vec3::new(f32::from(k) * 0.1 - 2.0, f32::from(k % 7) * 0.3 - 1.0, -1.0)))
            .collect();
        rays[5].t_max = f32::NAN;
        let rays = Ray8::pack(&rays);
        for (mode, width) in [Mode::Robust, Mode::Fast]
            .into_iter()
            .flat_map(|mode| [Width::One, Width::Eight, Width::Sixteen].map(|width| (mode, width)))
        {
            let embree = Embree::build(&shapes(), &Options { mode, width, ..Options::default() }).unwrap();
            let mut hits = vec![Hit8::default(); rays.len()];
            let mut blocked = vec![Mask8::NONE; rays.len()];
            embree.closest(&rays, &mut hits, Coherence::Coherent, &mut Scratch::default());
            embree.occluded(&rays, &mut blocked, Coherence::Coherent, &mut Scratch::default());
            let (mut packed, mut ours, mut ours_blocked) = (Packed::default(), hits.clone(), blocked.clone());
            ours.fill(Hit8::default());
            ours_blocked.fill(Mask8::NONE);
            // Twice: the second call sees what the first left in the structs.
            for _ in 0..2 {
                embree.pack(&rays, width, false, &mut packed);
                embree.trace_packed(&mut packed, Coherence::Coherent);
                embree.unpack(&packed, &rays, &mut ours);
                embree.pack(&rays, width, true, &mut packed);
                embree.trace_packed(&mut packed, Coherence::Coherent);
                embree.unpack_blocked(&packed, &rays, &mut ours_blocked);
            }
            let (mut met, mut others) = (0, 0);
            for i in 0..43 {
                let (a, b) = (hits[i / 8].lane(i % 8), ours[i / 8].lane(i % 8));
                // Embree's `t` depends on the other rays of the packet.
                assert!(a.id() == b.id() && (a.t == b.t || (a.t - b.t).abs() < 1e-5 * a.t), "{mode:?} {width:?} {i}");
                met += usize::from(b.is_hit());
                others += usize::from(b.is_hit() && b.primitive == 2);
                assert_eq!(blocked[i / 8].lane(i % 8), ours_blocked[i / 8].lane(i % 8));
                assert_eq!(ours_blocked[i / 8].lane(i % 8), b.is_hit());
            }
            assert!(met > 10 && met < 43 && others == 0 && !ours[0].lane(5).is_hit(), "{met} {others}");
            assert!(ours.iter().any(|h| h.geometry.contains(&1)) && ours[3].primitive.contains(&1));
        }
    }
}
