//! PNG files: sRGB codes of 8 or 16 bits, with settings in text chunks.

use ::png::{BitDepth, ColorType, Compression, Decoder, Encoder, Info, SrgbRenderingIntent, Transformations};

use super::encode::{Clipped, linear_from_srgb};
use super::film::Film;
use super::format::{Bits, Encoded, Format, cannot_hold};
use super::samples::{Samples, Stored, code_of_16, light_of_codes};
use crate::Result;

/// Encodes a film as RGB without alpha, marked as sRGB.
pub(super) fn encode(film: &Film, bits: Bits, metadata: &[(String, String)]) -> Result<Encoded> {
    let mut clipped = Clipped::default();
    let samples = film.pixels.as_flattened();
    let (depth, codes): (_, Vec<u8>) = match bits {
        Bits::Eight => (BitDepth::Eight, samples.iter().map(|&x| clipped.code(x, 255) as u8).collect()),
        Bits::Sixteen => {
            (BitDepth::Sixteen, samples.iter().flat_map(|&x| clipped.code(x, 65535).to_be_bytes()).collect())
        }
    };
    let mut bytes = Vec::new();
    let mut write = || -> std::result::Result<(), ::png::EncodingError> {
        let mut encoder = Encoder::new(&mut bytes, film.width, film.height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(depth);
        encoder.set_compression(Compression::Balanced);
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        for (name, value) in metadata {
            // tEXt is Latin-1 in the standard but ASCII in practice; iTXt is UTF-8.
            if value.is_ascii() {
                encoder.add_text_chunk(name.clone(), value.clone())?;
            } else {
                encoder.add_itxt_chunk(name.clone(), value.clone())?;
            }
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&codes)?;
        writer.finish()
    };
    write().map_err(|e| cannot_hold(film, Format::Png, e))?;
    Ok(Encoded { bytes, clipped })
}

/// Open PNG whose header has been read, so that its size can be checked before decoding.
pub(super) struct Header<'a> {
    reader: ::png::Reader<std::io::Cursor<&'a [u8]>>,
}

/// Reads the file up to the pixels.
pub(super) fn header(bytes: &[u8]) -> std::result::Result<Header<'_>, String> {
    let mut decoder = Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let reader = decoder.read_info().map_err(|e| e.to_string())?;
    Ok(Header { reader })
}

impl Header<'_> {
    /// Returns columns and rows.
    pub fn size(&self) -> (u32, u32) {
        (self.reader.info().width, self.reader.info().height)
    }

    /// Returns the peak bytes per pixel during decoding: codes and colour.
    pub fn bytes_a_pixel(&self) -> u64 {
        let (colour, depth) = self.reader.output_color_type();
        let codes = colour.samples() * if depth == BitDepth::Sixteen { 2 } else { 1 };
        (codes + size_of::<[f32; 3]>()) as u64
    }

    /// Returns the smallest possible length of a file of this size. Deflate compresses at most 1032 bytes into one.
    pub fn shortest(&self) -> u64 {
        let info = self.reader.info();
        let bits = u64::from(info.width) * info.bits_per_pixel() as u64;
        // Each row begins with a filter byte.
        u64::from(info.height) * (bits.div_ceil(8) + 1) / 1032
    }

    /// Decodes the pixels.
    pub fn decode(mut self, linear: bool) -> std::result::Result<Stored, String> {
        let size = self.size();
        let transfer = if linear { Transfer::Power(1.0) } else { Transfer::of(self.reader.info()) };
        let mut codes = vec![0; self.reader.output_buffer_size().ok_or("it is too large")?];
        let frame = self.reader.next_frame(&mut codes).map_err(|e| e.to_string())?;
        codes.truncate(frame.buffer_size());
        let channels = frame.color_type.samples();
        let colours = if channels < 3 { 1 } else { 3 };
        if frame.bit_depth == BitDepth::Sixteen {
            let light: Vec<f32> =
                (0..=u16::MAX).map(|code| transfer.linear(f64::from(code) / 65_535.0) as f32).collect();
            let pixels = codes.chunks_exact(2 * channels);
            let code = |p: &[u8], i: usize| u16::from_be_bytes([p[2 * i], p[2 * i + 1]]);
            let colour = |p: &[u8]| [0, 1, 2].map(|i| light[usize::from(code(p, i % colours))]);
            let alpha = (channels % 2 == 0).then(|| pixels.clone().map(|p| code_of_16(code(p, colours))).collect());
            return Ok(Stored::new(size, Samples::Light(pixels.map(colour).collect()), alpha));
        }
        let light = light_of_codes(|x| transfer.linear(x));
        let pixels = codes.chunks_exact(channels);
        let alpha = (channels % 2 == 0).then(|| pixels.clone().map(|p| p[colours]).collect());
        let samples = match channels {
            1 => Samples::Grey { codes, light },
            2 => Samples::Grey { codes: pixels.map(|p| p[0]).collect(), light },
            _ => Samples::Codes { codes: pixels.map(|p| [p[0], p[1], p[2]]).collect(), light },
        };
        Ok(Stored::new(size, samples, alpha))
    }
}

/// Transfer function from codes to light.
enum Transfer {
    Srgb,
    /// Light is the code raised to this power.
    Power(f64),
}

impl Transfer {
    /// Returns the transfer function that the chunks specify. An sRGB chunk or colour profile means sRGB (profiles are
    /// not evaluated). A lone gAMA chunk means its power, and no chunk means sRGB. gAMA 0.45455 is the standard's
    /// substitute for sRGB, and most programs that write it mean sRGB.
    fn of(info: &Info) -> Self {
        let gamma = info.gama_chunk.map(|g| g.into_scaled());
        match gamma {
            _ if info.srgb.is_some() || info.icc_profile.is_some() => Self::Srgb,
            None | Some(0 | 45_000..=46_000) => Self::Srgb,
            Some(scaled) => Self::Power(100_000.0 / f64::from(scaled)),
        }
    }

    fn linear(&self, x: f64) -> f64 {
        match *self {
            Self::Srgb => linear_from_srgb(x),
            Self::Power(1.0) => x,
            Self::Power(power) => x.powf(power),
        }
    }
}
