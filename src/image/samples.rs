//! Pixels of a picture file in its own depth, with its alpha channel.

use super::encode::linear_from_srgb;
use super::film::Film;

/// Colours of a picture.
#[derive(Clone, Debug)]
pub enum Samples {
    /// Linear light.
    Light(Vec<[f32; 3]>),
    /// Codes of 8 bits for red, green and blue, with the light of each code.
    Codes {
        /// Codes, row by row.
        codes: Vec<[u8; 3]>,
        /// Light of each code.
        light: Box<[f32; 256]>,
    },
    /// Codes of 8 bits for all channels alike, with the light of each code.
    Grey {
        /// Codes, row by row.
        codes: Vec<u8>,
        /// Light of each code.
        light: Box<[f32; 256]>,
    },
}

/// Picture as stored in its file.
#[derive(Clone, Debug)]
pub struct Stored {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Colours, not multiplied by alpha.
    pub samples: Samples,
    /// Coverage of each pixel, from 0 to 255, if the file has an alpha channel that is not opaque everywhere.
    pub alpha: Option<Vec<u8>>,
}

impl Stored {
    /// Creates a picture; an alpha channel that is opaque everywhere is left out.
    pub(super) fn new((width, height): (u32, u32), samples: Samples, alpha: Option<Vec<u8>>) -> Self {
        Self { width, height, samples, alpha: alpha.filter(|alpha| alpha.iter().any(|&a| a != 255)) }
    }

    /// Returns the colours as a film.
    #[must_use]
    pub fn into_film(self) -> Film {
        let pixels = match self.samples {
            Samples::Light(pixels) => pixels,
            Samples::Codes { codes, light } => codes.iter().map(|c| c.map(|code| light[usize::from(code)])).collect(),
            Samples::Grey { codes, light } => codes.iter().map(|&code| [light[usize::from(code)]; 3]).collect(),
        };
        Film { width: self.width, height: self.height, pixels }
    }
}

impl From<Film> for Stored {
    fn from(film: Film) -> Self {
        Self::new((film.width, film.height), Samples::Light(film.pixels), None)
    }
}

/// Returns the light of each code of 8 bits: `transfer` of its share of 255.
pub(super) fn light_of_codes(transfer: impl Fn(f64) -> f64) -> Box<[f32; 256]> {
    Box::new(std::array::from_fn(|code| transfer(code as f64 / 255.0) as f32))
}

/// Returns the transfer function of codes: sRGB, or none if `linear`.
pub(super) fn transfer(linear: bool) -> fn(f64) -> f64 {
    if linear { |x| x } else { linear_from_srgb }
}

/// Returns the nearest code of 8 bits.
pub(super) fn code_of_16(code: u16) -> u8 {
    ((u32::from(code) * 255 + 32_767) / 65_535) as u8
}

/// Returns the nearest code of 8 bits for a share; 0 for a number that is none.
pub(super) fn code_of_share(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}
