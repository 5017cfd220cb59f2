//! Bytes of a text file, and names in it. Names are bytes: files hold them in UTF-8, Latin-1, Shift-JIS, GBK and others.

use std::borrow::Cow;

use encoding_rs::{GB18030, SHIFT_JIS, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Returns the text without its byte order mark; UTF-16 with such a mark is converted to UTF-8.
pub(super) fn unmarked(bytes: &[u8]) -> Cow<'_, [u8]> {
    let converted = |encoding: &'static encoding_rs::Encoding, bytes| {
        Cow::Owned(encoding.decode_without_bom_handling(bytes).0.into_owned().into_bytes())
    };
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, rest @ ..] => converted(UTF_16LE, rest),
        [0xfe, 0xff, rest @ ..] => converted(UTF_16BE, rest),
        _ => Cow::Borrowed(bytes),
    }
}

/// Returns true if the file is UTF-16 with a byte order mark.
pub(super) fn is_utf16(bytes: &[u8]) -> bool {
    matches!(bytes, [0xff, 0xfe, ..] | [0xfe, 0xff, ..])
}

/// Returns a name as shown in messages: UTF-8, or else each byte as its character of Latin-1, so that different names
/// stay different.
pub(super) fn shown(name: &[u8]) -> String {
    match std::str::from_utf8(name) {
        Ok(text) => text.to_owned(),
        Err(_) => name.iter().map(|&b| char::from(b)).collect(),
    }
}

/// Returns the names in UTF-8 that the bytes may stand for, the likeliest first.
pub(super) fn decodings(name: &[u8]) -> Vec<String> {
    if let Ok(text) = std::str::from_utf8(name) {
        return vec![text.to_owned()];
    }
    let decoded =
        [WINDOWS_1252, SHIFT_JIS, GB18030].map(|e| e.decode_without_bom_handling_and_without_replacement(name));
    decoded.into_iter().flatten().map(Cow::into_owned).collect()
}

/// Returns the part without white space at its ends.
pub(super) fn trimmed(bytes: &[u8]) -> &[u8] {
    bytes.trim_ascii()
}

/// Returns the text up to a comment: a `#` at the start or after white space.
pub(super) fn without_comment(text: &[u8]) -> &[u8] {
    let mut from = 0;
    while let Some(at) = text[from..].iter().position(|&b| b == b'#') {
        let at = from + at;
        if at == 0 || text[at - 1].is_ascii_whitespace() {
            return &text[..at];
        }
        from = at + 1;
    }
    text
}

/// Returns the words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Returns enough of a text for a message, on one line.
pub(super) fn short(text: &[u8]) -> String {
    let text = shown(text);
    let mut out: String = text.chars().take(60).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if out.len() < text.len() {
        out.push_str("...");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_taken_off_and_utf16_becomes_utf8() {
        assert_eq!(&*unmarked(b"\xef\xbb\xbfv 1"), b"v 1");
        assert_eq!(&*unmarked(b"\xff\xfev\0 \x001\0"), b"v 1");
        assert_eq!(&*unmarked(b"\xfe\xff\0v\0 \x001"), b"v 1");
        assert_eq!(&*unmarked(b"v 1"), b"v 1");
    }

    #[test]
    fn a_comment_begins_at_a_word_and_not_within_one() {
        assert_eq!(without_comment(b"1.#QNAN0 2 # x"), b"1.#QNAN0 2 ");
        assert_eq!(without_comment(b"# all"), b"");
        assert_eq!(without_comment(b"a#b"), b"a#b");
    }

    #[test]
    fn names_that_differ_in_one_byte_are_shown_differently() {
        assert_ne!(shown(b"Gr\xfcn"), shown(b"Gr\xf6n"));
        assert_eq!(shown("rot \u{7ea2}".as_bytes()), "rot \u{7ea2}");
        assert_eq!(decodings(b"gr\xfcn")[0], "gr\u{fc}n");
        assert!(decodings(b"\x93\xfa\x96\x7b").contains(&String::from("\u{65e5}\u{672c}")));
    }
}
