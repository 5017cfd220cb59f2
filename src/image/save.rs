//! A film to a file in one call.

use std::path::Path;

use super::file::{Encoding, encode};
use super::film::Film;
use super::format::{Bits, Format};
use super::write::Destination;
use crate::Result;

/// Writes a film to a file: 8-bit sRGB as `.png`, linear as `.exr`, `.hdr` or `.pfm`, by the extension of `path`.
///
/// The file is whole or absent. [`encode`] and [`Destination`] have more choices.
///
/// # Errors
/// Usage, for another extension; limit, for a film that the format cannot hold; input and output, where the file cannot be
/// written.
pub fn save(film: &Film, path: &Path) -> Result<()> {
    let encoding = Encoding { format: Format::from_path(path)?, bits: Bits::Eight, metadata: Vec::new() };
    Destination::new(path)?.write(&encode(film, &encoding)?.bytes, || true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{ReadOptions, read};

    #[test]
    fn a_saved_film_is_read_back_and_an_unknown_extension_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut film = Film::new(2, 1);
        film.pixels[1] = [0.25, 2.0, 0.0];
        let path = folder.path().join("a.pfm");
        save(&film, &path).unwrap();
        assert_eq!(read(&path, &ReadOptions::default()).unwrap().film, film);
        assert_eq!(save(&film, &folder.path().join("a.bmp")).unwrap_err().exit_code(), 2);
    }
}
