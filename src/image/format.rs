//! Picture file formats, and encoding of a film.

use std::path::Path;

use super::encode::Clipped;
use super::film::Film;
use super::{exr, hdr, pfm, png};
use crate::system::memory;
use crate::{Error, Result};

/// Picture file format for writing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// sRGB codes, 8 or 16 bits.
    Png,
    /// OpenEXR: linear binary32, losslessly packed.
    Exr,
    /// Radiance RGBE: linear, 8 bits per channel with a shared exponent, nothing below zero.
    Hdr,
    /// Portable float map: linear binary32, uncompressed.
    Pfm,
}

impl Format {
    /// Returns the format for the extension of a file name.
    ///
    /// # Errors
    /// Returns [`Error::Usage`] if the extension is missing or unknown.
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match extension.as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            "hdr" | "pic" => Ok(Self::Hdr),
            "pfm" => Ok(Self::Pfm),
            "" => Err(Error::Usage(format!(
                "{}: the name has no extension to tell the format by; end it in .png, .exr, .hdr or .pfm",
                path.display()
            ))),
            other => Err(Error::Usage(format!(
                "{}: cannot write `.{other}`; end the name in .png, .exr, .hdr or .pfm",
                path.display()
            ))),
        }
    }

    /// Returns the name used in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Exr => "OpenEXR",
            Self::Hdr => "Radiance HDR",
            Self::Pfm => "PFM",
        }
    }
}

crate::choice! {
    /// Bits of a PNG's samples.
    pub enum Bits("bits", derive(Eq, Hash), default(Eight)) {
        /// 8 bits a sample.
        "8" => Eight,
        /// 16 bits a sample.
        "16" => Sixteen,
    }
}

/// Options for writing a film.
#[derive(Clone, Debug)]
pub struct Encoding {
    /// File format.
    pub format: Format,
    /// Bits per sample; for PNG only.
    pub bits: Bits,
    /// Names and values to store in PNG (text chunks) and OpenEXR (attributes). Names are 1 to 79 printable ASCII
    /// characters.
    pub metadata: Vec<(String, String)>,
}

/// Encoded picture file.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// Bytes of the whole file.
    pub bytes: Vec<u8>,
    /// Samples that the format could not represent.
    pub clipped: Clipped,
}

/// Encodes `film` in a file format. The same film and encoding give the same bytes.
///
/// # Errors
/// - [`Error::Limit`] if the film is empty or too large for the format.
/// - [`Error::Usage`] for a metadata name that violates [`Encoding::metadata`].
pub fn encode(film: &Film, encoding: &Encoding) -> Result<Encoded> {
    if film.width == 0 || film.height == 0 || film.pixels.len() != film.width as usize * film.height as usize {
        return Err(Error::Limit(format!("a picture of {} by {} pixels cannot be written", film.width, film.height)));
    }
    for (name, _) in &encoding.metadata {
        if !(1..=79).contains(&name.len()) || !name.bytes().all(|b| b.is_ascii_graphic()) {
            return Err(Error::Usage(format!(
                "`{name}` cannot name metadata: 1 to 79 printable characters are allowed"
            )));
        }
    }
    // Peak bytes of codes and of the file, which grows by doubling.
    let each = match (encoding.format, encoding.bits) {
        (Format::Png, Bits::Eight) => 3 + 2 * 3,
        (Format::Png, Bits::Sixteen) => 6 + 2 * 6,
        (Format::Exr, _) => 2 * 12,
        (Format::Hdr, _) => 12 + 2 * 5,
        (Format::Pfm, _) => 12,
    };
    let what = format!("a {} file of {} by {} pixels", encoding.format.name(), film.width, film.height);
    memory::need(&what, (film.pixels.len() as u64).saturating_mul(each), "write fewer pixels")?;
    match encoding.format {
        Format::Png => png::encode(film, encoding.bits, &encoding.metadata),
        Format::Exr => exr::encode(film, &encoding.metadata),
        Format::Hdr => hdr::encode(film),
        Format::Pfm => Ok(pfm::encode(film)),
    }
}

/// Returns the limit error for a film that `format` cannot represent.
pub(super) fn cannot_hold(film: &Film, format: Format, why: impl std::fmt::Display) -> Error {
    Error::Limit(format!(
        "a picture of {} by {} pixels does not fit into {}: {why}",
        film.width,
        film.height,
        format.name()
    ))
}
