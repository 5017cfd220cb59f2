//! The medium stage: what space itself takes of light.

use super::queue::Chunk;
use super::shading::Shading;
use crate::geometry::Hit8;

/// Weakens the rays of a chunk by the media that they travelled in to what they met.
pub type MediumStage = fn(&Shading, &mut Chunk, &[Hit8]);

/// The stage where some medium absorbs.
pub fn absorb(shading: &Shading, chunk: &mut Chunk, hits: &[Hit8]) {
    for ((ray, state), hit) in chunk.rays.iter().zip(&mut chunk.states).zip(hits) {
        if let Some(left) = shading.absorbed(ray.active, &state.stack, hit.t + state.lead) {
            state.weight = state.weight.times(left);
        }
    }
}
