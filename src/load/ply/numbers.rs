//! The numbers after a PLY header, in any encoding, read one entry at a time.

use super::header::{Encoding, Header, Number, Property};

/// Reader of numbers; it ends where the file does.
pub(super) struct Numbers<'a> {
    encoding: Encoding,
    rest: &'a [u8],
    /// Line that is read, from 1, in an ASCII file; 0 in a binary one.
    pub line: u32,
    /// Line of the first word of an ASCII file that is no number.
    pub no_number: Option<u32>,
}

/// Values of an entry: single numbers by property, and lists in one row.
#[derive(Debug, Default)]
pub(super) struct Entry {
    /// Number of each property; for a list the number of its values.
    pub singles: Vec<f64>,
    /// Values of all wanted lists, one after another.
    pub lists: Vec<f64>,
}

impl<'a> Numbers<'a> {
    /// Starts after the header.
    pub(super) fn new(file: &'a [u8], header: &Header) -> Self {
        let line = if header.encoding == Encoding::Ascii { header.lines + 1 } else { 0 };
        Self { encoding: header.encoding, rest: &file[header.bytes..], line, no_number: None }
    }

    /// Reads an entry, of whose lists `wanted` returns true for those to keep. Returns `None` if the file ends first.
    pub(super) fn entry(
        &mut self,
        properties: &[Property],
        wanted: impl Fn(usize) -> bool,
        entry: &mut Entry,
    ) -> Option<()> {
        entry.singles.clear();
        entry.lists.clear();
        for (i, property) in properties.iter().enumerate() {
            let Some(count) = property.count else {
                entry.singles.push(self.number(property.number)?);
                continue;
            };
            let count = self.number(count)?;
            // A count that is no number leaves no way to find what follows.
            let count = if count >= 0.0 { count as usize } else { return None };
            entry.singles.push(count as f64);
            if self.encoding == Encoding::Ascii || wanted(i) {
                for _ in 0..count {
                    let number = self.number(property.number)?;
                    if wanted(i) {
                        entry.lists.push(number);
                    }
                }
            } else {
                self.rest = self.rest.get(count.checked_mul(property.number.bytes())?..)?;
            }
        }
        if self.encoding == Encoding::Ascii {
            self.end_line();
        }
        Some(())
    }

    fn number(&mut self, number: Number) -> Option<f64> {
        if self.encoding == Encoding::Ascii {
            let word = self.word()?;
            let value = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
            if value.is_none() {
                self.no_number.get_or_insert(self.line);
            }
            return Some(value.unwrap_or(f64::NAN));
        }
        let (bytes, rest) = self.rest.split_at_checked(number.bytes())?;
        self.rest = rest;
        let mut first = [0; 8];
        // In the order of the little end.
        first[..bytes.len()].copy_from_slice(bytes);
        if self.encoding == Encoding::BigEndian {
            first[..bytes.len()].reverse();
        }
        let [a, b, c, d, ..] = first;
        Some(match number {
            Number::I8 => f64::from(a as i8),
            Number::U8 => f64::from(a),
            Number::I16 => f64::from(i16::from_le_bytes([a, b])),
            Number::U16 => f64::from(u16::from_le_bytes([a, b])),
            Number::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Number::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Number::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Number::F64 => f64::from_le_bytes(first),
        })
    }

    /// Returns the next word, on this line or a later one.
    fn word(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        self.line += self.rest[..start].iter().filter(|&&b| b == b'\n').count() as u32;
        let rest = &self.rest[start..];
        let (word, rest) = rest.split_at(rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len()));
        self.rest = rest;
        Some(word)
    }

    /// Leaves out the rest of the line.
    fn end_line(&mut self) {
        let length = self.rest.iter().position(|&b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
        self.rest = &self.rest[length..];
    }
}
