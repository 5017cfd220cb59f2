//! Header of a PLY file: its encoding, its elements and their properties.

/// Most elements, and most properties of one element, that a header may list.
const MOST: usize = 1_000;

/// Encoding of the numbers after the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Returns the bytes of one number in a binary file.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Returns the number that stands for 1 in a colour: the largest one of an integer type.
    pub(super) fn one(self) -> f64 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::I32 => 2_147_483_647.0,
            Self::U32 => 4_294_967_295.0,
            Self::F32 | Self::F64 => 1.0,
        }
    }
}

/// Property of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    /// Type of its number, or of those of its list.
    pub number: Number,
    /// Type of the count before a list; `None` for a single number.
    pub count: Option<Number>,
}

/// Element: a count of entries that have the same properties.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

/// Header of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Bytes of the header.
    pub bytes: usize,
    /// Lines of the header.
    pub lines: u32,
}

/// Reads the header of a file. An error has the line and a message.
pub(super) fn header(file: &[u8]) -> Result<Header, (usize, String)> {
    let mut lines = Lines { file, at: 0, number: 0 };
    if lines.next().as_deref() != Some("ply") {
        return Err((1, String::from("is no PLY file: its first line is not `ply`; save the model as PLY again")));
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some(line) = lines.next() {
        let wrong = |what: &str| (lines.number as usize, format!("`{}`: {what}", short(&line)));
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words.as_slice() {
            ["format", name, ..] => {
                encoding = Some(match *name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(wrong("a format is ascii, binary_little_endian or binary_big_endian")),
                });
            }
            ["element", name, count, ..] => {
                let count = count.parse().map_err(|_| wrong("the count of an element is a whole number"))?;
                if elements.len() >= MOST {
                    return Err(wrong("there are too many elements; at most 1000 are read"));
                }
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            ["property", rest @ ..] => {
                let of = |name: &str| Number::of(name).ok_or_else(|| wrong("this type of number is not known"));
                let (name, number, count) = match rest {
                    ["list", count, number, name, ..] => (name, of(number)?, Some(of(count)?)),
                    [number, name, ..] => (name, of(number)?, None),
                    _ => return Err(wrong("a property has a type and a name")),
                };
                if matches!(count, Some(Number::F32 | Number::F64)) {
                    return Err(wrong("the count of a list is a whole number"));
                }
                let property = Property { name: (*name).to_owned(), number, count };
                let Some(element) = elements.last_mut() else {
                    return Err(wrong("a property belongs to an element; put one before it"));
                };
                if element.properties.len() >= MOST {
                    return Err(wrong("there are too many properties; at most 1000 are read"));
                }
                element.properties.push(property);
            }
            ["end_header", ..] => {
                let encoding = encoding.ok_or_else(|| wrong("the header has no `format`; add `format ascii 1.0`"))?;
                return Ok(Header { encoding, elements, bytes: lines.at, lines: lines.number });
            }
            // Comments and `obj_info`.
            _ => {}
        }
    }
    Err((
        lines.number as usize,
        String::from("the header does not end: `end_header` is missing; the file is cut short"),
    ))
}

fn short(line: &str) -> String {
    line.chars().take(60).collect()
}

/// Lines of the header; they end in LF, CR LF or CR.
struct Lines<'a> {
    file: &'a [u8],
    /// Bytes read.
    at: usize,
    /// Lines read.
    number: u32,
}

impl Lines<'_> {
    fn next(&mut self) -> Option<String> {
        let rest = self.file.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
        let end = match rest.get(length..) {
            Some([b'\r', b'\n', ..]) => 2,
            Some([_, ..]) => 1,
            _ => 0,
        };
        self.at += length + end;
        self.number += 1;
        Some(String::from_utf8_lossy(&rest[..length]).trim().to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_lists_elements_with_their_properties_and_ends_where_the_numbers_begin() {
        let text = "ply\r\nformat binary_big_endian 1.0\r\ncomment a\r\nelement face 7\r\n\
                    property list uchar int vertex_indices\r\nproperty uchar red\r\nend_header\r\nXX";
        let header = header(text.as_bytes()).unwrap();
        assert_eq!((header.encoding, header.bytes, header.lines), (Encoding::BigEndian, text.len() - 2, 7));
        let list = Property { name: "vertex_indices".into(), number: Number::I32, count: Some(Number::U8) };
        let red = Property { name: "red".into(), number: Number::U8, count: None };
        let face = Element { name: "face".into(), count: 7, properties: vec![list, red] };
        assert_eq!(header.elements, [face]);
    }

    #[test]
    fn a_fault_in_a_header_names_its_line() {
        for (text, line, says) in [
            ("plu\n", 1, "no PLY"),
            ("ply\nformat text 1.0\n", 2, "text"),
            ("ply\nproperty float x\n", 2, "belongs"),
            ("ply\nelement vertex -3\n", 2, "whole"),
            ("ply\nelement vertex 3\nproperty half x\n", 3, "half"),
            ("ply\nelement vertex 3\nproperty list float int x\n", 3, "whole"),
            ("ply\nelement vertex 3\nproperty list\n", 3, "type and a name"),
            ("ply\nend_header\n", 2, "format"),
            ("ply\nformat ascii 1.0\n", 2, "cut short"),
        ] {
            let (at, message) = header(text.as_bytes()).unwrap_err();
            assert!(at == line && message.contains(says), "{text}: {at}: {message}");
        }
    }
}
