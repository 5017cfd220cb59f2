//! Containers of glTF: JSON text, or the binary form (GLB) that holds the text and a buffer.

/// The text of a model, and the buffer beside it in a binary file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Container<'a> {
    pub json: &'a [u8],
    pub binary: Option<&'a [u8]>,
}

/// Opens a file. Chunks of other kinds are left out, and one that the end of the file cuts short is what is there.
pub(super) fn open(file: &[u8]) -> Result<Container<'_>, String> {
    let Some(rest) = file.strip_prefix(b"glTF") else { return Ok(Container { json: file, binary: None }) };
    let (version, rest) = number(rest).ok_or("is a binary glTF file that ends in its header; save it again")?;
    if version != 2 {
        return Err(format!("is binary glTF of version {version}; save the model as glTF 2.0"));
    }
    // The length of the whole file adds nothing to those of the chunks.
    let (_, mut rest) = number(rest).ok_or("is a binary glTF file that ends in its header; save it again")?;
    let (mut json, mut binary) = (None, None);
    while let Some((length, kind, after)) = chunk(rest) {
        let (chunk, next) = after.split_at(after.len().min(length));
        match &kind {
            b"JSON" => json = json.or(Some(chunk)),
            b"BIN\0" => binary = binary.or(Some(chunk)),
            _ => {}
        }
        rest = next;
    }
    let json = json.ok_or("is a binary glTF file without a JSON chunk; save it again")?;
    Ok(Container { json, binary })
}

/// Returns a number of four bytes, and the rest.
fn number(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (number, rest) = bytes.split_first_chunk::<4>()?;
    Some((u32::from_le_bytes(*number) as usize, rest))
}

/// Returns the length and the kind of a chunk, and what follows.
fn chunk(bytes: &[u8]) -> Option<(usize, [u8; 4], &[u8])> {
    let (length, rest) = number(bytes)?;
    let (kind, rest) = rest.split_first_chunk::<4>()?;
    Some((length, *kind, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_binary_file_is_taken_apart_and_a_text_is_itself() {
        assert_eq!(open(b"{}").unwrap(), Container { json: b"{}", binary: None });
        let mut file = b"glTF\x02\0\0\0\xff\xff\xff\xff\x04\0\0\0JSON{}  ".to_vec();
        file.extend(b"\x01\0\0\0ODD!x\x08\0\0\0BIN\0abc");
        assert_eq!(open(&file).unwrap(), Container { json: b"{}  ", binary: Some(b"abc") });
    }

    #[test]
    fn faulty_headers_are_refused_and_lengths_below_the_header_are_harmless() {
        assert!(open(b"glTF\x01\0\0\0\0\0\0\0").unwrap_err().contains("version 1"));
        assert!(open(b"glTF\x02\0").unwrap_err().contains("ends in its header"));
        assert!(open(b"glTF\x02\0\0\0\x01\0\0\0").unwrap_err().contains("without a JSON chunk"));
    }
}
