//! Texture pictures: any format that [`crate::image`] reads, checked for use as light.

use std::path::Path;

use super::{Limits, LoadOptions};
use crate::Result;
use crate::image::{self, Picture, ReadOptions};
use crate::scene::{Rgb, Texture};

/// Picture and counts of its repairs.
pub(super) struct Reading {
    pub texture: Texture,
    /// Number of pixels with a channel that was not finite or below zero, and was set to 0.
    pub repaired: u64,
    /// True if the picture had an alpha channel.
    pub alpha_dropped: bool,
}

/// Reads a picture in linear colour. Channels that are not finite or below zero become 0.
///
/// # Errors
/// - [`Error::Io`](crate::Error::Io) if the file cannot be read.
/// - [`Error::Limit`](crate::Error::Limit) if it exceeds the limits.
/// - [`Error::File`](crate::Error::File) for any other fault.
pub fn picture(path: &Path, options: &LoadOptions) -> Result<Texture> {
    read(path, &options.limits).map(|reading| reading.texture)
}

/// Reads a picture as [`picture`] does, with counts of its repairs.
pub(super) fn read(path: &Path, limits: &Limits) -> Result<Reading> {
    image::read(path, &options(limits)).map(|picture| reading(path, picture))
}

/// Decodes the bytes of a picture; messages name `path`. With `linear`, codes are not colours but shares of the largest.
pub(super) fn decode(bytes: &[u8], path: &Path, linear: bool, limits: &Limits) -> Result<Reading> {
    image::decode(bytes, path, &ReadOptions { linear, ..options(limits) }).map(|picture| reading(path, picture))
}

/// Returns the mean of the codes of a picture, as shares of the largest one.
pub(super) fn mean(bytes: &[u8], path: &Path, limits: &Limits) -> Result<[f64; 3]> {
    let picture = image::decode(bytes, path, &ReadOptions { linear: true, ..options(limits) })?;
    let pixels = &picture.film.pixels;
    let sum = pixels.iter().fold([0.0; 3], |sum, p| std::array::from_fn(|c| sum[c] + f64::from(p[c])));
    Ok(sum.map(|c| c / pixels.len().max(1) as f64))
}

fn options(limits: &Limits) -> ReadOptions {
    let limits = image::Limits {
        edge: limits.texture_edge,
        pixels: limits.texture_bytes / size_of::<Rgb>() as u64,
        bytes: limits.file_bytes,
    };
    ReadOptions { limits, linear: false }
}

fn reading(path: &Path, picture: Picture) -> Reading {
    let mut repaired = 0;
    let mut light = |pixel: [f32; 3]| {
        let kept = pixel.map(|c| if c.is_finite() && c > 0.0 { c } else { 0.0 });
        repaired += u64::from(kept != pixel);
        Rgb::from(kept)
    };
    let pixels = picture.film.pixels.into_iter().map(&mut light).collect();
    let texture =
        Texture { name: path.display().to_string(), width: picture.film.width, height: picture.film.height, pixels };
    Reading { texture, repaired, alpha_dropped: picture.alpha_dropped }
}
