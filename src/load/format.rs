//! Model formats: the choice of a reader by a file's name.

use std::path::Path;

use super::assembly::Assembly;
use super::extras::Extras;
use super::request::{Request, UNNAMED};
use super::{gltf, obj, ply, stl};
use crate::Result;

/// Endings of the names of model files, for messages.
pub(super) const ENDINGS: &str = ".obj, .gltf, .glb, .ply, .stl";

/// Format of a model file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Obj,
    Gltf,
    Ply,
    Stl,
}

impl Format {
    /// Returns the format that the file's name ends in.
    pub(super) fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "gltf" | "glb" => Some(Self::Gltf),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }

    /// Reads a model of this format into the scene, and returns its camera, its lights and the names of its materials.
    pub(super) fn load(self, path: &Path, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<Extras> {
        let unnamed = |()| vec![String::from(UNNAMED)];
        let before = assembly.scene.materials.len();
        let names = match self {
            Self::Gltf => {
                let extras = gltf::load(path, request, assembly)?;
                let made = assembly.scene.materials.iter().skip(before);
                return Ok(Extras { names: made.map(|m| m.name.clone()).collect(), ..extras });
            }
            Self::Obj => obj::load(path, request, assembly)?,
            Self::Ply => ply::load(path, request, assembly).map(unnamed)?,
            Self::Stl => stl::load(path, request, assembly).map(unnamed)?,
        };
        Ok(Extras { names, ..Extras::default() })
    }
}
