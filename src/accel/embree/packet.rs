//! Conversion of rays, intervals and hits between this crate's packets and Embree's.

use super::options::Mode;
use super::sys::{INVALID_GEOMETRY, RtcHit8, RtcHit16, RtcRay8, RtcRay16, RtcRayHit1, Valid};
use crate::geometry::slab::{T_LIMIT, is_traceable};
use crate::geometry::{Hit, Hit8, NO_GEOMETRY, Ray8};
use crate::math::Real;
use crate::simd::{F32x8, Mask8};

/// Smallest `tnear` in robust mode, 2^-125. Nearer hits are not found. Embree multiplies `tnear` by a little less than
/// 1 at every node. A denormal product is so slow that with the smallest number above 0 coherent packets would lose a
/// third to a half of their speed (bunny, Embree 4.4.0, Sapphire Rapids).
pub const TNEAR_FLOOR: f32 = 2.350_988_7e-38;

const _: () = assert!(NO_GEOMETRY == INVALID_GEOMETRY);

/// Interval and active lanes of a packet by Embree's conventions.
#[derive(Clone, Copy)]
pub struct Interval {
    /// Lower bounds.
    pub tnear: F32x8,
    /// Upper bounds, inclusive.
    pub tfar: F32x8,
    /// Active lanes whose ray can hit anything at all.
    pub live: u8,
}

impl Interval {
    /// Converts the intervals of a packet.
    ///
    /// Embree's robust tests include `tnear`, so it is the next number above `t_min` there; its fast tests exclude it.
    /// Neither finds hits behind the ray's origin: a negative `t_min` counts as the largest number below zero.
    #[inline(always)]
    #[must_use]
    pub fn of(rays: &Ray8, mode: Mode) -> Self {
        let tfar = rays.t_max.min_or(F32x8::from(T_LIMIT));
        let tnear = match mode {
            Mode::Robust => {
                // One step up from a number that is not negative. -0 and NaN become values below the floor.
                let t_min = rays.t_min.max_or(F32x8::ZERO).to_array();
                let above = F32x8::new(t_min.map(|t| f32::from_bits(t.to_bits().wrapping_add(1))));
                above.max_or(F32x8::from(TNEAR_FLOOR))
            }
            Mode::Fast => rays.t_min.max_or(F32x8::ZERO),
        };
        let sound = is_traceable(rays.origin, rays.dir, rays.t_min, rays.t_max);
        let live = (sound & tnear.le(tfar)).bits() & rays.active;
        Self { tnear, tfar, live }
    }
}

/// The `t_min` that [`Interval::of`] converts to this `tnear`.
#[inline(always)]
#[must_use]
pub fn before_tnear(tnear: F32x8, mode: Mode) -> F32x8 {
    match mode {
        Mode::Robust => F32x8::new(tnear.to_array().map(|t| f32::from_bits(t.to_bits().wrapping_sub(1)))),
        Mode::Fast => tnear,
    }
}

/// Converts lane bits to Embree's lane mask.
#[inline(always)]
#[must_use]
pub fn valid<const N: usize>(bits: u16) -> Valid<N> {
    Valid(std::array::from_fn(|i| -i32::from(bits >> i & 1)))
}

