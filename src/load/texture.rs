//! Pictures for textures and environments.

use std::path::Path;

use super::{Limits, LoadOptions};
use crate::Result;
use crate::image::{self, ReadOptions, Samples, Stored};
use crate::scene::{Rgb, Texels, Texture};

/// Picture and counts of its repairs.
pub(super) struct Reading {
    pub texture: Texture,
    /// Number of pixels with a channel that was not finite or below zero, and was set to 0.
    pub repaired: u64,
    /// Coverage of each pixel, from 0 to 255, if the picture has an alpha channel that is not opaque everywhere.
    pub alpha: Option<Vec<u8>>,
}

/// Reads a picture in linear colour. Channels that are not finite or below zero become 0.
///
/// # Errors
/// - [`Error::Io`](crate::Error::Io) if the file cannot be read.
/// - [`Error::Limit`](crate::Error::Limit) if it exceeds the limits.
/// - [`Error::File`](crate::Error::File) for any other fault.
pub fn picture(path: &Path, options: &LoadOptions) -> Result<Texture> {
    read(path, &options.limits, false).map(|reading| reading.texture)
}

/// Reads a picture as [`picture`] does, with counts of its repairs and its alpha channel.
///
/// Codes of a `linear` picture are shares; otherwise they are sRGB.
pub(super) fn read(path: &Path, limits: &Limits, linear: bool) -> Result<Reading> {
    image::read_stored(path, &options(limits, linear)).map(|stored| reading(path, stored))
}

/// Decodes the bytes of a picture as [`read`] does; messages name `path`.
pub(super) fn decode(bytes: &[u8], path: &Path, limits: &Limits, linear: bool) -> Result<Reading> {
    image::decode_stored(bytes, path, &options(limits, linear)).map(|stored| reading(path, stored))
}

/// Returns the mean of the codes of a picture, as shares of the largest one.
pub(super) fn mean(bytes: &[u8], path: &Path, limits: &Limits) -> Result<[f64; 3]> {
    let pixels = image::decode_stored(bytes, path, &options(limits, true))?.into_film().pixels;
    let sum = pixels.iter().fold([0.0; 3], |sum, p| std::array::from_fn(|c| sum[c] + f64::from(p[c])));
    Ok(sum.map(|c| c / pixels.len().max(1) as f64))
}

fn options(limits: &Limits, linear: bool) -> ReadOptions {
    let limits = image::Limits {
        edge: limits.texture_edge,
        pixels: limits.texture_bytes / size_of::<Rgb>() as u64,
        bytes: limits.file_bytes,
    };
    ReadOptions { limits, linear }
}

fn reading(path: &Path, stored: Stored) -> Reading {
    let mut repaired = 0;
    let mut light = |pixel: [f32; 3]| {
        let kept = pixel.map(|c| if c.is_finite() && c > 0.0 { c } else { 0.0 });
        repaired += u64::from(kept != pixel);
        Rgb::from(kept)
    };
    let pixels = match stored.samples {
        Samples::Light(pixels) => Texels::Light(pixels.into_iter().map(&mut light).collect()),
        Samples::Codes { codes, light } => Texels::Codes { codes, light },
        Samples::Grey { codes, light } => Texels::Grey { codes, light },
    };
    let texture = Texture::new(path.display().to_string(), stored.width, stored.height, pixels);
    Reading { texture, repaired, alpha: stored.alpha }
}
