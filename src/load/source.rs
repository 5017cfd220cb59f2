//! Reading of text files, and the folder that files named by a scene must lie in.

use std::fs;
use std::path::{Path, PathBuf};

use crate::system::files::read;
use crate::{Error, Result};

/// Returns the text of a file, without a byte order mark.
///
/// # Errors
/// Fails as [`read`] does, and with [`Error::Input`] if the file is not UTF-8.
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

/// Folder that must contain all files named by a scene.
#[derive(Clone, Debug)]
pub(super) struct Root {
    canonical: PathBuf,
}

impl Root {
    /// Resolves the folder.
    ///
    /// # Errors
    /// Returns [`Error::Io`] if it does not exist.
    pub(super) fn new(folder: &Path) -> Result<Self> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        Ok(Self { canonical: fs::canonicalize(folder).map_err(|e| Error::io(folder, "read", e))? })
    }

    /// Returns the path of `name`, relative to `folder`; both kinds of slash are accepted.
    ///
    /// # Errors
    /// Returns the reason, in words that follow a colon.
    pub(super) fn resolve(&self, folder: &Path, name: &str) -> std::result::Result<PathBuf, String> {
        let path = folder.join(name.replace('\\', "/"));
        let canonical = fs::canonicalize(&path).map_err(|e| format!("cannot read `{name}`: {e}"))?;
        if !canonical.starts_with(&self.canonical) {
            return Err(format!("`{name}` lies outside the scene's folder; copy it there"));
        }
        if !canonical.is_file() {
            return Err(format!("`{name}` is not a regular file"));
        }
        Ok(path)
    }
}

/// Returns the folder of a file; empty for a bare name.
pub(super) fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}
