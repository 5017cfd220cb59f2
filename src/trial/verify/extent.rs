//! Extent of a scene.

use glam::DVec3;

use crate::scene::Scene;
use crate::trial::rays;

/// Returns the middle and half extent of the finite part of a scene.
pub(super) fn bounds(scene: &Scene) -> (DVec3, DVec3) {
    let all = rays::bounds(&scene.geometry);
    let (lo, hi) = (all.lo.as_dvec3(), all.hi.as_dvec3());
    if lo.cmple(hi).all() {
        // A flat scene still gets rays from all around.
        let half = (hi - lo) * 0.5;
        ((lo + hi) * 0.5, half.max(DVec3::splat((half.max_element() * 0.1).max(f64::from(f32::MIN_POSITIVE)))))
    } else {
        (scene.camera.eye.as_dvec3(), DVec3::ONE)
    }
}
