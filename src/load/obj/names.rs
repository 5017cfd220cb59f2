//! Spellings of names. One rule serves the names of material files, of materials and of pictures: as written; then with
//! comment, quotes and escapes removed; then in any case; and for files, then the bare file name.

use super::text::{decodings, shown, trimmed, without_comment};

/// Largest number of words into which a name is split.
const MOST_WORDS: usize = 64;

/// Returns the name without comment, quotes and escapes.
pub(super) fn cleaned(name: &[u8]) -> Vec<u8> {
    let name = trimmed(name);
    let quoted = |text: &[u8]| -> Option<Vec<u8>> {
        let quote = *text.first().filter(|q| matches!(q, b'"' | b'\''))?;
        let end = text[1..].iter().position(|&b| b == quote)?;
        Some(text[1..=end].to_vec())
    };
    if let Some(inner) = quoted(name) {
        return trimmed(&inner).to_vec();
    }
    let mut out = Vec::with_capacity(name.len());
    let mut bytes = trimmed(without_comment(name)).iter().copied().peekable();
    while let Some(b) = bytes.next() {
        let escapes = b == b'\\' && bytes.peek().is_some_and(|next| matches!(next, b' ' | b'"' | b'\'' | b'#'));
        if !escapes {
            out.push(b);
        }
    }
    if out.len() > 1 && out.ends_with(b"\\") {
        out.pop();
    }
    out
}

/// Returns the name by which two spellings are the same in any case.
pub(super) fn folded(name: &[u8]) -> String {
    shown(&cleaned(name)).to_lowercase()
}

/// Returns the names of a file that `name` may stand for, the likeliest first.
pub(super) fn files(name: &[u8]) -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    let mut add = |name: Vec<u8>| {
        if !name.is_empty() && !all.contains(&name) {
            all.push(name);
        }
    };
    for name in [trimmed(name).to_vec(), cleaned(name)] {
        let lower = name.to_ascii_lowercase();
        let path = if lower.starts_with(b"file:") {
            let rest = &name[b"file:".len()..];
            rest.strip_prefix(b"//").unwrap_or(rest).to_vec()
        } else {
            name
        };
        for name in [unescaped(&path), Some(path)].into_iter().flatten().rev().collect::<Vec<_>>() {
            add(name.clone());
            add(slashes(&name));
            for text in decodings(&name) {
                add(slashes(text.as_bytes()));
            }
        }
    }
    all
}

/// Returns the words of a list of names; quotes and escapes keep a blank within one.
pub(super) fn split(names: &[u8]) -> Vec<Vec<u8>> {
    let mut words = Vec::new();
    let mut word: Vec<u8> = Vec::new();
    let mut quote = None;
    let text = without_comment(names);
    for (i, &b) in text.iter().enumerate() {
        let escaped = i > 0 && text[i - 1] == b'\\';
        match quote {
            Some(q) if b == q => quote = None,
            None if matches!(b, b'"' | b'\'') && word.is_empty() => quote = Some(b),
            None if b.is_ascii_whitespace() && !escaped => {
                if !word.is_empty() {
                    words.push(std::mem::take(&mut word));
                }
            }
            _ => word.push(b),
        }
        if words.len() >= MOST_WORDS {
            break;
        }
    }
    if !word.is_empty() {
        words.push(word);
    }
    words
}

fn slashes(name: &[u8]) -> Vec<u8> {
    name.iter().map(|&b| if b == b'\\' { b'/' } else { b }).collect()
}

/// Returns the name with `%20` and its like replaced, if there are any.
fn unescaped(name: &[u8]) -> Option<Vec<u8>> {
    let hex = |b: u8| char::from(b).to_digit(16).map(|d| d as u8);
    let mut out = Vec::with_capacity(name.len());
    let mut i = 0;
    while i < name.len() {
        let code = match name[i..] {
            [b'%', a, b, ..] => hex(a).zip(hex(b)).map(|(a, b)| a * 16 + b),
            _ => None,
        };
        out.push(code.unwrap_or(name[i]));
        i += if code.is_some() { 3 } else { 1 };
    }
    (out != name).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comment_quotes_and_escapes_are_removed() {
        assert_eq!(cleaned(b" red # front"), b"red");
        assert_eq!(cleaned(b"\"dark red\" # x"), b"dark red");
        assert_eq!(cleaned(b"my\\ box.mtl"), b"my box.mtl");
        assert_eq!(cleaned(b"a#1"), b"a#1");
        assert_eq!(cleaned(b"red\\"), b"red");
        assert_eq!(cleaned(b"\""), b"\"");
        assert_eq!(folded(b"'Red'"), folded(b"rED"));
        assert_ne!(folded(b"Gr\xfcn"), folded(b"Gr\xf6n"));
    }

    #[test]
    fn a_file_may_be_spelled_in_many_ways() {
        let has = |name: &[u8], wanted: &[u8]| files(name).iter().any(|n| n == wanted);
        assert_eq!(files(b"a.png"), [b"a.png"]);
        assert!(has(b"maps\\t.png", b"maps/t.png"));
        assert!(has(b"file://t.png", b"t.png"));
        assert!(has(b"my%20t.png", b"my t.png"));
        assert!(has(b"gr\xfcn.png", "gr\u{fc}n.png".as_bytes()) && has(b"gr\xfcn.png", b"gr\xfcn.png"));
        assert!(has(b"t.png # diffuse", b"t.png"));
        // The second byte of this character of Shift-JIS is a backslash.
        assert!(has(b"\x95\x5c.png", "\u{8868}.png".as_bytes()));
    }

    #[test]
    fn a_list_is_split_at_blanks_outside_quotes_and_escapes() {
        assert_eq!(split(b"r.mtl  g.mtl # both"), [b"r.mtl", b"g.mtl"]);
        assert_eq!(split(b"\"my box.mtl\" b.mtl"), [&b"my box.mtl"[..], b"b.mtl"]);
        assert_eq!(split(b"my\\ box.mtl b"), [&b"my\\ box.mtl"[..], b"b"]);
        assert!(split(b"").is_empty());
    }
}
