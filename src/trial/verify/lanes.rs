//! Independence of lanes: every mask of active lanes, beside every kind of poisoned number, in every octant; and rays
//! in any order.

use glam::{DVec3, Vec3};

use super::VerifyPlan;
use super::candidate::{Candidate, NamedAccel};
use super::meshes::{Closed, opaque, unit};
use super::tally::CaseCounts;
use crate::Result;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{Geometry, GeometryMask, Hit, Hit8, Ray, Ray8, Shape, Sphere};
use crate::measure::sample::Rng;
use crate::simd::Mask8;
use crate::trial::shown;

/// Eight octants and one batch with all octants in each packet, then orders of rays.
pub(super) const BATCHES: usize = 9 + ORDERS;
const ORDERS: usize = 7;

const POISONS: [f32; 7] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, 1e-45, f32::MAX];

/// Content of inactive lanes before and after a query.
const MARK: Hit = Hit { t: -7.5, u: 0.125, v: 3.0, instance: 9, geometry: 77, primitive: 78 };

pub(super) fn batch<C: Candidate>(candidate: &C, plan: &VerifyPlan, i: usize) -> Result<CaseCounts> {
    let mut rng = Rng::new("lanes", i);
    let mut tally = CaseCounts::default();
    let ways = candidate.build(&still_life())?;
    let judge = Judge { exact: candidate.is_exact() };
    let rounds = plan.sized(8, 1);
    if i < 9 {
        for _ in 0..rounds {
            let rays: [Ray; 8] = std::array::from_fn(|k| towards(&mut rng, if i < 8 { i } else { k }));
            for way in &ways {
                masks(way, &rays, &judge, &mut tally);
            }
        }
    } else {
        for _ in 0..rounds {
            orders(&ways, &mut rng, &judge, &mut tally);
        }
    }
    Ok(tally)
}

/// Comparison of answers.
struct Judge {
    /// True to compare bits; false to allow rounding.
    exact: bool,
}

impl Judge {
    fn same(&self, a: &Hit, b: &Hit) -> bool {
        let bits = |h: &Hit| ([h.t, h.u, h.v].map(f32::to_bits), h.id());
        let near = |a: f32, b: f32, to: f32| (a - b).abs() <= to;
        let nearly = || a.id() == b.id() && near(a.t, b.t, 1e-5 * b.t) && near(a.u, b.u, 1e-3) && near(a.v, b.v, 1e-3);
        bits(a) == bits(b) || (!self.exact && nearly())
    }
}

fn still_life() -> Vec<Geometry> {
    let moved = |closed, by: Vec3| {
        let mut mesh = unit(closed);
        mesh.positions.iter_mut().for_each(|p| *p += by);
        opaque(mesh)
    };
    let ball = Sphere { centre: Vec3::new(0.0, 2.5, 0.0), radius: 0.75 };
    vec![
        moved(Closed::Bumpy, Vec3::ZERO),
        Geometry { shape: Shape::Sphere(ball), mask: GeometryMask::OPAQUE },
        moved(Closed::Cube, Vec3::new(-2.5, 0.0, 0.3)),
        moved(Closed::Spindle, Vec3::new(1.6, 0.2, 0.0)),
    ]
}

/// Returns a ray into an octant, towards the scene; some rays have an end of their own.
fn towards(rng: &mut Rng, octant: usize) -> Ray {
    let sign = DVec3::new(
        if octant & 1 == 0 { 1.0 } else { -1.0 },
        if octant & 2 == 0 { 1.0 } else { -1.0 },
        if octant & 4 == 0 { 1.0 } else { -1.0 },
    );
    let dir = (rng.point().abs() + 0.02) * sign;
    let mut ray = Ray::new((rng.point() * 1.5 - dir.normalize() * 4.0).as_vec3(), dir.as_vec3());
    if rng.below(5) == 0 {
        ray.t_max = rng.between(1.0, 6.0) as f32;
    }
    ray
}

fn spoil(packet: &mut Ray8, lane: usize, poison: f32) {
    packet.origin.set_lane(lane, Vec3::splat(poison));
    packet.dir.set_lane(lane, Vec3::splat(poison));
    packet.t_min.set_lane(lane, poison);
    packet.t_max.set_lane(lane, poison);
}

/// Tests all masks but the empty one. Inactive lanes are poisoned, and one active lane at a time.
fn masks<I: Intersector>(way: &NamedAccel<I>, rays: &[Ray; 8], judge: &Judge, tally: &mut CaseCounts) {
    let mut scratch = I::Scratch::default();
    let (want, want_blocked) = (way.closest(rays, &mut scratch), way.occluded(rays, &mut scratch));
    let full = Ray8::pack(rays)[0];
    for active in 1..=u8::MAX {
        for (p, poison) in POISONS.into_iter().enumerate() {
            let mut packet = full;
            packet.active = active;
            for lane in (0..8).filter(|lane| active >> lane & 1 == 0) {
                spoil(&mut packet, lane, poison);
            }
            // With more than one active lane, one holds a ray that cannot hit anything.
            let bad = (active.count_ones() > 1 && p < 4).then(|| active.trailing_zeros() as usize);
            if let Some(lane) = bad {
                packet.dir.set_lane(lane, Vec3::splat(poison * 0.0));
            }
            let mut hits = [Hit8::default()];
            (0..8).for_each(|lane| hits[0].set_lane(lane, &MARK));
            let mut blocked = [Mask8::ALL];
            let coherence = if active & 1 == 0 { Coherence::Coherent } else { Coherence::Incoherent };
            way.accel.closest(&[packet], &mut hits, coherence, &mut scratch);
            way.accel.occluded(&[packet], &mut blocked, coherence, &mut scratch);
            let wrong = (0..8).find(|&lane| {
                let on = active >> lane & 1 != 0;
                let (got, got_blocked) = (hits[0].lane(lane), blocked[0].lane(lane));
                if bad == Some(lane) {
                    return got != Hit::MISS || got_blocked;
                }
                let kept = if on { judge.same(&got, &want[lane]) } else { got == MARK };
                !kept || got_blocked != (on && want_blocked[lane])
            });
            tally.check(wrong.is_none(), || {
                format!("{}: lane {} of {active:08b} beside {poison}", way.name, wrong.unwrap_or_default())
            });
        }
    }
}

/// Traces the same rays in other orders, alone, and by the other traversals.
fn orders<I: Intersector>(ways: &[NamedAccel<I>], rng: &mut Rng, judge: &Judge, tally: &mut CaseCounts) {
    let mut scratch = I::Scratch::default();
    let rays: Vec<Ray> = (0..1600).map(|k| towards(rng, k * 5 % 8)).collect();
    let want = ways[0].closest(&rays, &mut scratch);
    for way in ways {
        let mut order: Vec<usize> = (0..rays.len()).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, rng.below(i + 1));
        }
        let shuffled: Vec<Ray> = order.iter().map(|&i| rays[i]).collect();
        for (&i, got) in order.iter().zip(way.closest(&shuffled, &mut scratch)) {
            tally.check(judge.same(&got, &want[i]), || {
                format!("{}: {} in another order", way.name, shown::ray(&rays[i]))
            });
        }
        for (ray, want) in rays.iter().zip(&want).step_by(8) {
            let alone = way.closest(std::slice::from_ref(ray), &mut scratch)[0];
            tally.check(judge.same(&alone, want), || format!("{}: {} alone", way.name, shown::ray(ray)));
        }
    }
}
