//! A request for a model, whatever the format of its file.

use std::path::Path;

use super::assembly::{Assembly, Pending};
use super::draft::{Draft, MeshDraft};
use super::transform::Transform;
use crate::scene::Origin;
use crate::{Error, Result};

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
