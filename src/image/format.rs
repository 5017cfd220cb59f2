//! Picture file formats.

use std::path::Path;

use super::encode::Clipped;
use super::film::Film;
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

/// Encoded picture file.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// Bytes of the whole file.
    pub bytes: Vec<u8>,
    /// Samples that the format could not represent.
    pub clipped: Clipped,
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
