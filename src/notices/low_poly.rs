//! Check for light trapped in coarse meshes with smooth normals.
//!
//! Light that enters a smooth convex body of glass can leave it: it hits the far side at the angle at which it was
//! refracted. Interpolated normals of a coarse mesh break this symmetry. Near outlines light enters by a normal that no
//! far facet has, is totally reflected, and circulates for ever. With flat facets the same mesh releases it after some
//! reflections.

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::geometry::{Shape, TriMesh};
use crate::render::Outcome;
use crate::render::record::{Met, Node, Tree};
use crate::render::reference::Prepared;
use crate::scene::Interface;

/// More than a thousandth of the pixels lack light that is trapped inside a coarse smooth mesh.
pub(super) const CHECK: Check = Check { id: "low-poly", find: Find::InPicture(find) };

/// Smallest truncated weight of a pixel that counts: one step of an 8-bit picture.
const VISIBLE: f32 = 1.0 / 255.0;

/// Share of the pixels above which there is a finding.
const SHARE: f64 = 1e-3;

/// Number of pixels traced again.
const PROBED: usize = 24;

/// Mean angle between neighbouring vertex normals, weighted by area, above which a mesh is coarse, in degrees.
const COARSE: f64 = 8.0;

/// Depth limit that separates light that needs more depth from light that is trapped.
const DEEP: u32 = 4096;

/// Number of consecutive total reflections before the cut after which light counts as trapped.
const CAUGHT: usize = 32;

fn find(facts: &Facts, picture: &Outcome) -> Vec<Finding> {
    let (width, weights) = (picture.truncated.width.max(1), &picture.truncated.pixels);
    let short = |weight: &[f32; 3]| weight.iter().any(|w| w.abs() > VISIBLE);
    let pixels: Vec<u32> = (0..).zip(weights).filter(|(_, weight)| short(weight)).map(|(i, _)| i).collect();
    let least = SHARE * weights.len() as f64;
    if pixels.len() as f64 <= least {
        return Vec::new();
    }
    let coarse: Vec<usize> = (0..facts.scene.objects.len()).filter(|&o| is_coarse(facts, picture, o)).collect();
    if coarse.is_empty() {
        return Vec::new();
    }
    let prepared = Prepared::with(facts.scene, facts.options).with_depth(DEEP.max(facts.scene.settings.max_depth));
    let probes = pixels.len().min(PROBED);
    let mut caught = vec![0; facts.scene.objects.len()];
    for k in 0..probes {
        let pixel = pixels[k * pixels.len() / probes];
        let tree = prepared.recorded_at(f64::from(pixel % width) + 0.5, f64::from(pixel / width) + 0.5);
        if let Some(object) = trap(&tree).filter(|object| coarse.contains(object)) {
            caught[object] += 1;
        }
    }
    let finding = |object: usize| {
        let dark = caught[object] as f64 / probes as f64 * pixels.len() as f64;
        (dark > least).then(|| of_object(facts, object, dark.round() as u64))
    };
    coarse.iter().filter_map(|&object| finding(object)).collect()
}

fn of_object(facts: &Facts, object: usize, dark: u64) -> Finding {
    let built_in = facts.scene.objects[object].origin.triangle_lines.is_empty();
    Finding {
        place: FileLocation::object(facts.scene, object),
        wrong: format!(
            "{} loses light in about {dark} pixels (counted as truncated weight, whatever the `depth`)",
            facts.name(object)
        ),
        because: String::from("smooth normals on so coarse a mesh reflect light totally inside it for ever"),
        cure: String::from(if built_in {
            "raise its `tessellation`, leave it out where the shape is a sphere, or write `smooth = false`"
        } else {
            "export the model with more faces, or without normals"
        }),
    }
}

/// Returns true if rays hit the object and it is a dielectric mesh whose vertex normals differ much.
fn is_coarse(facts: &Facts, picture: &Outcome, object: usize) -> bool {
    let met = picture.seen.objects.get(object).is_some_and(|&met| met);
    match (&facts.scene.geometry[object].shape, facts.material(object).interface) {
        (Shape::Mesh(mesh), Interface::Dielectric { .. }) if met && !mesh.normals.is_empty() => {
            mean_turn(mesh) > COARSE
        }
        _ => false,
    }
}

/// Returns the mean over the area of the largest angle between a triangle's vertex normals, in degrees.
fn mean_turn(mesh: &TriMesh) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
        let Some(normals) = mesh.corner_normals(i) else { continue };
        let [a, b, c] = mesh.corners(i).map(glam::Vec3::as_dvec3);
        let [u, v, w] = normals.map(|n| n.as_dvec3().normalize_or_zero());
        let cos = u.dot(v).min(v.dot(w)).min(w.dot(u)).clamp(-1.0, 1.0);
        let part = (b - a).cross(c - a).length();
        sum += part * cos.acos().to_degrees();
        area += part;
    }
    if area > 0.0 { sum / area } else { 0.0 }
}

/// Returns the object that traps light: the heaviest ray cut by the depth limit had many consecutive total reflections
/// in it.
fn trap(tree: &Tree) -> Option<usize> {
    let weight = |node: Node| {
        let cuts = tree.events[node as usize].cut.iter().filter(|cut| cut.too_deep);
        cuts.map(|cut| cut.weight.abs().max_element()).fold(0.0, f64::max)
    };
    let heaviest = (0..tree.events.len() as Node).max_by(|&a, &b| weight(a).total_cmp(&weight(b)))?;
    if weight(heaviest) <= f64::from(VISIBLE) {
        return None;
    }
    let body = tree.events[heaviest as usize].object()?;
    let mut node = Some(heaviest);
    for _ in 0..CAUGHT {
        let event = &tree.events[node? as usize];
        let inside = matches!(event.met, Met::Surface { object, .. } if object == body);
        if !inside || !event.split.is_some_and(|split| split.total) {
            return None;
        }
        node = event.parent;
    }
    Some(body as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::shapes;

    #[test]
    fn normals_of_a_ball_turn_by_the_angle_between_its_corners() {
        // Rings are 18 degrees apart, as are vertices along the equator; a diagonal is at most 25 degrees.
        let (coarse, fine) = (mean_turn(&shapes::sphere(10)), mean_turn(&shapes::sphere(100)));
        assert!((18.0..30.0).contains(&coarse), "{coarse}");
        assert!((1.8..3.0).contains(&fine), "{fine}");
        let flat = TriMesh { normals: Vec::new(), normal_indices: Vec::new(), ..shapes::sphere(10) };
        assert_eq!(mean_turn(&flat), 0.0);
    }
}
