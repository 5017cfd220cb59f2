//! Which media the eye is in.

use glam::Vec3;

use super::worker::MOST_PASSES;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit8, Ray, Ray8};
use crate::scene::{Interface, Scene};

/// The media around the eye, in the order a ray from outside would enter them: what the camera names, or else every
/// medium that a march straight up leaves without having entered it.
#[must_use]
pub fn media_around<I: Intersector>(scene: &Scene, accel: &I) -> Vec<u32> {
    if let Some(medium) = scene.camera.medium {
        return vec![medium];
    }
    let mut scratch = I::Scratch::default();
    let mut origin = scene.camera.eye;
    let mut entered: Vec<u32> = Vec::new();
    let mut around: Vec<u32> = Vec::new();
    for _ in 0..MOST_PASSES {
        let ray = Ray { admits: GeometryMask::TRANSMISSIVE, ..Ray::new(origin, Vec3::Y) };
        let rays = Ray8::pack(&[ray]);
        let mut hits = [Hit8::default()];
        accel.closest(&rays, &mut hits, Coherence::Incoherent, &mut scratch);
        if !hits[0].lane(0).is_hit() {
            break;
        }
        let chunk = super::queue::Chunk { rays, states: vec![super::queue::State8::default()] };
        let surface = super::surface::Surface8::gather(scene, &chunk, &hits, &[0]);
        if let Interface::Dielectric { medium, .. } = scene.materials[surface.material[0] as usize].interface {
            if surface.front.lane(0) {
                entered.push(medium);
            } else if let Some(at) = entered.iter().rposition(|&m| m == medium) {
                entered.remove(at);
            } else {
                around.push(medium);
            }
        }
        origin = surface.below().lane(0);
    }
    // The one left first is the innermost.
    around.reverse();
    around
}
