//! Check for cameras inside opaque bodies.

use glam::DVec3;

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::accel::reference::{Ray64, Reference};
use crate::geometry::Shape;
use crate::render::Outcome;
use crate::scene::{Interface, Rgb};

/// The camera is inside an opaque closed body without light.
pub(super) const CHECK: Check = Check { id: "camera-inside", find: Find::InPicture(find) };

/// Number of directions in which surfaces are counted. From inside a closed body every ray crosses an odd number.
const DIRECTIONS: usize = 16;

fn find(facts: &Facts, picture: &Outcome) -> Vec<Finding> {
    let finding = |object: usize| {
        let eye = facts.scene.camera.eye;
        Finding {
            place: FileLocation::object(facts.scene, object),
            wrong: format!("the camera is inside {}, which is opaque, and no light is in there", facts.name(object)),
            because: format!("`eye = [{}, {}, {}]` lies within its closed surface", eye.x, eye.y, eye.z),
            cure: String::from("move the camera or the object, make the object transparent, or put a [[light]] inside"),
        }
    };
    dark_body(facts, picture).map(finding).into_iter().collect()
}

/// Returns the opaque body around the eye, if no lamp and no visible surface shines in it.
pub(super) fn dark_body(facts: &Facts, picture: &Outcome) -> Option<usize> {
    let seen = &picture.seen;
    if seen.lit || seen.missed > 0 {
        return None;
    }
    let met = || (0..seen.objects.len()).filter(|&o| seen.objects[o]);
    if met().any(|o| glows(facts, o)) {
        return None;
    }
    // Without lamps, any room is dark; the camera's position is then not the reason.
    let holds = |o: &usize| {
        let lacks_lamps =
            facts.scene.lights.is_empty() && !facts.scene.shining().any() && facts.material(*o).answers_light();
        is_opaque(facts, *o) && !lacks_lamps && is_around_eye(facts, *o)
    };
    met().find(holds)
}

/// Returns true if an object emits light or reflects ambient light.
pub(super) fn glows(facts: &Facts, object: usize) -> bool {
    let material = facts.material(object);
    material.emission != Rgb::ZERO || material.ambient * facts.scene.ambient != Rgb::ZERO
}

fn is_opaque(facts: &Facts, object: usize) -> bool {
    match facts.material(object).interface {
        Interface::Dielectric { .. } | Interface::ThinDielectric { .. } => false,
        Interface::Alpha { opacity, mask } => opacity >= 1.0 && mask.is_none(),
        Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => true,
    }
}

/// Returns true if an object is a closed surface around the eye, judged by rays from there.
fn is_around_eye(facts: &Facts, object: usize) -> bool {
    let geometry = &facts.scene.geometry[object..=object];
    if matches!(geometry[0].shape, Shape::Plane(_)) {
        return false;
    }
    let body = Reference::build(geometry);
    let eye = facts.scene.camera.eye.as_dvec3();
    (0..DIRECTIONS).all(|i| {
        // Directions on a spiral over the sphere; none lies along an axis or a diagonal.
        let z = 1.0 - (2 * i + 1) as f64 / DIRECTIONS as f64;
        let (sin, cos) = (i as f64 * 2.399_963).sin_cos();
        let across = (1.0 - z * z).sqrt();
        let mut hits = body.all_hits(&Ray64::new(eye, DVec3::new(across * cos, z, across * sin)));
        // A ray through an edge hits both triangles there.
        hits.dedup_by(|b, a| a.t == b.t);
        hits.len() % 2 == 1
    })
}
