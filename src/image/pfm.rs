//! Portable float maps: a text header, then binary32 rows from the bottom up.

use super::encode::Clipped;
use super::film::Film;
use super::format::Encoded;

/// Encodes a film in colour, little-endian, with scale 1.
pub(super) fn encode(film: &Film) -> Encoded {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", film.width, film.height).into_bytes();
    bytes.reserve(film.pixels.len() * 12);
    let mut clipped = Clipped::default();
    for row in film.pixels.chunks_exact(film.width as usize).rev() {
        for &x in row.as_flattened() {
            clipped.note(x);
            bytes.extend_from_slice(&x.to_le_bytes());
        }
    }
    Encoded { bytes, clipped }
}

/// Parsed header.
pub(super) struct Header {
    pub width: u32,
    pub height: u32,
    channels: usize,
    /// Factor on all samples; a negative sign means little-endian.
    scale: f32,
    data: usize,
}

/// Parses the header: `PF` (colour) or `Pf` (grey), width, height and scale, separated by white space, with one
/// white-space character before the data.
pub(super) fn header(bytes: &[u8]) -> Result<Header, String> {
    let mut at = 0;
    let mut word = || {
        while bytes.get(at).is_some_and(u8::is_ascii_whitespace) {
            at += 1;
        }
        let start = at;
        while bytes.get(at).is_some_and(|b| !b.is_ascii_whitespace()) && at - start < 32 {
            at += 1;
        }
        let word = std::str::from_utf8(&bytes[start..at]).unwrap_or_default();
        // One white-space character belongs to each word, so the data begin after the last one.
        at = bytes.len().min(at + 1);
        (word, at)
    };
    let channels = match word().0 {
        "PF" => 3,
        "Pf" => 1,
        other => return Err(format!("its first word is `{}`, not PF or Pf", other.escape_default())),
    };
    let mut size = |what| {
        let text = word().0;
        text.parse::<u32>().map_err(|_| format!("its {what} is `{}`, not a whole number", text.escape_default()))
    };
    let (width, height) = (size("width")?, size("height")?);
    let (text, data) = word();
    let scale: f32 = text.parse().unwrap_or(f32::NAN);
    if !(scale.is_finite() && scale != 0.0) {
        return Err(format!("its scale is `{}`, not a number other than 0", text.escape_default()));
    }
    Ok(Header { width, height, channels, scale, data })
}

/// Decodes the picture after a header whose size has been accepted.
pub(super) fn decode(bytes: &[u8], header: &Header) -> Result<Film, String> {
    let (width, height) = (header.width as usize, header.height as usize);
    let row_bytes = width * header.channels * 4;
    let (needed, there) = (row_bytes * height, bytes.len() - header.data);
    if there < needed {
        return Err(format!("it ends early: {needed} bytes of samples are announced, {there} are there"));
    }
    let (little, factor) = (header.scale < 0.0, header.scale.abs());
    let number = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        factor * if little { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let rows = bytes[header.data..header.data + needed].chunks_exact(row_bytes).rev();
    let mut pixels = Vec::with_capacity(width * height);
    pixels.extend(rows.flat_map(|row| row.chunks_exact(4 * header.channels)).map(|p| match header.channels {
        1 => [number(p); 3],
        _ => [number(&p[0..4]), number(&p[4..8]), number(&p[8..12])],
    }));
    Ok(Film { width: header.width, height: header.height, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Case AC-07 of the catalogue.
    #[test]
    fn rows_run_from_the_bottom_and_either_byte_order_is_read() {
        let mut big = b"PF 1 2\n2.0\n".to_vec();
        for x in [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0] {
            big.extend_from_slice(&x.to_be_bytes());
        }
        let film = decode(&big, &header(&big).unwrap()).unwrap();
        assert_eq!(film.at(0, 0), [8.0, 10.0, 12.0]);
        assert_eq!(film.at(0, 1), [2.0, 4.0, 6.0]);
    }

    #[test]
    fn grey_is_read_as_three_equal_channels() {
        let mut grey = b"Pf\n2 1\n-1\n".to_vec();
        grey.extend_from_slice(&0.25_f32.to_le_bytes());
        grey.extend_from_slice(&0.5_f32.to_le_bytes());
        let film = decode(&grey, &header(&grey).unwrap()).unwrap();
        assert_eq!(film.pixels, [[0.25; 3], [0.5; 3]]);
    }

    #[test]
    fn a_broken_header_is_refused() {
        for text in ["", "P6 1 1 255 ", "PF", "PF -1 1 1 ", "PF 1 1 0 ", "PF 1 1 nan ", "PF 1 1 inf ", "PF 1.5 1 1 "] {
            assert!(header(text.as_bytes()).is_err(), "{text}");
        }
        let short = b"PF 2 2 -1 \0\0\0\0";
        assert!(decode(short, &header(short).unwrap()).is_err());
    }
}
