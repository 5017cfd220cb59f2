//! Loading of files into a [`Scene`]: scene TOML, models (OBJ with MTL, glTF, PLY, STL), pictures, built-in shapes. File formats are defined
//! only in this room.
//!
//! Wrong input is an error that names file, line and value. Input that is odd but usable is a warning, counted in the
//! [`LoadReport`]. Nothing is repaired silently.

mod assembly;
mod bare;
mod brief;
pub mod catalogue;
mod colour;
mod document;
mod draft;
mod extent;
mod extras;
mod format;
mod gltf;
mod holds;
mod indexed;
mod model;
mod obj;
mod origin;
mod pictures;
mod ply;
mod report;
mod request;
pub mod shapes;
mod sketch;
mod smooth;
mod source;
mod stl;
mod suggest;
mod surface;
mod texture;
mod transform;
mod winding;

pub use bare::{ModelLight, ModelOptions, Up};
pub use colour::colour;
pub use report::{Hull, LoadReport, Model, Warning};
pub use sketch::sketch;
pub use surface::{Index, Surface};
pub use texture::picture;
pub use transform::Transform;

#[cfg(feature = "cli")]
pub(crate) use {brief::plain_numbers, suggest::hint};

use std::path::{Path, PathBuf};

use crate::image::MOST_PIXELS;
use crate::scene::Scene;
use crate::{Error, Result};

/// Options for reading files.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Treats warnings as errors.
    pub strict: bool,
    /// Folder that must contain every file a scene names; by default that of the scene file.
    pub root: Option<PathBuf>,
    /// Name of the camera of a glTF model that is rendered by itself; by default the first one.
    pub camera: Option<String>,
    /// Further folders that may contain files a scene names.
    pub allow_outside: Vec<PathBuf>,
    /// Options of a model by itself.
    pub model: ModelOptions,
    /// Limits on the input.
    pub limits: Limits,
}

/// Limits on the input, beyond which loading fails with `Error::Limit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of bytes of one file.
    pub file_bytes: u64,
    /// Largest number of bytes of one line of a model file.
    pub line_bytes: usize,
    /// Largest number of positions, of normals and of texture coordinates of one model file.
    pub vertices: u64,
    /// Largest number of triangles of a scene.
    pub triangles: u64,
    /// Largest number of shapes, of lights and of materials of a scene.
    pub objects: usize,
    /// Largest edge of a picture that is read, in pixels.
    pub texture_edge: u32,
    /// Largest number of bytes of all decoded pictures together.
    pub texture_bytes: u64,
    /// Largest number of pixels of the picture to render.
    pub film_pixels: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 2 << 30,
            line_bytes: 16 << 20,
            vertices: 200_000_000,
            triangles: 50_000_000,
            objects: 1_000_000,
            texture_edge: 16_384,
            texture_bytes: 2 << 30,
            film_pixels: MOST_PIXELS,
        }
    }
}

/// Loaded scene with a report on its files.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Warnings, dropped faces and defaults.
    pub report: LoadReport,
}

/// Reads a scene file (`.toml`), or a model file (`.obj`, `.gltf`, `.glb`, `.ply`, `.stl`) with a sky and, unless it
/// has its own, a fitted camera and default lights.
///
/// # Errors
/// - [`Error::Input`] or [`Error::File`] for wrong content.
/// - [`Error::Io`] if a file cannot be read.
/// - [`Error::Limit`] if a file exceeds a limit.
pub fn scene(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    let gltf = format::Format::of(path) == Some(format::Format::Gltf);
    if let (Some(name), false) = (&options.camera, gltf) {
        return Err(Error::file(path, format!("has no camera `{name}`: only a glTF model has cameras by name")));
    }
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => document::load(path, options),
        _ => match format::Format::of(path) {
            Some(format) => model::load(path, format, options),
            None => {
                let models = format::ENDINGS;
                let start = crate::system::files::read_start(path, 4096).unwrap_or_default();
                let holds = holds::content(&start).map_or_else(String::new, |what| format!("it holds {what}; "));
                let message = format!("is neither a scene (.toml) nor a model ({models}); {holds}give one of these");
                Err(Error::file(path, message))
            }
        },
    }
}
