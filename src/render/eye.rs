//! Bodies that contain the camera.

use glam::{DVec3, Vec3};

use crate::accel::{Coherence, Intersector};
use crate::geometry::contact::{Contacts, Face};
use crate::geometry::{GeometryMask, Hit8, Ray, Ray8, Shape};
use crate::scene::{Bodies, MOST_PASSES, Scene};

/// Direction of the march: upwards, but tilted. Straight up would run along the walls of upright boxes and hit the
/// diagonals of their lids.
const UPWARDS: DVec3 = DVec3::new(0.137, 1.0, 0.259);

/// Returns the bodies around the eye, in the order in which a ray from outside would enter them. A medium named by the
/// camera takes precedence. Otherwise these are the half spaces of planes that contain the eye, and every body that a
/// march upwards leaves without having entered it.
#[must_use]
pub fn bodies_around<I: Intersector>(scene: &Scene, accel: &I, bodies: &Bodies, contacts: &Contacts) -> Vec<u32> {
    match scene.camera.medium {
        // Medium 0 surrounds everything and cannot be entered.
        Some(0) => Vec::new(),
        Some(medium) => vec![bodies.of_medium(medium)],
        None => {
            // The body left last was entered first.
            let solids = solids_around(scene, accel, bodies, contacts);
            half_spaces_around(scene, bodies).into_iter().rev().chain(solids.into_iter().rev()).collect()
        }
    }
}

/// Returns the half spaces that contain the eye. A plane is infinite, so its side is known without a march.
fn half_spaces_around(scene: &Scene, bodies: &Bodies) -> Vec<u32> {
    let mut around = Vec::new();
    for (object, geometry) in scene.geometry.iter().enumerate() {
        let (Shape::Plane(plane), Some(body)) = (&geometry.shape, bodies.of_object(object as u32)) else { continue };
        let way = scene.camera.eye.as_dvec3() - plane.point.as_dvec3();
        if plane.normal.as_dvec3().dot(way) < 0.0 && geometry.mask.meets(GeometryMask::TRANSMISSIVE) {
            around.push(body);
        }
    }
    around
}

/// Returns the spheres and meshes around the eye, innermost first.
fn solids_around<I: Intersector>(scene: &Scene, accel: &I, bodies: &Bodies, contacts: &Contacts) -> Vec<u32> {
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
        let mut surface = super::surface::Surface8::one(scene, &chunk, &hits);
        let (point, away) = (surface.point.lane(0).as_dvec3(), dir.as_dvec3());
        // All surfaces at this point are crossed at once.
        let mut faces = vec![Face::of(&scene.geometry, hit.geometry, hit.primitive)];
        if contacts.touches(hit.geometry, hit.primitive) {
            let own = faces.swap_remove(0);
            contacts.faces_at(hit.geometry, hit.primitive, point, own.reach(point), &mut faces);
            let beyond = |face: &Face| face.reach(point) + (face.height(point) - own.height(point)).abs();
            let reach = faces.iter().map(beyond).fold(own.reach(point), f64::max) + own.reach(point);
            surface.reach.set_lane(0, reach as f32);
        }
        let leaves = |face: &Face| face.outward(point).dot(away) > 0.0;
        faces.sort_by_key(|face| !leaves(face));
        for face in &faces {
            let solid = !matches!(scene.geometry[face.object as usize].shape, Shape::Plane(_));
            let Some(body) = bodies.of_object(face.object).filter(|_| solid) else { continue };
            if !leaves(face) {
                entered.push(body);
            } else if let Some(at) = entered.iter().rposition(|&b| b == body) {
                entered.remove(at);
            } else {
                around.push(body);
            }
        }
        origin = surface.below().lane(0);
    }
    around
}
