//! Rendered picture in linear colour.

/// Largest number of pixels of a picture to render or read: 2^27, some 7 GB while it is rendered.
pub const MOST_PIXELS: u64 = 1 << 27;

/// Linear RGB radiance, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` colours.
    pub pixels: Vec<[f32; 3]>,
}

impl Film {
    /// Returns a black picture.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }

    /// Returns the colour at column `x` and row `y`.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> [f32; 3] {
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}
