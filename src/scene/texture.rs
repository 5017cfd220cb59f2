//! Pictures to look colours up in.

use super::Rgb;

/// A picture in linear colour; its first row is at the top (texture coordinate v = 1).
#[derive(Clone, Debug, Default)]
pub struct Texture {
    /// The file as messages name it.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Linear colours, row by row.
    pub pixels: Vec<Rgb>,
}
