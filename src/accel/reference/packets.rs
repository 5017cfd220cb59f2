//! [`Intersector`] for the arbiter: each lane is widened and traced on its own.

use super::{Ray64, Reference};
use crate::accel::{BuildStats, Coherence, Intersector};
use crate::geometry::{Hit8, Ray8};
use crate::simd::Mask8;

/// Active lanes of a packet with their rays in `f64`, and `t_min` in `f32`.
fn lanes(rays: &Ray8) -> impl Iterator<Item = (usize, f32, Ray64)> + '_ {
    (0..8).filter(|i| rays.active >> i & 1 != 0).map(|i| {
        let ray = rays.lane(i);
        (i, ray.t_min, Ray64::from(&ray))
    })
}

impl Intersector for Reference {
    type Scratch = ();

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], _coherence: Coherence, (): &mut ()) {
        assert_eq!(rays.len(), hits.len(), "one packet of hits for each packet of rays");
        for (rays, hits) in rays.iter().zip(hits) {
            for (i, t_min, ray) in lanes(rays) {
                hits.set_lane(i, &Self::closest(self, &ray).to_f32(t_min));
            }
        }
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], _coherence: Coherence, (): &mut ()) {
        assert_eq!(rays.len(), blocked.len(), "one mask for each packet of rays");
        for (rays, blocked) in rays.iter().zip(blocked) {
            let bits =
                lanes(rays).filter(|(_, _, ray)| Self::occluded(self, ray)).fold(0, |bits, (i, ..)| bits | 1 << i);
            *blocked = Mask8::from_bits(bits);
        }
    }

    fn build_stats(&self) -> BuildStats {
        self.stats()
    }
}
