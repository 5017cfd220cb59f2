//! Which media the eye is in.

use glam::{DVec3, Vec3};

use super::worker::MOST_PASSES;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit8, Ray, Ray8, Shape};
use crate::scene::{Interface, Scene};

/// Where the march goes: upwards, but askew, since straight up would follow the walls of upright boxes and meet the
/// diagonals of their lids.
const UPWARDS: DVec3 = DVec3::new(0.137, 1.0, 0.259);

/// The media around the eye, in the order a ray from outside would enter them: what the camera names, or else the half
/// spaces of planes that hold the eye and every medium whose boundary a march upwards leaves without having entered it.
#[must_use]
pub fn media_around<I: Intersector>(scene: &Scene, accel: &I) -> Vec<u32> {
    match scene.camera.medium {
        // It surrounds everything, and cannot be entered.
        Some(0) => Vec::new(),
        Some(medium) => vec![medium],
        None => {
            // What is left last was entered first.
            let solids = solids_around(scene, accel);
            half_spaces_around(scene).into_iter().rev().chain(solids.into_iter().rev()).collect()
        }
    }
}

/// The medium that an object encloses, where it encloses one.
fn enclosed(scene: &Scene, object: usize) -> Option<u32> {
    match scene.materials[scene.objects[object].material as usize].interface {
        Interface::Dielectric { medium, .. } => Some(medium),
        _ => None,
    }
}

/// Planes reach everywhere, so that the side of one is no matter of marching.
fn half_spaces_around(scene: &Scene) -> Vec<u32> {
    let mut around = Vec::new();
    for (object, geometry) in scene.geometry.iter().enumerate() {
        let (Shape::Plane(plane), Some(medium)) = (&geometry.shape, enclosed(scene, object)) else { continue };
        let way = scene.camera.eye.as_dvec3() - plane.point.as_dvec3();
        if plane.normal.as_dvec3().dot(way) < 0.0 && geometry.mask.meets(GeometryMask::TRANSMISSIVE) {
            around.push(medium);
        }
    }
    around
}

/// Media of spheres and meshes, the innermost first.
fn solids_around<I: Intersector>(scene: &Scene, accel: &I) -> Vec<u32> {
    let mut scratch = I::Scratch::default();
    let dir: Vec3 = UPWARDS.normalize().as_vec3();
    let mut origin = scene.camera.eye;
    let mut entered: Vec<u32> = Vec::new();
    let mut around: Vec<u32> = Vec::new();
    for _ in 0..MOST_PASSES {
        let ray = Ray { admits: GeometryMask::TRANSMISSIVE, ..Ray::new(origin, dir) };
        let rays = Ray8::pack(&[ray]);
        let mut hits = [Hit8::default()];
        accel.closest(&rays, &mut hits, Coherence::Incoherent, &mut scratch);
        let hit = hits[0].lane(0);
        if !hit.is_hit() {
            break;
        }
        let chunk = super::queue::Chunk { rays, states: vec![super::queue::State8::default()], extras: Vec::new() };
        let surface = super::surface::Surface8::one(scene, &chunk, &hits);
        let object = hit.geometry as usize;
        let solid = !matches!(scene.geometry[object].shape, Shape::Plane(_));
        if let (Some(medium), true) = (enclosed(scene, object), solid) {
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
    around
}
