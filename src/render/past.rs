//! Rays that pass an object as if it were not there.

use super::split::lane_bits;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{Hit8, Ray8};
use crate::simd::set_lanes;

/// Surfaces of the object that a ray may pass in a row.
const MOST: usize = 1024;

/// Replaces hits on `object` by the nearest hits behind it on anything else.
pub(super) fn go_on<I: Intersector>(
    accel: &I,
    scratch: &mut I::Scratch,
    object: u32,
    rays: &[Ray8],
    hits: &mut [Hit8],
) {
    for _ in 0..MOST {
        let (mut again, mut places) = (Vec::new(), Vec::new());
        for (place, (ray, hit)) in rays.iter().zip(hits.iter()).enumerate() {
            let active = ray.active & lane_bits(|k| hit.geometry[k] == object);
            if active != 0 {
                let mut ray = Ray8 { active, ..*ray };
                set_lanes(active).for_each(|k| ray.t_min.set_lane(k, hit.t.lane(k)));
                again.push(ray);
                places.push(place);
            }
        }
        if again.is_empty() {
            return;
        }
        let mut found = vec![Hit8::default(); again.len()];
        accel.closest(&again, &mut found, Coherence::Coherent, scratch);
        for ((place, ray), found) in places.into_iter().zip(&again).zip(&found) {
            set_lanes(ray.active).for_each(|k| hits[place].set_lane(k, &found.lane(k)));
        }
    }
}
