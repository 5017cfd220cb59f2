//! Medium stage: absorption along rays.

use super::queue::Chunk;
use super::shading::Shading;
use crate::geometry::Hit8;

/// Function that multiplies the weights of a chunk's rays by the transmittance of their media up to the hits.
pub type MediumStage = fn(&Shading, &mut Chunk, &[Hit8]);

/// Applies absorption. Used where some medium absorbs.
pub fn absorb(shading: &Shading, chunk: &mut Chunk, hits: &[Hit8]) {
    for ((ray, state), hit) in chunk.rays.iter().zip(&mut chunk.states).zip(hits) {
        if let Some(left) = shading.absorbed(ray.active, &state.stack, hit.t + state.lead) {
            state.weight = state.weight.times(left);
        }
    }
}
