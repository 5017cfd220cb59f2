//! Formats of which `image` decodes all: JPEG, BMP, TGA, TIFF, GIF, WebP, PNM, QOI and Radiance HDR.

use std::io::Cursor;

use ::image::{DynamicImage, ImageFormat, ImageReader};

use super::samples::{Samples, Stored, code_of_16, code_of_share, light_of_codes, transfer};

/// Returns the format of a file by its first bytes, with its name. TGA has none and is told by its header.
pub(super) fn format_of(bytes: &[u8]) -> Option<(ImageFormat, &'static str)> {
    Some(match bytes {
        [b'#', b'?', ..] => (ImageFormat::Hdr, "Radiance HDR picture"),
        [0xff, 0xd8, ..] => (ImageFormat::Jpeg, "JPEG"),
        [b'B', b'M', ..] => (ImageFormat::Bmp, "BMP"),
        [b'G', b'I', b'F', b'8', ..] => (ImageFormat::Gif, "GIF"),
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => (ImageFormat::Tiff, "TIFF"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => (ImageFormat::WebP, "WebP"),
        [b'P', b'1'..=b'7', ..] => (ImageFormat::Pnm, "PNM"),
        [b'q', b'o', b'i', b'f', ..] => (ImageFormat::Qoi, "QOI"),
        _ if looks_like_tga(bytes) => (ImageFormat::Tga, "TGA"),
        _ => return None,
    })
}

/// Returns true if the 18 bytes of a TGA header hold values that the format allows.
fn looks_like_tga(bytes: &[u8]) -> bool {
    let [_, mapped @ 0..=1, kind, .., w0, w1, h0, h1, depth, _] = bytes.get(..18).unwrap_or_default() else {
        return false;
    };
    let plausible = match kind {
        1 | 9 => *mapped == 1 && *depth == 8,
        2 | 10 => matches!(depth, 15 | 16 | 24 | 32),
        3 | 11 => matches!(depth, 8 | 16),
        _ => false,
    };
    plausible && (*w0 | *w1) != 0 && (*h0 | *h1) != 0
}

/// Returns the name of a format that is known but not decoded, with the cure.
pub(super) fn undecoded(bytes: &[u8]) -> Option<&'static str> {
    Some(match bytes {
        [b'D', b'D', b'S', b' ', ..] => "a DDS picture, made for graphics cards; convert it to PNG",
        [0xab, b'K', b'T', b'X', b' ', ..] => "a KTX picture, made for graphics cards; convert it to PNG",
        [b'8', b'B', b'P', b'S', ..] => "a Photoshop document; export it as PNG",
        [0, 0, 0, _, b'f', b't', b'y', b'p', ..] => "an AVIF or HEIF picture; convert it to PNG",
        [b'<', b's', b'v', b'g', ..] => "no picture of a kind that is read: an SVG drawing; convert it to PNG",
        _ => return None,
    })
}

/// Returns columns and rows.
pub(super) fn dimensions(bytes: &[u8], format: ImageFormat) -> Result<(u32, u32), String> {
    ImageReader::with_format(Cursor::new(bytes), format).into_dimensions().map_err(|e| e.to_string())
}

/// Returns the peak bytes per pixel during decoding: for JPEG codes, 16-bit coefficients and planes; elsewhere up to
/// four channels of 32 bits twice, and the result.
pub(super) fn bytes_a_pixel(format: ImageFormat) -> u64 {
    match format {
        ImageFormat::Jpeg => 12 + 3 + 6 + 6,
        _ => 2 * 16 + 12,
    }
}

/// Returns the smallest length of a file of this size.
pub(super) fn shortest(format: ImageFormat, (width, height): (u32, u32)) -> u64 {
    let pixels = u64::from(width) * u64::from(height);
    match format {
        // A row takes at least four bytes: one pixel, or the header of a packed row.
        ImageFormat::Hdr => 4 * u64::from(height),
        // A run is at most 62 pixels in QOI, 128 in TGA, 255 in BMP.
        ImageFormat::Qoi => pixels / 62,
        ImageFormat::Tga => pixels / 128,
        ImageFormat::Bmp => pixels / 256,
        ImageFormat::Pnm => pixels / 8,
        _ => 0,
    }
}

