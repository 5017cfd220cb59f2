//! Rays from inside closed meshes: a third exactly at corners, a third exactly at points of edges, a third anywhere.
//! None may leave without a hit.

use glam::{DVec3, Vec3};

use super::VerifyPlan;
use super::candidate::Candidate;
use super::meshes::{Closed, Pair, exact_edge_points, opaque};
use super::tally::CaseCounts;
use crate::Result;
use crate::accel::Intersector;
use crate::geometry::Ray;
use crate::measure::sample::{Rng, exact_start};
use crate::trial::shown;

pub(super) const MESHES: [Closed; 5] = [Closed::Ball, Closed::Bumpy, Closed::Crumpled, Closed::Spindle, Closed::Cube];

/// Distance of ray origins from the middle, in half extents: well inside each mesh, however its corners were rounded.
const SPREAD: f64 = 0.25;

/// Number of rays traced together.
const CHUNK: usize = 4096;

pub(super) fn batch<C: Candidate>(candidate: &C, plan: &VerifyPlan, pairs: &[Pair], i: usize) -> Result<CaseCounts> {
    let pair = &pairs[i];
    let geometry = [opaque(pair.mesh.clone())];
    let ways = candidate.build(&geometry)?;
    let edges = exact_edge_points(&pair.mesh);
    let mut rng = Rng::new("leaks", i);
    let mut tally = CaseCounts::default();
    let mut scratch = <C::Accel as Intersector>::Scratch::default();
    let mut left = plan.sized(10_000_000, 400_000).div_ceil(pairs.len() as u64) as usize;
    let mut k = 0;
    while left > 0 {
        let mut rays = Vec::with_capacity(CHUNK.min(left));
        while rays.len() < CHUNK.min(left) {
            rays.push(ray(&mut rng, pair, &edges, &mut k));
        }
        left -= rays.len();
        let mut lost: Vec<Vec<&str>> = vec![Vec::new(); rays.len()];
        for way in &ways {
            let hits = way.closest(&rays, &mut scratch);
            let blocked = way.occluded(&rays, &mut scratch);
            for ((lost, hit), blocked) in lost.iter_mut().zip(hits).zip(blocked) {
                if !(hit.is_hit() && blocked) {
                    lost.push(way.name);
                }
            }
        }
        for (ray, lost) in rays.iter().zip(lost) {
            tally.check(lost.is_empty(), || format!("{}: out of {}: {}", lost.join(", "), pair.name, shown::ray(ray)));
        }
    }
    Ok(tally)
}

/// Returns the next ray; `k` cycles through the kinds.
fn ray(rng: &mut Rng, pair: &Pair, edges: &[Vec3], k: &mut usize) -> Ray {
    *k += 1;
    let targets = match *k % 3 {
        0 => &pair.mesh.positions,
        1 => edges,
        _ => &[][..],
    };
    let spread = pair.half * SPREAD;
    // Only origins from which the direction to the target is exact are used; another target may have one.
    let aimed = (0..if targets.is_empty() { 0 } else { 256 }).find_map(|_| {
        let target = targets[rng.below(targets.len())];
        let start = exact_start(rng, target, pair.centre, spread)?;
        (target != start && inside(pair, start)).then(|| Ray::new(start, target - start))
    });
    aimed.unwrap_or_else(|| {
        let start = pair.centre + rng.point() * spread;
        Ray::new(start.as_vec3(), rng.direction().as_vec3())
    })
}

/// Returns true if `start`, rounded, is still well inside.
fn inside(pair: &Pair, start: Vec3) -> bool {
    let off = (start.as_dvec3() - pair.centre) / pair.half;
    off.abs().cmple(DVec3::splat(SPREAD + 0.02)).all()
}
