//! Reading of picture files, recognised by their first bytes.

use std::path::Path;

use super::film::Film;
use super::limits::Limits;
use super::samples::Stored;
use super::{common, exr, pfm, png};
use crate::system::{files, memory};
use crate::{Error, Result};

/// Bytes per pixel of a film.
const FILM_BYTES: u64 = size_of::<[f32; 3]>() as u64;

/// Options for reading a picture file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Limits on its size.
    pub limits: Limits,
    /// Treats the codes of PNG and JPEG as linear light, whatever the file specifies.
    pub linear: bool,
}

/// Picture read from a file.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Colours in linear light.
    pub film: Film,
    /// True if an alpha channel that is not opaque everywhere was left out. Colours are not multiplied by it.
    pub alpha_dropped: bool,
}

/// Reads PNG, OpenEXR, Radiance HDR, PFM, JPEG, BMP, TGA, TIFF, GIF, WebP, PNM or QOI. PNG may have any depth; its codes
/// are decoded by its sRGB or gAMA chunk, or as sRGB. Samples that are not finite are kept.
///
/// # Errors
/// - [`Error::Io`] if the file cannot be read.
/// - [`Error::File`] if it is no such picture, damaged, or of size 0.
/// - [`Error::Limit`] if it exceeds the limits of the options.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Picture> {
    read_stored(path, options).map(Picture::from)
}

/// Reads a picture as [`read`] does, in the depth of its file and with its alpha channel.
///
/// # Errors
/// As [`read`].
pub fn read_stored(path: &Path, options: &ReadOptions) -> Result<Stored> {
    decode_stored(&files::read(path, options.limits.bytes)?, path, options)
}

impl From<Stored> for Picture {
    fn from(stored: Stored) -> Self {
        let alpha_dropped = stored.alpha.is_some();
        Self { film: stored.into_film(), alpha_dropped }
    }
}

/// Message for a file that is no picture.
const UNKNOWN: &str =
    "no picture of a kind that is read: PNG, JPEG, BMP, TGA, TIFF, GIF, WebP, PNM, QOI, OpenEXR, Radiance HDR, PFM";
/// Message for an empty file.
const EMPTY: &str = "no picture of a kind that is read: the file is empty";

