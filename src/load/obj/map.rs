//! Texture statements of MTL: options, and the file behind them.

use super::number::narrow;
use super::text::trimmed;

/// Picture of a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Map {
    /// Line of its statement.
    pub line: u32,
    /// File, as written.
    pub file: Vec<u8>,
    /// Factor on texture coordinates (`-s`).
    pub scale: [f32; 2],
    /// Shift of scaled texture coordinates (`-o`).
    pub offset: [f32; 2],
    /// True if the picture does not repeat (`-clamp on`).
    pub clamp: bool,
    /// Channel that a scalar map takes (`-imfchan`): `r`, `g`, `b`, `m` for the mask, `l` for luminance.
    pub channel: Option<u8>,
    /// Options that are not used.
    pub unused: Vec<&'static str>,
}

/// Reads the rest of a texture statement.
pub(super) fn map(line: u32, rest: &[u8]) -> Map {
    let mut map = Map { line, scale: [1.0; 2], ..Map::default() };
    let mut rest = trimmed(rest);
    while rest.starts_with(b"-") {
        let (word, behind) = word(rest);
        let lower = word.to_ascii_lowercase();
        // Smallest and largest number of words that an option takes.
        let (name, least, most) = match lower.as_slice() {
            b"-s" => ("", 1, 3),
            b"-o" => ("", 1, 3),
            b"-clamp" | b"-imfchan" => ("", 1, 1),
            // Filters, and values that only other kinds of map have.
            b"-blendu" | b"-blendv" | b"-bm" | b"-boost" | b"-texres" | b"-type" => ("", 1, 1),
            b"-t" => ("-t", 1, 3),
            b"-mm" => ("-mm", 2, 2),
            b"-cc" => ("-cc", 1, 1),
            b"-colorspace" => ("-colorspace", 1, 1),
            _ => break,
        };
        rest = behind;
        let mut arguments = [&[][..]; 3];
        let mut count = 0;
        while count < most {
            let (argument, behind) = self::word(rest);
            if argument.is_empty() || (count >= least && narrow(argument).number().is_none()) {
                break;
            }
            arguments[count] = argument;
            count += 1;
            rest = behind;
        }
        let number = |i: usize, default: f32| {
            Some(arguments[i])
                .filter(|_| i < count)
                .and_then(|w| narrow(w).number())
                .filter(|x| x.is_finite())
                .unwrap_or(default)
        };
        match lower.as_slice() {
            b"-s" => map.scale = [number(0, 1.0), number(1, 1.0)],
            b"-o" => map.offset = [number(0, 0.0), number(1, 0.0)],
            b"-clamp" => map.clamp = arguments[0].eq_ignore_ascii_case(b"on"),
            b"-imfchan" => map.channel = arguments[0].first().map(u8::to_ascii_lowercase),
            b"-cc" if arguments[0].eq_ignore_ascii_case(b"off") => {}
            b"-colorspace" if arguments[0].eq_ignore_ascii_case(b"srgb") => {}
            _ if name.is_empty() => {}
            _ => map.unused.push(name),
        }
    }
    map.file = rest.to_vec();
    map
}

/// Returns the first word and the text behind it.
fn word(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    (&text[..end], text[end..].trim_ascii_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_options_are_told_from_the_file() {
        let of = |text: &str| {
            let map = map(7, text.as_bytes());
            (String::from_utf8(map.file).unwrap(), map.scale, map.offset, map.clamp)
        };
        assert_eq!(of("t.png"), ("t.png".into(), [1.0; 2], [0.0; 2], false));
        assert_eq!(of("-s 1 2 1 t.png"), ("t.png".into(), [1.0, 2.0], [0.0; 2], false));
        assert_eq!(of("-s 2 my picture.png"), ("my picture.png".into(), [2.0, 1.0], [0.0; 2], false));
        assert_eq!(of("-bm 0.5 -clamp on -o 0.5 0 a\\b.jpg"), ("a\\b.jpg".into(), [1.0; 2], [0.5, 0.0], true));
        assert_eq!(of("-mm 0 1"), (String::new(), [1.0; 2], [0.0; 2], false));
        assert_eq!(of("-odd.png"), ("-odd.png".into(), [1.0; 2], [0.0; 2], false));
        assert_eq!(of("-colorspace sRGB t.png").0, "t.png");
        assert_eq!(map(1, b"-mm 0 1 -imfchan M t.png").unused, ["-mm"]);
        assert_eq!(map(1, b"-imfchan M t.png").channel, Some(b'm'));
    }
}
