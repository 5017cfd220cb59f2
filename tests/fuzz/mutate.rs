//! Small changes to files and to command lines, the same for the same seed.

/// Small numbers from one seed (Marsaglia 2003, xorshift64).
pub struct Random(u64);

impl Random {
    /// From any seed.
    pub fn new(seed: u64) -> Self {
        // Neighbouring seeds must not give neighbouring streams, and zero none.
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d | 1)
    }

    /// Below `n`; 0 for 0.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % n.max(1)
    }

    /// One of a list that is not empty.
    pub fn one_of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// Words that parsers trip over.
pub const WORDS: [&str; 48] = [
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1",
    "0",
    "-0.0",
    "1e-45",
    "1e-38",
    "3.5e38",
    "3.4028235e38",
    "-3.4e38",
    "1e19",
    "1e18",
    "1e10",
    "16777217",
    "2147483647",
    "-2147483648",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999",
    "0x10",
    "1_000",
    "+1",
    ".5",
    "5.",
    "1e",
    "1//",
    "/",
    "1/2/3/4",
    "\\",
    "\r",
    "\n",
    "\u{feff}",
    "é",
    "\0",
    "#",
    "[",
    "]]",
    "{",
    "=",
    "'",
    "\"\"\"",
    "../../../etc/passwd",
    "usemtl",
];

/// Longest file that is made up.
const MOST_BYTES: usize = 1 << 16;

/// A few changes to `seed`; parts may come from `donor`.
pub fn mutated(seed: &[u8], donor: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(4) {
        change(&mut bytes, donor, random);
        bytes.truncate(MOST_BYTES);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, donor: &[u8], random: &mut Random) {
    if bytes.is_empty() {
        bytes.push(random.below(256) as u8);
    }
    let at = random.below(bytes.len());
    match random.below(16) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => drop(bytes.remove(at)),
        2 => bytes.insert(at, random.below(256) as u8),
        3 => bytes[at] = *random.one_of(&[0, 1, 0x7f, 0x80, 0xff, b' ', b'\n', b'0', b'9', b'-']),
        4 | 5 => {
            let (start, end) = word_at(bytes, at);
            bytes.splice(start..end, random.one_of(&WORDS).bytes());
        }
        6 => swap_words(bytes, at, random),
        7 | 8 => change_number(bytes, at, random),
        9 => {
            let (start, end) = line_at(bytes, at);
            let line = bytes[start..end].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, line);
        }
        10 => {
            let (start, end) = line_at(bytes, at);
            drop(bytes.drain(start..end));
        }
        11 => {
            // A line very many times: quadratic work shows.
            let (start, end) = line_at(bytes, at);
            let line = bytes[start..end].to_vec();
            let times = 1 << random.below(10);
            bytes.splice(start..start, line.iter().copied().cycle().take(line.len() * times));
        }
        12 => bytes.truncate(at),
        13 => {
            // Brackets and blanks, deep.
            let what = *random.one_of(b"[{(\"' \t\n\\/#-");
            bytes.splice(at..at, std::iter::repeat_n(what, 1 << random.below(12)));
        }
        14 if !donor.is_empty() => {
            let from = random.below(donor.len());
            let part = &donor[from..donor.len().min(from + random.below(64))];
            let end = bytes.len().min(at + random.below(64));
            bytes.splice(at..end, part.iter().copied());
        }
        _ => {
            // Four bytes of a binary header, or of anything.
            let number = *random.one_of(&[0_u32, 1, 0x7f, 0xff, 0xffff, 0x1_0000, 0x7fff_ffff, 0x8000_0000, u32::MAX]);
            let number = if random.below(2) == 0 { number.to_be_bytes() } else { number.to_le_bytes() };
            for (byte, new) in bytes[at..].iter_mut().zip(number) {
                *byte = new;
            }
        }
    }
}

/// The word around a byte.
fn word_at(bytes: &[u8], at: usize) -> (usize, usize) {
    let breaks = |b: &u8| b.is_ascii_whitespace() || matches!(b, b'/' | b',' | b'=' | b'[' | b']');
    let start = bytes[..at].iter().rposition(breaks).map_or(0, |i| i + 1);
    let end = bytes[at..].iter().position(breaks).map_or(bytes.len(), |i| at + i);
    (start, end.max(start))
}

/// The line around a byte, with its end.
fn line_at(bytes: &[u8], at: usize) -> (usize, usize) {
    let start = bytes[..at].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
    let end = bytes[at..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |i| at + i + 1);
    (start, end)
}

fn swap_words(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let (a, b) = (word_at(bytes, at), word_at(bytes, random.below(bytes.len())));
    let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
    if a.1 <= b.0 {
        let (first, second) = (bytes[a.0..a.1].to_vec(), bytes[b.0..b.1].to_vec());
        bytes.splice(b.0..b.1, first);
        bytes.splice(a.0..a.1, second);
    }
}

/// The next number after a place becomes another one: its sign, its size, or by one.
fn change_number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|i| at + i) else { return };
    let end = bytes[start..].iter().position(|b| !b.is_ascii_digit() && *b != b'.').map_or(bytes.len(), |i| start + i);
    let text = String::from_utf8_lossy(&bytes[start..end]).into_owned();
    let value: f64 = text.parse().unwrap_or(1.0);
    let new = match random.below(7) {
        0 => format!("-{text}"),
        1 => format!("{}", value + 1.0),
        2 => format!("{}", value - 1.0),
        3 => format!("{text}{}", "0".repeat(1 << random.below(6))),
        4 => format!("{text}e{}", random.below(100) as i64 - 50),
        5 => format!("0.{}{text}", "0".repeat(1 << random.below(6))),
        _ => String::from("0"),
    };
    bytes.splice(start..end, new.bytes());
}