/// Access to eight lanes of Embree's rays and hits: all of an 8-wide packet, or half of a 16-wide one.
macro_rules! lanes {
    ($ray:ident, $hit:ident) => {
        impl $ray {
            /// Stores eight rays in half `half`.
            #[inline(always)]
            pub fn load(&mut self, half: usize, rays: &Ray8, interval: &Interval) {
                let put = |to: &mut [f32], from: &F32x8| to.as_chunks_mut::<8>().0[half] = *from.as_array();
                put(&mut self.org_x, &rays.origin.x);
                put(&mut self.org_y, &rays.origin.y);
                put(&mut self.org_z, &rays.origin.z);
                put(&mut self.tnear, &interval.tnear);
                put(&mut self.dir_x, &rays.dir.x);
                put(&mut self.dir_y, &rays.dir.y);
                put(&mut self.dir_z, &rays.dir.z);
                put(&mut self.tfar, &interval.tfar);
                self.mask.as_chunks_mut::<8>().0[half] = [u32::from(rays.admits.0); 8];
            }

            /// Active lanes of half `half` that an occlusion call found to be occluded.
            #[inline(always)]
            pub fn blocked(&self, half: usize, live: u8) -> Mask8 {
                let tfar = F32x8::new(self.tfar.as_chunks::<8>().0[half]);
                tfar.lt(F32x8::ZERO) & Mask8::from_bits(live)
            }
        }

        impl $hit {
            /// Sets all lanes to a miss.
            #[inline(always)]
            pub fn clear(&mut self) {
                self.geom_id.fill(INVALID_GEOMETRY);
            }

            /// Copies the hits of half `half` to the active lanes of `hits`.
            #[inline(always)]
            pub fn store(&self, ray: &$ray, half: usize, active: u8, hits: &mut Hit8) {
                let geometry = &self.geom_id.as_chunks::<8>().0[half];
                let primitive = &self.prim_id.as_chunks::<8>().0[half];
                let number = |from: &[f32]| F32x8::new(from.as_chunks::<8>().0[half]);
                let met: [bool; 8] = std::array::from_fn(|i| geometry[i] != INVALID_GEOMETRY);
                let met_bits = (0..8).fold(0, |bits: u8, i| bits | u8::from(met[i]) << i);
                let (met_lanes, active_lanes) = (Mask8::from_bits(met_bits), Mask8::from_bits(active));
                let (u, v) = weights(number(&self.u), number(&self.v));
                let put = |to: &mut F32x8, hit: F32x8, miss: F32x8| {
                    *to = active_lanes.select(met_lanes.select(hit, miss), *to);
                };
                put(&mut hits.t, number(&ray.tfar), F32x8::INFINITY);
                put(&mut hits.u, u, F32x8::ZERO);
                put(&mut hits.v, v, F32x8::ZERO);
                for i in 0..8 {
                    let active = active >> i & 1 != 0;
                    hits.instance[i] = if active { 0 } else { hits.instance[i] };
                    hits.geometry[i] = if active { geometry[i] } else { hits.geometry[i] };
                    let here = if met[i] { primitive[i] } else { 0 };
                    hits.primitive[i] = if active { here } else { hits.primitive[i] };
                }
            }
        }
    };
}

lanes!(RtcRay8, RtcHit8);
lanes!(RtcRay16, RtcHit16);

impl RtcRayHit1 {
    /// Stores lane `i` of `rays`, with no hit.
    #[inline(always)]
    pub fn load(&mut self, i: usize, rays: &Ray8, interval: &Interval) {
        let ray = &mut self.ray;
        [ray.org_x, ray.org_y, ray.org_z] = [[rays.origin.x.lane(i)], [rays.origin.y.lane(i)], [rays.origin.z.lane(i)]];
        [ray.dir_x, ray.dir_y, ray.dir_z] = [[rays.dir.x.lane(i)], [rays.dir.y.lane(i)], [rays.dir.z.lane(i)]];
        [ray.tnear, ray.tfar] = [[interval.tnear.lane(i)], [interval.tfar.lane(i)]];
        ray.mask = [u32::from(rays.admits.0)];
        self.hit.geom_id = [INVALID_GEOMETRY];
    }

    /// Returns the hit, or a miss.
    #[inline(always)]
    #[must_use]
    pub fn hit(&self) -> Hit {
        let ([geometry], [primitive]) = (self.hit.geom_id, self.hit.prim_id);
        if geometry == INVALID_GEOMETRY {
            return Hit::MISS;
        }
        let (u, v) = weights(self.hit.u[0], self.hit.v[0]);
        Hit { t: self.ray.tfar[0], u, v, instance: 0, geometry, primitive }
    }
}

/// Clamps the barycentric weights of the second and third corner. Embree's rounding may leave them an ulp outside the
/// triangle.
#[inline(always)]
fn weights<R: Real>(u: R, v: R) -> (R, R) {
    let u = u.max_or(R::zero()).min_or(R::one());
    (u, v.max_or(R::zero()).min_or(R::one() - u))
}
