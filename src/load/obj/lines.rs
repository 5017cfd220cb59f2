//! Logical lines of a model file: any line ending; a trailing `\` joins the next line. Division of a file into blocks of
//! whole lines.

use std::borrow::Cow;

/// Text of a statement and the number of its first line, from 1.
pub(super) type Line<'t> = (u32, Cow<'t, [u8]>);

/// Iterator over logical lines. LF, CR and CR LF all end a line.
pub(super) struct Lines<'t> {
    rest: &'t [u8],
    number: u32,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t [u8]) -> Self {
        Self { rest: text, number: 0 }
    }

    /// Returns the number of lines read so far.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// Returns the next physical line.
    #[inline]
    fn physical(&mut self) -> Option<&'t [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number = self.number.saturating_add(1);
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        let skip = if self.rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
        self.rest = self.rest.get(end + skip..).unwrap_or_default();
        Some(line)
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = Line<'t>;

    #[inline]
    fn next(&mut self) -> Option<Line<'t>> {
        let first = self.physical()?;
        let number = self.number;
        let Some(head) = continued(first) else { return Some((number, Cow::Borrowed(first))) };
        let mut joined = head.to_owned();
        while let Some(next) = self.physical() {
            joined.push(b' ');
            match continued(next) {
                Some(part) => joined.extend_from_slice(part),
                None => {
                    joined.extend_from_slice(next);
                    break;
                }
            }
        }
        Some((number, Cow::Owned(joined)))
    }
}

/// Returns the line without its trailing `\`, if it has one. A comment is never continued, and neither is a name: folders
/// of Windows and some characters of Shift-JIS end in this byte.
#[inline]
fn continued(line: &[u8]) -> Option<&[u8]> {
    let head = line.trim_ascii_end().strip_suffix(b"\\")?;
    let start = line.trim_ascii_start();
    let keyword = start.split(u8::is_ascii_whitespace).next().unwrap_or_default().to_ascii_lowercase();
    let named =
        matches!(keyword.as_slice(), b"o" | b"g" | b"usemtl" | b"mtllib" | b"newmtl" | b"bump" | b"norm" | b"refl");
    if start.starts_with(b"#") || named || keyword.starts_with(b"map_") { None } else { Some(head) }
}

/// Divides a text into blocks of about `size` bytes, each of whole logical lines.
pub(super) fn blocks(text: &[u8], size: usize) -> Vec<&[u8]> {
    let mut blocks = Vec::new();
    let mut rest = text;
    while rest.len() > size {
        let mut end = size;
        // Ends behind a line ending that no `\` precedes.
        let cut = loop {
            let Some(at) = rest[end..].iter().position(|&b| b == b'\n' || b == b'\r') else { break rest.len() };
            let line_end = end + at;
            end = line_end + if rest[line_end..].starts_with(b"\r\n") { 2 } else { 1 };
            if !rest[..line_end].trim_ascii_end().ends_with(b"\\") || end >= rest.len() {
                break end.min(rest.len());
            }
        };
        let (block, behind) = rest.split_at(cut);
        blocks.push(block);
        rest = behind;
    }
    if !rest.is_empty() {
        blocks.push(rest);
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> Vec<(u32, String)> {
        Lines::new(text.as_bytes()).map(|(n, l)| (n, String::from_utf8(l.into_owned()).unwrap())).collect()
    }

    #[test]
    fn every_line_ending_ends_a_line_and_counts_once() {
        let expected = vec![(1, "a".to_owned()), (2, "b".to_owned()), (3, String::new()), (4, "c".to_owned())];
        assert_eq!(split("a\nb\n\nc"), expected);
        assert_eq!(split("a\rb\r\rc\r"), expected);
        assert_eq!(split("a\r\nb\r\n\r\nc\r\n"), expected);
    }

    #[test]
    fn a_backslash_joins_lines_and_keeps_the_first_number() {
        assert_eq!(split("f 1 \\\n2 \\\r\n3\nv"), [(1, "f 1  2  3".to_owned()), (4, "v".to_owned())]);
        assert_eq!(split("f \\"), [(1, "f ".to_owned())]);
        assert_eq!(split("# dir\\\nv"), [(1, "# dir\\".to_owned()), (2, "v".to_owned())]);
        assert_eq!(split("usemtl red\\\nv"), [(1, "usemtl red\\".to_owned()), (2, "v".to_owned())]);
    }

    #[test]
    fn blocks_hold_the_same_lines_as_the_whole_whatever_their_size() {
        for text in ["v 1\nv 2 \\\n3\n\nf 1\n", "a\rb\\\rc\r\rd", "a\r\nb \\\r\nc\r\nd\r\n", "\\\n\\\n\\", "", "\n"] {
            for size in 1..12 {
                let parts = blocks(text.as_bytes(), size);
                assert_eq!(parts.concat(), text.as_bytes());
                let mut before = 0;
                let mut lines = Vec::new();
                for part in parts {
                    let mut reader = Lines::new(part);
                    lines
                        .extend(reader.by_ref().map(|(n, l)| (before + n, String::from_utf8(l.into_owned()).unwrap())));
                    before += reader.number();
                }
                assert_eq!(lines, split(text), "{text:?} {size}");
            }
        }
    }
}
