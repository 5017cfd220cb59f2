//! Pictures to look colours up in: whatever [`crate::image`] reads, made fit to be light.

use std::path::Path;

use super::{Limits, LoadOptions};
use crate::Result;
use crate::image::{self, ReadOptions};
use crate::scene::{Rgb, Texture};

/// A picture, and what was left out of it.
pub(super) struct Reading {
    pub texture: Texture,
    /// Pixels with a channel that was not finite or below zero; that channel is 0.
    pub repaired: u64,
    /// Whether it had an alpha channel.
    pub alpha_dropped: bool,
}

/// Reads a picture in linear colour. Channels that are not finite or below zero are 0.
///
/// # Errors
/// `Io` where it cannot be read, `Limit` where it is larger than the options allow, `File` for anything else.
pub fn picture(path: &Path, options: &LoadOptions) -> Result<Texture> {
    read(path, &options.limits).map(|reading| reading.texture)
}

/// As [`picture`], and what was left out.
pub(super) fn read(path: &Path, limits: &Limits) -> Result<Reading> {
    let limits = image::Limits {
        edge: limits.texture_edge,
        pixels: limits.texture_bytes / size_of::<Rgb>() as u64,
        bytes: limits.file_bytes,
    };
    let picture = image::read(path, &ReadOptions { limits, linear: false })?;
    let mut repaired = 0;
    let mut light = |pixel: [f32; 3]| {
        let kept = pixel.map(|c| if c.is_finite() && c > 0.0 { c } else { 0.0 });
        repaired += u64::from(kept != pixel);
        Rgb::from(kept)
    };
    let pixels = picture.film.pixels.into_iter().map(&mut light).collect();
    let texture =
        Texture { name: path.display().to_string(), width: picture.film.width, height: picture.film.height, pixels };
    Ok(Reading { texture, repaired, alpha_dropped: picture.alpha_dropped })
}
