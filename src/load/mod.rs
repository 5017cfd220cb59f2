//! From files to a [`Scene`]: scene TOML, OBJ with MTL, pictures, built-in shapes. The only room that knows what
//! files look like.
//!
//! Wrong input is an error that names file, line and value. What can be understood all the same is a warning,
//! counted in the [`LoadReport`]; nothing is repaired in silence.

mod assembly;
mod brief;
pub mod catalogue;
mod document;
mod draft;
mod extent;
mod model;
mod obj;
mod origin;
mod report;
pub mod shapes;
mod smooth;
mod source;
mod suggest;
mod texture;
mod transform;
mod winding;

pub use report::{Hull, LoadReport, Model, Warning};
pub use texture::picture;
pub use transform::Transform;

#[cfg(feature = "cli")]
pub(crate) use {brief::plain_numbers, suggest::hint};

use std::path::{Path, PathBuf};

use crate::image::MOST_PIXELS;
use crate::scene::Scene;
use crate::{Error, Result};

/// How files are read.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Whether a warning is an error.
    pub strict: bool,
    /// The folder that every file a scene names must lie in; the scene file's own where none is given.
    pub root: Option<PathBuf>,
    /// How much is taken on.
    pub limits: Limits,
}

/// How much is taken on before loading stops with `Error::Limit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file.
    pub file_bytes: u64,
    /// Bytes of one line of a model file.
    pub line_bytes: usize,
    /// Positions, normals or texture coordinates of one model file, each.
    pub vertices: u64,
    /// Triangles of a whole scene.
    pub triangles: u64,
    /// Shapes, lights or materials of a whole scene, each.
    pub objects: usize,
    /// Edge of a picture that is read, in pixels.
    pub texture_edge: u32,
    /// Bytes of all decoded pictures together.
    pub texture_bytes: u64,
    /// Pixels of the picture to render.
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

/// A scene and what was odd about its files.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Warnings, dropped faces, defaults.
    pub report: LoadReport,
}

/// Reads a scene file (`.toml`), or a model file (`.obj`) with a camera fitted to it, a default light and a sky.
///
/// # Errors
/// `Input` or `File` for what is wrong in a file, `Io` where one cannot be read, `Limit` where one asks for too much.
pub fn scene(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => document::load(path, options),
        Some("obj") => model::load(path, options),
        _ => Err(Error::file(path, "is neither a scene (.toml) nor a model (.obj)")),
    }
}
