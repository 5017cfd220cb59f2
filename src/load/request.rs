//! A request for a model, whatever the format of its file.

use std::path::Path;

use super::assembly::{Assembly, Pending};
use super::draft::{Draft, MeshDraft};
use super::transform::Transform;
use crate::scene::Origin;
use crate::{Error, Result};

/// Name of the material of faces without one.
pub(super) const UNNAMED: &str = "default";
/// Name that stands for every material.
const ALL: &str = "*";
/// Number of names that a message lists.
const MOST_NAMES: usize = 12;

/// Options for adding a model to a scene.
pub(super) struct Request<'a> {
    /// Name in messages.
    pub name: String,
    /// Material of the whole model; by default its own materials.
    pub material: Option<u32>,
    /// Materials of the scene in place of some of the model, by their names there.
    pub replace: &'a [(String, u32)],
    /// Largest angle in degrees between faces without normals that are shaded smoothly; `None` for the smoothing groups
    /// of the file.
    pub smooth: Option<f64>,
    /// Turns the model inside out.
    pub flip: bool,
    /// Placement in the scene.
    pub transform: Transform,
    /// Limit on the magnitude of coordinates, used if most exceed the general limit.
    pub limit: f64,
    /// Creates the error for a wrong transform, at its location in the scene file.
    pub wrong_transform: &'a dyn Fn(String) -> Error,
}

impl Request<'_> {
    /// Returns the material that replaces one of the model, by its name there.
    pub(super) fn replacement(&self, name: &str) -> Option<u32> {
        let name = if name.is_empty() { UNNAMED } else { name };
        let folded = name.to_lowercase();
        let by = |same: &dyn Fn(&str) -> bool| self.replace.iter().find(|(given, _)| same(given)).map(|(_, m)| *m);
        by(&|given| given == name)
            .or_else(|| by(&|given| given.to_lowercase() == folded))
            .or_else(|| by(&|given| given == ALL))
    }

    /// Returns a message about the first material to be replaced that is none of `names`, the materials of the model.
    pub(super) fn not_replaced(&self, names: &[String]) -> Option<String> {
        let known = |given: &str| given == ALL || names.iter().any(|n| n.to_lowercase() == given.to_lowercase());
        let (unknown, _) = self.replace.iter().find(|(given, _)| !known(given))?;
        let list = names.iter().take(MOST_NAMES).map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
        let more = if names.len() > MOST_NAMES { ", ..." } else { "" };
        Some(format!("no material of the model is called `{unknown}`; it has {list}{more}"))
    }

    /// Adds a mesh of the model to the scene: placed, with its material. `part` names it within the model, and
    /// `lines` has the line of each triangle, if the format has lines.
    pub(super) fn add(
        &self,
        file: &Path,
        part: Option<&str>,
        mut mesh: MeshDraft,
        material: u32,
        lines: Vec<u32>,
        assembly: &mut Assembly<'_>,
    ) -> Result<()> {
        self.transform.mesh(&mut mesh).map_err(self.wrong_transform)?;
        let name = part.map_or_else(|| self.name.clone(), |part| format!("{}/{part}", self.name));
        let origin = Origin { file: file.display().to_string(), line: 0, triangle_lines: lines };
        let draft = Draft::Mesh(mesh);
        assembly.add(Pending { name, draft, material, origin, smooth: self.smooth, flip: self.flip })
    }
}
