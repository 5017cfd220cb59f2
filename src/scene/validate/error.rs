//! Rules that a scene can break.

use std::fmt;

use crate::Error;

/// A part of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Part {
    /// `Scene::objects` and `Scene::geometry`.
    Object,
    /// `Scene::materials`.
    Material,
    /// `Scene::media`.
    Medium,
    /// `Scene::lights`.
    Light,
    /// `Scene::textures`.
    Texture,
    /// `Scene::environment` and `Scene::ambient`.
    Environment,
    /// `Scene::camera`.
    Camera,
    /// `Scene::settings`.
    Settings,
}

impl Part {
    fn name(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::Material => "material",
            Self::Medium => "medium",
            Self::Light => "light",
            Self::Texture => "texture",
            Self::Environment => "the environment",
            Self::Camera => "the camera",
            Self::Settings => "the settings",
        }
    }

    /// Returns true if a scene has one of it and not a list.
    fn is_single(self) -> bool {
        matches!(self, Self::Environment | Self::Camera | Self::Settings)
    }
}

/// An entry of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneEntry {
    /// The list, or the single part.
    pub part: Part,
    /// Index in the list. 0 for a single part.
    pub index: usize,
    /// Name of the entry. Empty for a single part.
    pub name: String,
}

impl fmt::Display for SceneEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.part.name())?;
        if !self.part.is_single() {
            write!(f, " {} (`{}`)", self.index, self.name)?;
        }
        Ok(())
    }
}

/// A rule that a scene breaks, the entry that breaks it, and the cure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// `geometry` and `objects` are of different lengths.
    #[error("the scene has {shapes} shapes and {objects} objects; add both at once by `Scene::add_object`")]
    Unpaired {
        /// Length of `geometry`.
        shapes: usize,
        /// Length of `objects`.
        objects: usize,
    },
    /// `media` is empty.
    #[error("the scene has no media; medium 0 is what surrounds everything: put `Medium::air()` there")]
    NoMedium,
    /// An index beyond the end of a list.
    #[error(
        "{place}: {field} is {index}, but the list has {len} entries; take an index that an `add_` method returned"
    )]
    Index {
        /// The entry that holds the index.
        place: SceneEntry,
        /// The field that holds it.
        field: &'static str,
        /// The index.
        index: u32,
        /// Length of the list.
        len: usize,
    },
    /// A list of another length than its fellow.
    #[error("{place}: {field} has {len} entries; it must have {wanted}")]
    Length {
        /// The entry that holds the list.
        place: SceneEntry,
        /// The list.
        field: &'static str,
        /// Its length.
        len: usize,
        /// The length it must have.
        wanted: usize,
    },
    /// The mask of a shape contradicts its surface.
    #[error("{place}: the shape's mask does not fit its material; set it to `Material::mask()`")]
    Mask {
        /// The object.
        place: SceneEntry,
    },
    /// A value out of its range.
    #[error("{place}: {field} is {value}; it must be {must}")]
    Value {
        /// The entry that holds the value.
        place: SceneEntry,
        /// The field.
        field: &'static str,
        /// The value.
        value: String,
        /// The range.
        must: &'static str,
    },
}

impl From<SceneError> for Error {
    /// Bad input as a whole (exit code 2).
    fn from(error: SceneError) -> Self {
        Self::Usage(error.to_string())
    }
}
