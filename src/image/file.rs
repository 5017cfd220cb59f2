//! Encoding of a film in a picture file format.

use super::film::Film;
use super::format::{Bits, Encoded, Format};
use super::{exr, hdr, pfm, png};
use crate::system::memory;
use crate::{Error, Result};

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
