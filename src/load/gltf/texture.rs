//! Textures of materials: where a surface finds its place in a picture, and the pictures.

use glam::Vec2;
use gltf_json::texture::Info;

use super::extension::{Extensions, Fields};

/// Texture that a material names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TextureRef {
    /// Index in the file.
    pub texture: usize,
    pub placement: Placement,
}

/// Texture coordinates of a surface: a set of the mesh and an affine map of it (`KHR_texture_transform`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pub set: u32,
    offset: [f64; 2],
    /// In radians; pictures turn clockwise.
    rotation: f64,
    scale: [f64; 2],
}

/// The first set of texture coordinates, as it is.
impl Default for Placement {
    fn default() -> Self {
        Self::new(0, None)
    }
}

impl Placement {
    fn new(set: u32, transform: Option<Fields<'_>>) -> Self {
        let plain = Self { set, offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] };
        transform.map_or(plain, |t| Self {
            set: t.index("texCoord").map_or(set, |set| set as u32),
            offset: t.numbers("offset", [0.0; 2]),
            rotation: t.number("rotation", 0.0),
            scale: t.numbers("scale", [1.0; 2]),
        })
    }

    /// Returns our texture coordinates, whose v runs upwards, for those of the file, whose v runs downwards.
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> Vec2 {
        let [u, v] = [u * self.scale[0], v * self.scale[1]];
        let (sin, cos) = if self.rotation == 0.0 { (0.0, 1.0) } else { self.rotation.sin_cos() };
        let [u, v] = [cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]];
        Vec2::new(u as f32, (1.0 - v) as f32)
    }
}

impl TextureRef {
    /// Returns the texture of a material's own field.
    pub(super) fn of(info: &Info) -> Self {
        Self::new(info.index.value(), info.tex_coord, info.extensions.as_ref().map(|e| &e.others))
    }

    pub(super) fn new(texture: usize, set: u32, extensions: Option<&Extensions>) -> Self {
        Self { texture, placement: Placement::new(set, Fields::of(extensions, "KHR_texture_transform")) }
    }

    /// Returns the texture of an extension's field.
    pub(super) fn in_extension(fields: Fields<'_>, name: &str) -> Option<Self> {
        let info = fields.object(name);
        let set = info.index("texCoord").unwrap_or(0) as u32;
        let extensions = info.get("extensions").and_then(serde_json::Value::as_object);
        Some(Self::new(info.index("index")?, set, extensions))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_scaled_then_turned_then_moved_and_v_is_turned_up() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let plain = Placement { set: 0, offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] };
        assert_eq!(plain.place([0.25, 0.25]), Vec2::new(0.25, 0.75));
        let moved = Placement { offset: [0.5, 0.0], scale: [2.0, 1.0], ..plain };
        assert_eq!(moved.place([0.25, 0.25]), Vec2::new(1.0, 0.75));
        // Counter-clockwise in a picture whose v runs downwards: right becomes up.
        let turned = Placement { rotation: quarter, ..plain };
        assert!((turned.place([1.0, 0.0]) - Vec2::new(0.0, 2.0)).length() < 1e-6, "{}", turned.place([1.0, 0.0]));
    }
}
