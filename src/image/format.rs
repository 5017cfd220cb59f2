//! File formats by name, and a film as the bytes of one of them.

use std::path::Path;

use super::{Clipped, Film, exr, hdr, pfm, png};
use crate::system::memory;
use crate::{Error, Result};

/// A picture file format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// sRGB codes, 8 or 16 bits.
    Png,
    /// OpenEXR: linear binary32, losslessly packed.
    Exr,
    /// Radiance RGBE: linear, 8 bits a channel under one exponent, nothing below zero.
    Hdr,
    /// Portable float map: linear binary32, plain.
    Pfm,
}

impl Format {
    /// The format that the file name's extension stands for.
    ///
    /// # Errors
    /// Usage, where there is no extension or an unknown one.
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

    /// The name in reports.
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

/// How a film is to be written.
#[derive(Clone, Debug)]
pub struct Encoding {
    /// The file format.
    pub format: Format,
    /// Sample depth; for PNG only.
    pub bits: Bits,
    /// Names and values kept in the file by PNG (text chunks) and OpenEXR (attributes). Names are 1 to 79 printable
    /// ASCII characters.
    pub metadata: Vec<(String, String)>,
}

/// A film as a file's bytes.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// The whole file.
    pub bytes: Vec<u8>,
    /// What the format could not hold.
    pub clipped: Clipped,
}

/// The bytes of `film` in a file format. The same film and encoding give the same bytes.
///
/// # Errors
/// A limit, where the film is empty or the format cannot hold its size; usage, for metadata names that are not
/// as [`Encoding::metadata`] says.
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
    // The most bytes of codes and of the file in a list that grows by doubling.
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

/// The limit error for a film that `format` cannot take.
pub(super) fn cannot_hold(film: &Film, format: Format, why: impl std::fmt::Display) -> Error {
    Error::Limit(format!(
        "a picture of {} by {} pixels does not fit into {}: {why}",
        film.width,
        film.height,
        format.name()
    ))
}
