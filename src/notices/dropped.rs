//! Check for models that lost many of their faces.

use std::path::Path;

use super::facts::Facts;
use super::facts::has_area;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::geometry::Shape;

/// More than [`SHARE`] of a model is invisible, because faces were left out or cannot be hit.
pub(super) const CHECK: Check = Check { id: "dropped-faces", find: Find::InScene(find) };

/// Share of the faces that may be lost without a finding.
const SHARE: f64 = 0.1;

fn find(facts: &Facts) -> Vec<Finding> {
    let mut files: Vec<&Path> = facts.report.models.iter().map(|model| model.file.as_path()).collect();
    files.sort_unstable();
    files.dedup();
    files.into_iter().filter_map(|file| in_model(facts, file)).collect()
}

fn in_model(facts: &Facts, file: &Path) -> Option<Finding> {
    let models = || facts.report.models.iter().filter(|model| model.file == file);
    let left_out: u64 = models().map(|model| model.dropped).sum();
    let (mut triangles, mut unusable) = (0, 0);
    let name = file.display().to_string();
    for (geometry, object) in facts.scene.geometry.iter().zip(&facts.scene.objects) {
        if let (Shape::Mesh(mesh), true) = (&geometry.shape, object.origin.file == name) {
            triangles += mesh.triangles.len() as u64;
            unusable += (0..mesh.triangles.len()).filter(|&i| !has_area(mesh, i)).count() as u64;
        }
    }
    let (lost, all) = (left_out + unusable, left_out + triangles);
    (lost as f64 > SHARE * all as f64).then(|| Finding {
        place: FileLocation::file(file),
        wrong: format!("{lost} of {all} faces are missing from the picture"),
        because: reasons(facts, left_out, unusable),
        cure: String::from("mend or export the model again, without such faces"),
    })
}

fn reasons(facts: &Facts, left_out: u64, unusable: u64) -> String {
    let mut reasons = Vec::new();
    if left_out > 0 {
        let dropped: Vec<&str> = facts.report.dropped.keys().copied().collect();
        reasons.push(format!("{left_out} were left out ({})", dropped.join(", ")));
    }
    if unusable > 0 {
        reasons.push(format!("{unusable} cannot be hit (no area, or not finite)"));
    }
    reasons.join(", ")
}