/// Decodes a file's bytes; errors name `path`.
///
/// # Errors
/// As [`read`], but for those of reading the file.
pub fn decode_stored(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Stored> {
    // Messages of decoders may have several lines; an error has one.
    let one_line = |e: String| e.split_whitespace().collect::<Vec<_>>().join(" ");
    let wrong = |kind: &'static str| move |e| Error::file(path, format!("not a readable {kind}: {}", one_line(e)));
    let check = |(width, height), each: u64, shortest: u64| {
        check_size(path, width, height, options.limits)?;
        if (bytes.len() as u64) < shortest {
            let message = format!("it is cut short: {} bytes cannot hold {width} by {height} pixels", bytes.len());
            return Err(Error::file(path, message));
        }
        let what = format!("{}: {width} by {height} pixels", path.display());
        memory::need(&what, (u64::from(width) * u64::from(height)).saturating_mul(each), "take a smaller picture")
    };

    let stored = match bytes {
        [0x89, b'P', b'N', b'G', ..] => {
            let header = png::header(bytes).map_err(wrong("PNG"))?;
            check(header.size(), header.bytes_a_pixel(), header.shortest())?;
            header.decode(options.linear).map_err(wrong("PNG"))?
        }
        [0x76, 0x2f, 0x31, 0x01, ..] => {
            let (size, each) = exr::size(bytes).map_err(wrong("OpenEXR file"))?;
            check(size, each, 0)?;
            exr::decode(bytes).map_err(wrong("OpenEXR file"))?
        }
        [b'P', b'F' | b'f', ..] => {
            let header = pfm::header(bytes).map_err(wrong("PFM"))?;
            check((header.width, header.height), FILM_BYTES, 0)?;
            pfm::decode(bytes, &header).map_err(wrong("PFM"))?.into()
        }
        _ => {
            let Some((format, name)) = common::format_of(bytes) else {
                let why = common::undecoded(bytes).unwrap_or(if bytes.is_empty() { EMPTY } else { UNKNOWN });
                return Err(Error::file(path, why));
            };
            let size = common::dimensions(bytes, format).map_err(wrong(name))?;
            check(size, common::bytes_a_pixel(format), common::shortest(format, size))?;
            common::decode(bytes, format, (options.limits.edge, options.limits.pixels), options.linear)
                .map_err(wrong(name))?
        }
    };
    Ok(stored)
}

fn check_size(path: &Path, width: u32, height: u32, limits: Limits) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(Error::file(path, format!("a picture of {width} by {height} pixels has nothing to show")));
    }
    if width.max(height) > limits.edge || u64::from(width) * u64::from(height) > limits.pixels {
        return Err(Error::Limit(format!(
            "{}: {width} by {height} pixels; at most {} an edge and {} in all are read",
            path.display(),
            limits.edge,
            limits.pixels
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{Bits, Encoding, Format, encode, linear_from_srgb};
    use super::*;

    /// Returns a film of 11 by 3 pixels with every kind of number.
    fn film() -> Film {
        let mut film = Film::new(11, 3);
        for (i, p) in film.pixels.iter_mut().enumerate() {
            let x = i as f32 / 32.0;
            *p = [x, 1.0 - x, x * x * 0.7];
        }
        film
    }

    fn file(bytes: &[u8]) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        file
    }

    fn bytes(film: &Film, format: Format, bits: Bits) -> Vec<u8> {
        let metadata = vec![(String::from("vitrum:depth"), String::from("5"))];
        encode(film, &Encoding { format, bits, metadata }).unwrap().bytes
    }

    fn read_back(bytes: &[u8]) -> Film {
        read(file(bytes).path(), &ReadOptions::default()).unwrap().film
    }

    fn bits_of(film: &Film) -> Vec<u32> {
        film.pixels.as_flattened().iter().map(|x| x.to_bits()).collect()
    }

    /// Cases AC-06 (channels have 32 bits, which represent 70,000) and AC-07 of the catalogue.
    #[test]
    fn exr_and_pfm_give_back_every_bit() {
        let mut film = film();
        film.pixels[0] = [f32::INFINITY, -0.0, -3.0];
        film.pixels[1] = [f32::MIN_POSITIVE / 8.0, f32::MAX, 1e-30];
        film.pixels[2] = [f32::NAN, 0.1, 70_000.0];
        for format in [Format::Exr, Format::Pfm] {
            let back = read_back(&bytes(&film, format, Bits::Eight));
            assert_eq!((back.width, back.height), (11, 3));
            assert_eq!(bits_of(&back), bits_of(&film), "{format:?}");
        }
    }

    #[test]
    fn png_gives_back_the_nearest_code_at_both_depths() {
        for (bits, max) in [(Bits::Eight, 255.0), (Bits::Sixteen, 65535.0)] {
            let film = film();
            let first = bytes(&film, Format::Png, bits);
            let back = read_back(&first);
            for (a, b) in film.pixels.as_flattened().iter().zip(back.pixels.as_flattened()) {
                let code = |x: f32| super::super::srgb_from_linear(f64::from(x)) * max;
                assert!((code(*a) - code(*b)).abs() <= 0.501, "{a} {b}");
            }
            assert_eq!(bytes(&back, Format::Png, bits), first, "what was read is written the same");
        }
    }

    #[test]
    fn hdr_gives_back_each_colour_within_half_a_step_of_its_largest_channel() {
        let mut film = film();
        film.pixels[0] = [1e30, 3e29, 0.0];
        film.pixels[1] = [1e-30, 3e-31, 0.0];
        let first = bytes(&film, Format::Hdr, Bits::Eight);
        let back = read_back(&first);
        for (a, b) in film.pixels.iter().zip(&back.pixels) {
            let step = a.iter().fold(0.0_f32, |m, &x| m.max(x)) / 128.0;
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= step * 0.5), "{a:?} {b:?}");
        }
        assert_eq!(bytes(&back, Format::Hdr, Bits::Eight), first, "what was read is written the same");
    }

    #[test]
    fn the_gamma_chunk_says_how_codes_stand_for_light() {
        // One grey 16-bit pixel of code 16384 (a quarter) with the given gAMA and sRGB chunks.
        let png = |gamma: Option<f32>, srgb: bool| {
            let mut bytes = Vec::new();
            let mut encoder = ::png::Encoder::new(&mut bytes, 1, 1);
            encoder.set_color(::png::ColorType::Grayscale);
            encoder.set_depth(::png::BitDepth::Sixteen);
            if let Some(gamma) = gamma {
                encoder.set_source_gamma(::png::ScaledFloat::new(gamma));
            }
            if srgb {
                encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
            }
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(&[0x40, 0x00]).unwrap();
            writer.finish().unwrap();
            bytes
        };
        let x = 16384.0 / 65535.0_f64;
        let linear = |gamma, srgb| f64::from(read_back(&png(gamma, srgb)).pixels[0][1]);
        assert!((linear(Some(1.0), false) - x).abs() < 1e-8);
        assert!((linear(Some(0.5), false) - x * x).abs() < 1e-8);
        for (gamma, srgb) in [(None, false), (None, true), (Some(1.0), true), (Some(1.0 / 2.2), false)] {
            assert!((linear(gamma, srgb) - linear_from_srgb(x)).abs() < 1e-8, "{gamma:?} {srgb}");
        }
        let forced = ReadOptions { linear: true, ..ReadOptions::default() };
        let picture = read(file(&png(None, true)).path(), &forced).unwrap();
        assert!((f64::from(picture.film.pixels[0][0]) - x).abs() < 1e-8);
    }

    #[test]
    fn a_palette_and_an_alpha_channel_are_understood() {
        let mut bytes = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(::png::ColorType::Indexed);
        encoder.set_depth(::png::BitDepth::One);
        encoder.set_palette(vec![255, 0, 0, 0, 0, 255]);
        encoder.set_trns(vec![255, 0]);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[0b0100_0000]).unwrap();
        writer.finish().unwrap();
        let picture = read(file(&bytes).path(), &ReadOptions::default()).unwrap();
        assert_eq!(picture.film.pixels, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(picture.alpha_dropped);
    }

    #[test]
    fn what_is_too_large_is_refused_before_its_pixels_are_touched() {
        let limits = Limits { edge: 10, ..Limits::default() };
        for format in [Format::Png, Format::Exr, Format::Hdr, Format::Pfm] {
            let file = file(&bytes(&film(), format, Bits::Eight));
            let error = read(file.path(), &ReadOptions { limits, linear: false }).unwrap_err();
            assert!(matches!(error, Error::Limit(_)), "{error}");
            let few = Limits { pixels: 32, ..Limits::default() };
            let error = read(file.path(), &ReadOptions { limits: few, linear: false }).unwrap_err();
            assert!(matches!(error, Error::Limit(_)), "{error}");
        }
        let short = Limits { bytes: 20, ..Limits::default() };
        let file = file(&bytes(&film(), Format::Pfm, Bits::Eight));
        assert!(matches!(read(file.path(), &ReadOptions { limits: short, linear: false }), Err(Error::Limit(_))));
    }

    #[test]
    fn sizes_of_zero_and_announced_giants_are_refused() {
        for text in ["#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n", "PF 0 5 -1 ", "PF 5 0 -1 "] {
            assert!(matches!(read(file(text.as_bytes()).path(), &ReadOptions::default()), Err(Error::File { .. })));
        }
        for text in ["#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 90000 +X 90000\n", "PF 4294967295 4294967295 -1 "] {
            assert!(matches!(read(file(text.as_bytes()).path(), &ReadOptions::default()), Err(Error::Limit(_))));
        }
    }

    #[test]
    fn damage_anywhere_is_an_error_or_another_picture_but_never_a_panic() {
        for format in [Format::Png, Format::Exr, Format::Hdr, Format::Pfm] {
            let whole = bytes(&film(), format, Bits::Sixteen);
            for end in 0..whole.len() {
                let cut = decode_stored(&whole[..end], Path::new("cut"), &ReadOptions::default());
                // A PNG is readable without its end chunk, and without the checksum of its deflate stream.
                assert!(cut.is_err() || format == Format::Png, "{format:?} cut at {end} of {}", whole.len());
            }
            let limits = Limits { pixels: 1 << 20, ..Limits::default() };
            for at in 0..whole.len() {
                for flip in [0x01, 0x80, 0xff] {
                    let mut damaged = whole.clone();
                    damaged[at] ^= flip;
                    let _ = decode_stored(&damaged, Path::new("damaged"), &ReadOptions { limits, linear: false });
                }
            }
        }
    }

    #[test]
    fn what_is_no_picture_or_no_file_is_named_so() {
        let error = read(file(b"<svg>").path(), &ReadOptions::default()).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert_eq!(read(Path::new("/nowhere/a.png"), &ReadOptions::default()).unwrap_err().exit_code(), 3);
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(read(folder.path(), &ReadOptions::default()).unwrap_err().exit_code(), 2);
    }
}
