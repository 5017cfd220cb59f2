//! Logical lines of a model file: any line ending; a trailing `\` joins the next line.

use std::borrow::Cow;

/// Text of a statement and the number of its first line, from 1.
pub(super) type Line<'t> = (u32, Cow<'t, str>);

/// Iterator over logical lines. LF, CR and CR LF all end a line.
pub(super) struct Lines<'t> {
    rest: &'t str,
    number: u32,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { rest: text.strip_prefix('\u{feff}').unwrap_or(text), number: 0 }
    }

    /// Returns the next physical line.
    fn physical(&mut self) -> Option<&'t str> {
        if self.rest.is_empty() {
            return None;
        }
        self.number = self.number.saturating_add(1);
        let bytes = self.rest.as_bytes();
        let end = bytes.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(bytes.len());
        let line = &self.rest[..end];
        let skip = if bytes[end..].starts_with(b"\r\n") { 2 } else { 1 };
        self.rest = self.rest.get(end + skip..).unwrap_or("");
        Some(line)
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = Line<'t>;

    fn next(&mut self) -> Option<Line<'t>> {
        let first = self.physical()?;
        let number = self.number;
        let Some(head) = continued(first) else { return Some((number, Cow::Borrowed(first))) };
        let mut joined = head.to_owned();
        while let Some(next) = self.physical() {
            joined.push(' ');
            match continued(next) {
                Some(part) => joined.push_str(part),
                None => {
                    joined.push_str(next);
                    break;
                }
            }
        }
        Some((number, Cow::Owned(joined)))
    }
}

/// Returns the line without its trailing `\`, if it has one. A comment is never continued.
fn continued(line: &str) -> Option<&str> {
    if line.trim_start().starts_with('#') { None } else { line.trim_end().strip_suffix('\\') }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> Vec<(u32, String)> {
        Lines::new(text).map(|(n, l)| (n, l.into_owned())).collect()
    }

    #[test]
    fn every_line_ending_ends_a_line_and_counts_once() {
        let expected = vec![(1, "a".to_owned()), (2, "b".to_owned()), (3, String::new()), (4, "c".to_owned())];
        assert_eq!(split("a\nb\n\nc"), expected);
        assert_eq!(split("a\rb\r\rc\r"), expected);
        assert_eq!(split("\u{feff}a\r\nb\r\n\r\nc\r\n"), expected);
    }

    #[test]
    fn a_backslash_joins_lines_and_keeps_the_first_number() {
        assert_eq!(split("f 1 \\\n2 \\\r\n3\nv"), [(1, "f 1  2  3".to_owned()), (4, "v".to_owned())]);
        assert_eq!(split("f \\"), [(1, "f ".to_owned())]);
        assert_eq!(split("# dir\\\nv"), [(1, "# dir\\".to_owned()), (2, "v".to_owned())]);
    }
}
