//! Corners of faces: `v`, `v/vt`, `v//vn` or `v/vt/vn`.

/// Cure for a model that exceeds the available memory.
pub(super) const CURE: &str = "take a smaller model";

/// Index of a missing attribute.
pub(super) const NONE: u32 = u32::MAX;

/// Corner of a face: indices of its position, texture coordinate and normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Corner {
    pub v: u32,
    pub vt: u32,
    pub vn: u32,
}

impl Corner {
    /// Returns the place of an index.
    #[inline]
    pub(super) fn field(&mut self, field: Field) -> &mut u32 {
        match field {
            Field::Vertex => &mut self.v,
            Field::Uv => &mut self.vt,
            Field::Normal => &mut self.vn,
        }
    }
}

/// Face of the file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Face {
    pub line: u32,
    /// Corners, as a range of the list of corners.
    pub first: u32,
    pub count: u32,
    /// Index into the list of names.
    pub material: u32,
    /// Smoothing group; 0 for none.
    pub smooth: u32,
}

/// Attribute that a corner points at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Field {
    #[default]
    Vertex,
    Uv,
    Normal,
}

impl Field {
    pub(super) const ALL: [Self; 3] = [Self::Vertex, Self::Uv, Self::Normal];

    /// Returns its name in messages.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Uv => "texture coordinate",
            Self::Normal => "normal",
        }
    }

    /// Returns the warning about an index that cannot be used.
    pub(super) fn unusable(self) -> &'static str {
        match self {
            Self::Vertex => "faces that point at a vertex which the file does not have are left out",
            Self::Uv => "texture coordinates that the file does not have are left out of their faces",
            Self::Normal => "normals that the file does not have are left out of their faces",
        }
    }
}

/// Index as written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Index {
    Missing,
    /// Place from 0.
    Forward(u32),
    /// Number of places back from the next one.
    Backward(u32),
    /// Reason for which it is none.
    Wrong(&'static str),
}

/// Parses the three indices of a corner. Returns true beside them if more follow.
#[inline]
pub(super) fn parse(word: &[u8]) -> ([Index; 3], bool) {
    let mut parts = [Index::Missing; 3];
    let mut rest = Some(word);
    for part in &mut parts {
        let Some(text) = rest else { break };
        match text.iter().position(|&b| b == b'/') {
            Some(at) => {
                *part = index(&text[..at]);
                rest = Some(&text[at + 1..]);
            }
            None => {
                *part = index(text);
                rest = None;
            }
        }
    }
    (parts, rest.is_some())
}

/// Parses an index: from 1, or from -1 backwards.
#[inline]
fn index(text: &[u8]) -> Index {
    let (negative, digits) = match text {
        [] => return Index::Missing,
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
        return whole_number(text);
    }
    let mut value = 0_u64;
    for &digit in digits {
        value = value.saturating_mul(10).saturating_add(u64::from(digit - b'0'));
    }
    placed(negative, value)
}

fn placed(negative: bool, value: u64) -> Index {
    match (negative, value) {
        (_, 0) => Index::Wrong("0 does not exist; they count from 1"),
        (false, 1..=0x7fff_ffff) => Index::Forward(value as u32 - 1),
        (true, 1..=0x3fff_ffff) => Index::Backward(value as u32),
        _ => Index::Wrong("of that number is out of range"),
    }
}

/// Reads an index written with a point, such as `3.0`.
#[cold]
fn whole_number(text: &[u8]) -> Index {
    let number = std::str::from_utf8(text).ok().and_then(|t| t.parse::<f64>().ok());
    match number.filter(|x| x.fract() == 0.0 && x.abs() < 2e9) {
        Some(x) => placed(x < 0.0, x.abs() as u64),
        None => Index::Wrong("is no index"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_told_apart() {
        use Index::{Backward, Forward, Missing, Wrong};
        assert_eq!(parse(b"1/2/3"), ([Forward(0), Forward(1), Forward(2)], false));
        assert_eq!(parse(b"4//-6"), ([Forward(3), Missing, Backward(6)], false));
        assert_eq!(parse(b"1/2"), ([Forward(0), Forward(1), Missing], false));
        assert_eq!(parse(b"1/"), ([Forward(0), Missing, Missing], false));
        assert_eq!(parse(b"2.0"), ([Forward(1), Missing, Missing], false));
        assert!(parse(b"1/2/3/4").1);
        for bad in [&b"0"[..], b"x", b"99999999999999999999", b"-9223372036854775808", b"-", b"1.5"] {
            assert!(matches!(parse(bad).0[0], Wrong(_)), "{bad:?}");
        }
    }
}
