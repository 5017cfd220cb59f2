//! Limits on pictures that are read.

use super::film::MOST_PIXELS;

/// Limits on pictures to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of columns, and of rows.
    pub edge: u32,
    /// Largest number of pixels.
    pub pixels: u64,
    /// Largest length of the file in bytes.
    pub bytes: u64,
}

impl Default for Limits {
    /// Returns 65,536 pixels per edge, [`MOST_PIXELS`] (1.5 GiB as a film), and files of 2 GiB.
    fn default() -> Self {
        Self { edge: 65_536, pixels: MOST_PIXELS, bytes: 2 << 30 }
    }
}