/// Decodes a picture of at most `edge` pixels along each side and `pixels` in all. Codes are sRGB, or light itself if `linear`; floating-point samples always are light.
pub(super) fn decode(
    bytes: &[u8],
    format: ImageFormat,
    (edge, pixels): (u32, u64),
    linear: bool,
) -> Result<Stored, String> {
    // `ImageReader` is the only interface of `image` that respects its limits.
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut own = ::image::Limits::default();
    own.max_image_width = Some(edge);
    own.max_image_height = Some(edge);
    own.max_alloc = Some(pixels.saturating_mul(16));
    reader.limits(own);
    let picture = reader.decode().map_err(|e| e.to_string())?;
    let size = (picture.width(), picture.height());
    let transfer = transfer(linear);
    let table = || light_of_codes(transfer);
    let (samples, alpha) = match picture {
        DynamicImage::ImageLuma8(grey) => (Samples::Grey { codes: grey.into_raw(), light: table() }, None),
        DynamicImage::ImageLumaA8(grey) => {
            let (codes, alpha) = grey.as_raw().as_chunks::<2>().0.iter().map(|p| (p[0], p[1])).unzip();
            (Samples::Grey { codes, light: table() }, Some(alpha))
        }
        DynamicImage::ImageRgb8(colour) => {
            let codes = colour.as_raw().as_chunks::<3>().0.to_vec();
            (Samples::Codes { codes, light: table() }, None)
        }
        DynamicImage::ImageRgba8(colour) => {
            let (codes, alpha) = colour.as_raw().as_chunks::<4>().0.iter().map(|p| ([p[0], p[1], p[2]], p[3])).unzip();
            (Samples::Codes { codes, light: table() }, Some(alpha))
        }
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let rgba = picture.into_rgba32f();
            let pixels = rgba.pixels().map(|p| [p.0[0], p.0[1], p.0[2]]).collect();
            (Samples::Light(pixels), Some(rgba.pixels().map(|p| code_of_share(p.0[3])).collect()))
        }
        deep => {
            let rgba = deep.into_rgba16();
            let light: Vec<f32> = (0..=u16::MAX).map(|code| transfer(f64::from(code) / 65_535.0) as f32).collect();
            let of = |code: u16| light[usize::from(code)];
            let pixels = rgba.pixels().map(|p| [of(p.0[0]), of(p.0[1]), of(p.0[2])]).collect();
            (Samples::Light(pixels), Some(rgba.pixels().map(|p| code_of_16(p.0[3])).collect()))
        }
    };
    Ok(Stored::new(size, samples, alpha))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_their_first_bytes_and_tga_by_its_header() {
        let name = |bytes: &[u8]| format_of(bytes).map(|f| f.1);
        assert_eq!(name(b"BM\x00\x00"), Some("BMP"));
        assert_eq!(name(b"GIF89a"), Some("GIF"));
        assert_eq!(name(b"RIFF\x01\x02\x03\x04WEBPVP8 "), Some("WebP"));
        assert_eq!(name(b"P6\n2 2\n255\n"), Some("PNM"));
        assert_eq!(name(&[0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 4, 0, 24, 32]), Some("TGA"));
        assert_eq!(name(&[0; 18]), None);
        assert_eq!(name(b""), None);
        assert!(undecoded(b"DDS |\0\0\0").is_some_and(|why| why.contains("DDS")));
    }

    #[test]
    fn a_float_tiff_is_light_and_an_eight_bit_one_is_srgb() {
        let mut bytes = Cursor::new(Vec::new());
        let float = ::image::Rgb32FImage::from_pixel(1, 1, ::image::Rgb([0.5, 4.0, 0.0]));
        DynamicImage::ImageRgb32F(float).write_to(&mut bytes, ImageFormat::Tiff).unwrap();
        let film = decode(bytes.get_ref(), ImageFormat::Tiff, (9, 99), false).unwrap().into_film();
        assert_eq!(film.pixels, [[0.5, 4.0, 0.0]]);
        let mut bytes = Cursor::new(Vec::new());
        let codes = ::image::RgbaImage::from_pixel(1, 1, ::image::Rgba([188, 0, 255, 51]));
        DynamicImage::ImageRgba8(codes).write_to(&mut bytes, ImageFormat::Tiff).unwrap();
        let stored = decode(bytes.get_ref(), ImageFormat::Tiff, (9, 99), false).unwrap();
        assert_eq!(stored.alpha, Some(vec![51]));
        let film = stored.into_film();
        assert!((film.pixels[0][0] - 0.5029).abs() < 1e-4 && film.pixels[0][2] == 1.0);
    }
}
