//! Reading files: regular ones, up to a size, and those that other files name only from within the scene's root.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// The bytes of a regular file of at most `limit` bytes.
///
/// # Errors
/// `Io` where the system refuses, `File` where it is no regular file, `Limit` where it is larger.
pub(super) fn read(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let too_large =
        |size: u64| Error::Limit(format!("{}: the file has {size} bytes; at most {limit} are read", path.display()));
    // Asked before opening: opening a pipe would wait for its writer.
    let metadata = fs::metadata(path).map_err(|e| Error::io(path, "read", e))?;
    if !metadata.is_file() {
        return Err(Error::file(path, "is not a regular file"));
    }
    if metadata.len() > limit {
        return Err(too_large(metadata.len()));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|e| Error::io(path, "read", e))?;
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| Error::io(path, "read", e))?;
    if bytes.len() as u64 > limit {
        return Err(too_large(bytes.len() as u64));
    }
    Ok(bytes)
}

/// The text of a file, without a byte order mark.
///
/// # Errors
/// As [`read`], and `Input` where it is not UTF-8.
pub(super) fn read_text(path: &Path, limit: u64) -> Result<String> {
    let text = String::from_utf8(read(path, limit)?).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let bytes = e.as_bytes();
        let line = 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
        Error::at(path, line, format!("byte 0x{:02x} at offset {at} is not UTF-8; save the file as UTF-8", bytes[at]))
    })?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

/// Where files that a scene names may lie.
#[derive(Clone, Debug)]
pub(super) struct Root {
    canonical: PathBuf,
}

impl Root {
    /// The folder itself.
    ///
    /// # Errors
    /// `Io` where it cannot be found.
    pub(super) fn new(folder: &Path) -> Result<Self> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        Ok(Self { canonical: fs::canonicalize(folder).map_err(|e| Error::io(folder, "read", e))? })
    }

    /// The path of `name`, as a file in `folder` names it; either kind of slash will do.
    ///
    /// # Errors
    /// Why it cannot be had, in words that follow a colon.
    pub(super) fn resolve(&self, folder: &Path, name: &str) -> std::result::Result<PathBuf, String> {
        let path = folder.join(name.replace('\\', "/"));
        let canonical = fs::canonicalize(&path).map_err(|e| format!("cannot read `{name}`: {e}"))?;
        if !canonical.starts_with(&self.canonical) {
            return Err(format!("`{name}` lies outside the scene's folder"));
        }
        if !canonical.is_file() {
            return Err(format!("`{name}` is not a regular file"));
        }
        Ok(path)
    }
}

/// The folder a file lies in; empty for a bare name.
pub(super) fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}
