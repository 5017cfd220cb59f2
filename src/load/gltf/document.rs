//! A glTF file with its buffers.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf_json::Root;

use super::container::Container;
use crate::load::assembly::Assembly;
use crate::load::source::folder_of;
use crate::system::files::read;
use crate::{Error, Result};

/// A file with its buffers.
pub(super) struct Document<'a> {
    pub path: &'a Path,
    pub root: Root,
    buffers: Vec<Cow<'a, [u8]>>,
}

/// Place of data that a file names.
pub(super) enum Uri {
    /// Bytes in the name itself.
    Data(Vec<u8>),
    File(PathBuf),
}

impl<'a> Document<'a> {
    /// Reads the text and the buffers of a file. A buffer that cannot be read is empty, with a warning.
    pub(super) fn read(path: &'a Path, container: Container<'a>, assembly: &mut Assembly<'_>) -> Result<Self> {
        let root = Root::from_slice(container.json).map_err(|e| {
            let message = e.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
            let message: String = message.chars().take(300).collect();
            Error::file(path, format!("is no glTF 2.0 model: {message}; save it again"))
        })?;
        let mut binary = container.binary;
        let mut left = assembly.options.limits.file_bytes;
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            let bytes: std::result::Result<Cow<'a, [u8]>, String> = match (&buffer.uri, i) {
                (Some(uri), _) => match resolve(uri, path, assembly) {
                    Ok(Uri::Data(bytes)) => Ok(bytes.into()),
                    Ok(Uri::File(file)) => read(&file, left).map(Cow::from).map_err(|e| e.to_string()),
                    Err(e) => Err(e),
                },
                (None, 0) => binary.take().map(Cow::from).ok_or_else(|| String::from("the file has no binary chunk")),
                (None, _) => Err(String::from("it has no `uri`")),
            };
            let bytes = match bytes {
                Ok(bytes) => bytes,
                Err(e) => {
                    let kind = format!("buffer {i} left out: {e}");
                    assembly.reporter.warn(path, 0, &kind, String::new)?;
                    Cow::default()
                }
            };
            left = left.checked_sub(bytes.len() as u64).ok_or_else(|| {
                Error::Limit(format!("{}: its buffers have too many bytes; split the model", path.display()))
            })?;
            buffers.push(bytes);
        }
        Ok(Self { path, root, buffers })
    }

    /// Returns the bytes of all buffers.
    pub(super) fn bytes(&self) -> usize {
        self.buffers.iter().map(|b| b.len()).sum()
    }

    /// Returns the bytes of a view of a buffer and its stride, or the reason why there are none.
    pub(super) fn view(&self, index: usize) -> std::result::Result<(&[u8], Option<usize>), String> {
        let view = self.root.buffer_views.get(index).ok_or_else(|| format!("there is no buffer view {index}"))?;
        let buffer = self.buffers.get(view.buffer.value());
        let buffer = buffer.ok_or_else(|| format!("there is no buffer {}", view.buffer.value()))?;
        let offset = view.byte_offset.map_or(0, |o| o.0);
        let range = usize::try_from(offset).ok().zip(usize::try_from(view.byte_length.0).ok());
        let range = range.and_then(|(start, length)| Some(start..start.checked_add(length)?));
        let bytes = range
            .and_then(|range| buffer.get(range))
            .ok_or_else(|| format!("buffer view {index} reaches beyond the {} bytes of its buffer", buffer.len()))?;
        Ok((bytes, view.byte_stride.map(|s| s.0)))
    }
}

/// Returns the place that a name gives, or the reason why it gives none.
pub(super) fn resolve(uri: &str, path: &Path, assembly: &Assembly<'_>) -> std::result::Result<Uri, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (kind, data) = data.split_once(',').ok_or("a `data:` without a comma")?;
        if !kind.ends_with(";base64") {
            return Ok(Uri::Data(unescaped(data)));
        }
        let data: Vec<u8> = data.bytes().filter(|b| !b.is_ascii_whitespace()).collect();
        return STANDARD.decode(data).map(Uri::Data).map_err(|e| format!("`data:` of faulty base64: {e}"));
    }
    let folder = folder_of(path);
    // Names are escaped by the standard, and written as they are by some programs.
    let escaped = String::from_utf8_lossy(&unescaped(uri)).into_owned();
    let file =
        assembly.root.resolve(folder, &escaped).or_else(|e| assembly.root.resolve(folder, uri).map_err(|_| e))?;
    Ok(Uri::File(file))
}

/// Decodes `%20` and its like.
fn unescaped(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code =
            after.get(..2).and_then(|d| std::str::from_utf8(d).ok()).and_then(|d| u8::from_str_radix(d, 16).ok());
        match code {
            Some(code) if first == b'%' => {
                bytes.push(code);
                rest = &after[2..];
            }
            _ => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_are_decoded_and_other_percent_signs_stay() {
        assert_eq!(unescaped("a%20b%2Fc%C3%A9%zz%4"), "a b/cé%zz%4".as_bytes());
    }
}
