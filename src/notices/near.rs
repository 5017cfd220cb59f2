//! Check for transparent bodies whose surfaces nearly coincide and cross many times.

use glam::DVec3;

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::geometry::contact::tolerance;
use crate::geometry::{Shape, TriMesh};
use crate::scene::Interface;

/// The surfaces of a liquid and its glass follow one shape with different tessellations.
pub(super) const CHECK: Check = Check { id: "near-coincidence", find: Find::InScene(find) };

/// Number of faces of a mesh that are examined.
const SAMPLES: usize = 512;

/// Distance below which two surfaces nearly coincide, relative to the size of a face.
const NEAR: f64 = 0.1;

/// Share of the examined faces that must lie near the other surface, on each side of it.
const SHARE: f64 = 0.02;

fn find(facts: &Facts) -> Vec<Finding> {
    let scene = facts.scene;
    let clear: Vec<usize> = (0..scene.objects.len())
        .filter(|&o| matches!(facts.material(o).interface, Interface::Dielectric { .. }))
        .collect();
    let bounds: Vec<_> = clear.iter().map(|&o| facts.bounds(o)).collect();
    let mut findings = Vec::new();
    for (i, &a) in clear.iter().enumerate() {
        for (j, &b) in clear[..i].iter().enumerate() {
            let (Shape::Mesh(p), Shape::Mesh(q)) = (&scene.geometry[a].shape, &scene.geometry[b].shape) else {
                continue;
            };
            let apart = bounds[i].lo.cmpgt(bounds[j].hi).any() || bounds[j].lo.cmpgt(bounds[i].hi).any();
            if !apart && (weave(p, q) || weave(q, p)) {
                findings.push(Finding {
                    place: FileLocation::object(scene, a),
                    wrong: format!("the surfaces of {} and {} cross each other many times", facts.name(b), facts.name(a)),
                    because: String::from("they follow one shape with different faces"),
                    cure: String::from(
                        "let one reach into the other and give the outer one the higher priority, or tessellate both alike",
                    ),
                });
            }
        }
    }
    findings
}

/// Corners, middle, unit normal and size of a face.
struct Sample {
    corners: [DVec3; 3],
    middle: DVec3,
    normal: DVec3,
    size: f64,
}

/// Returns true if faces of `a` cross the planes of nearly parallel faces of `b` next to them, with their middles some on one
/// side and some on the other. Two plates one above the other do not.
fn weave(a: &TriMesh, b: &TriMesh) -> bool {
    let step = (a.triangles.len() / SAMPLES).max(1);
    let mut samples: Vec<Sample> =
        (0..a.triangles.len()).step_by(step).filter(|&i| a.is_usable(i)).filter_map(|i| sample(a, i)).collect();
    samples.sort_unstable_by(|s, t| s.middle.x.total_cmp(&t.middle.x));
    let farthest = samples.iter().map(|s| NEAR * s.size).fold(0.0, f64::max);
    let (mut outside, mut inside) = (vec![false; samples.len()], vec![false; samples.len()]);
    for i in (0..b.triangles.len()).filter(|&i| b.is_usable(i)) {
        let corners = b.corners(i).map(|p| p.as_dvec3());
        let [p, q, r] = corners;
        let (lo, hi) = (p.min(q).min(r) - farthest, p.max(q).max(r) + farthest);
        let first = samples.partition_point(|s| s.middle.x < lo.x);
        for (k, s) in samples.iter().enumerate().skip(first).take_while(|(_, s)| s.middle.x <= hi.x) {
            if s.middle.cmplt(lo).any() || s.middle.cmpgt(hi).any() {
                continue;
            }
            if let Some(height) = height_over(s, corners) {
                outside[k] |= height > 0.0;
                inside[k] |= height < 0.0;
            }
        }
    }
    let enough = (SHARE * samples.len() as f64).max(2.0);
    let counted = |side: &[bool]| side.iter().filter(|&&near| near).count() as f64;
    counted(&outside) >= enough && counted(&inside) >= enough
}

fn sample(mesh: &TriMesh, i: usize) -> Option<Sample> {
    let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
    let spanned = (b - a).cross(c - a);
    let normal = spanned.try_normalize()?;
    Some(Sample { corners: [a, b, c], middle: (a + b + c) / 3.0, normal, size: spanned.length().sqrt() })
}

/// Returns the signed height of a face's middle over a nearly parallel triangle. Returns `None` if the face is too far
/// from it, beside it, or does not cross its plane.
fn height_over(s: &Sample, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let normal = (b - a).cross(c - a).try_normalize()?;
    let along = normal.dot(s.normal);
    let height = (s.middle - a).dot(normal);
    let largest = s.middle.abs().max_element().max(a.abs().max_element());
    let near = tolerance(largest);
    if along.abs() < 0.95 || height.abs() > NEAR * s.size || height.abs() <= near {
        return None;
    }
    let heights = s.corners.map(|p| (p - a).dot(normal));
    if !(heights.iter().any(|&h| h > near) && heights.iter().any(|&h| h < -near)) {
        return None;
    }
    let below = s.middle - normal * height;
    let within = [(a, b), (b, c), (c, a)].iter().all(|&(p, q)| (q - p).cross(below - p).dot(normal) >= 0.0);
    // Sign of the side of the first surface on which the second one lies.
    within.then_some(height * along.signum())
}
