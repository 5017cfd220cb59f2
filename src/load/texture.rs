//! Pictures to look colours up in: PNG, JPEG, Radiance HDR, OpenEXR, PFM, told apart by their content.

use std::io::Cursor;
use std::path::Path;

use super::{Limits, LoadOptions};
use crate::scene::{Rgb, Texture};
use crate::{Error, Result};

/// Reads a picture in linear colour.
///
/// # Errors
/// `Io` where it cannot be read, `Limit` where it is larger than the options allow, `File` for anything else.
pub fn picture(path: &Path, options: &LoadOptions) -> Result<Texture> {
    read(path, &options.limits).map(|(picture, _)| picture)
}

/// Reads a picture, and counts the pixels that were not finite or negative; those are black.
pub(super) fn read(path: &Path, limits: &Limits) -> Result<(Texture, u64)> {
    let bytes = super::source::read(path, limits.file_bytes)?;
    let mut picture = if bytes.starts_with(b"PF") || bytes.starts_with(b"Pf") {
        pfm(path, &bytes, limits)?
    } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        open_exr(path, &bytes, limits)?
    } else {
        decoded(path, &bytes, limits)?
    };
    if picture.width == 0 || picture.height == 0 {
        return Err(Error::file(path, format!("the picture is {} by {} pixels", picture.width, picture.height)));
    }
    let mut repaired = 0;
    for pixel in &mut picture.pixels {
        if !(pixel.is_finite() && pixel.min_element() >= 0.0) {
            *pixel = Rgb::from(pixel.to_array().map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 }));
            repaired += 1;
        }
    }
    Ok((picture, repaired))
}

/// Refuses sizes beyond the limits before anything is allocated for them.
fn check_size(path: &Path, width: u64, height: u64, limits: &Limits) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(Error::file(path, format!("the picture is {width} by {height} pixels")));
    }
    let edge = u64::from(limits.texture_edge);
    if width > edge || height > edge {
        return Err(Error::Limit(format!(
            "{}: the picture is {width} by {height} pixels; edges of {edge} are allowed",
            path.display()
        )));
    }
    let bytes = width * height * size_of::<Rgb>() as u64;
    if bytes > limits.texture_bytes {
        return Err(Error::Limit(format!(
            "{}: the picture takes {bytes} bytes; {} are left for pictures",
            path.display(),
            limits.texture_bytes
        )));
    }
    Ok(())
}

/// PNG, JPEG and HDR.
fn decoded(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Texture> {
    use image::ImageFormat::{Hdr, Jpeg, Png};
    let refuse = |e: image::ImageError| match e {
        image::ImageError::Limits(e) => Error::Limit(format!("{}: the picture is too large: {e}", path.display())),
        e => Error::file(
            path,
            format!("the picture cannot be read: {}", e.to_string().lines().collect::<Vec<_>>().join("; ")),
        ),
    };
    let reader = || {
        let mut reader = image::ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|e| Error::io(path, "read", e))?;
        match reader.format() {
            Some(Png | Jpeg | Hdr) => {}
            _ => return Err(Error::file(path, "is no PNG, JPEG, HDR, EXR or PFM picture")),
        }
        let mut bounds = image::Limits::default();
        bounds.max_image_width = Some(limits.texture_edge);
        bounds.max_image_height = Some(limits.texture_edge);
        bounds.max_alloc = Some(limits.texture_bytes);
        reader.limits(bounds);
        Ok(reader)
    };
    let probe = reader()?;
    let linear = probe.format() == Some(Hdr);
    let (width, height) = probe.into_dimensions().map_err(refuse)?;
    check_size(path, width.into(), height.into(), limits)?;
    let picture = reader()?.decode().map_err(refuse)?;
    let pixels = picture
        .into_rgb32f()
        .pixels()
        .map(|p| Rgb::from(p.0))
        .map(|c| if linear { c } else { srgb_to_linear(c) })
        .collect();
    Ok(Texture { name: path.display().to_string(), width, height, pixels })
}

/// The first layer that has red, green and blue.
fn open_exr(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Texture> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let refuse = |e: exr::error::Error| Error::file(path, format!("the picture cannot be read: {e}"));
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(refuse)?;
    for header in &meta.headers {
        check_size(path, header.layer_size.0 as u64, header.layer_size.1 as u64, limits)?;
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![Rgb::ZERO; size.area()]),
            |(width, pixels): &mut (usize, Vec<Rgb>), at, (r, g, b, _): (f32, f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = Rgb::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(refuse)?;
    let size = image.layer_data.size;
    let (_, pixels) = image.layer_data.channel_data.pixels;
    Ok(Texture { name: path.display().to_string(), width: size.width() as u32, height: size.height() as u32, pixels })
}

/// Portable float map: `PF` (colour) or `Pf` (grey), width, height, scale (negative for little endian), then rows
/// from the bottom up.
fn pfm(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Texture> {
    let bad = |what: &str| Error::file(path, format!("the PFM picture cannot be read: {what}"));
    let mut at = 0;
    let mut word = || {
        let start = at + bytes[at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        let end = start + bytes[start..].iter().take(64).take_while(|b| !b.is_ascii_whitespace()).count();
        at = end;
        std::str::from_utf8(&bytes[start..end]).unwrap_or("")
    };
    let channels = if word() == "PF" { 3 } else { 1 };
    let size: [u64; 2] = [word(), word()].map(|w| w.parse().unwrap_or(u64::MAX));
    let scale: f32 = word().parse().map_err(|_| bad("its scale is no number"))?;
    if scale == 0.0 || !scale.is_finite() {
        return Err(bad("its scale is 0 or not finite"));
    }
    if size.contains(&u64::MAX) {
        return Err(bad("its size is no number"));
    }
    let [width, height] = size;
    check_size(path, width, height, limits)?;
    // One byte of white space ends the header.
    let data = bytes.get(at + 1..).unwrap_or(&[]);
    let row = width as usize * channels * 4;
    if data.len() < row * height as usize {
        return Err(bad(&format!("it ends after {} of {} bytes", data.len(), row * height as usize)));
    }
    let number = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if scale < 0.0 { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let mut pixels = Vec::with_capacity((width * height) as usize);
    for y in (0..height as usize).rev() {
        for pixel in data[y * row..(y + 1) * row].chunks_exact(4 * channels) {
            let channel = |i: usize| number(&pixel[4 * i..]);
            pixels.push(if channels == 3 {
                Rgb::new(channel(0), channel(1), channel(2))
            } else {
                Rgb::splat(channel(0))
            });
        }
    }
    Ok(Texture { name: path.display().to_string(), width: width as u32, height: height as u32, pixels })
}

/// The transfer function of IEC 61966-2-1, inverted.
fn srgb_to_linear(c: Rgb) -> Rgb {
    let channel = |c: f32| if c <= 0.04045 { c / 12.92 } else { ((f64::from(c) + 0.055) / 1.055).powf(2.4) as f32 };
    Rgb::new(channel(c.x), channel(c.y), channel(c.z))
}
