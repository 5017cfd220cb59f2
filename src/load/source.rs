//! Reading of text files, and the folders that files named by a scene must lie in.

use std::ffi::OsStr;
use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::system::files::read;
use crate::{Error, Result};

/// Largest number of entries of a folder that are compared with a name regardless of case.
const MOST_ENTRIES: usize = 100_000;

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

/// Folders that must contain all files named by a scene.
#[derive(Clone, Debug)]
pub(super) struct Root {
    canonical: Vec<PathBuf>,
}

/// File that was found for a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Found {
    pub path: PathBuf,
    /// True if only the bare file name led to it, in the folder of the file that names it.
    pub beside: bool,
}

impl Root {
    /// Resolves the folder.
    ///
    /// # Errors
    /// Returns [`Error::Io`] if it does not exist.
    pub(super) fn new(folder: &Path) -> Result<Self> {
        let mut root = Self { canonical: Vec::new() };
        root.allow(folder)?;
        Ok(root)
    }

    /// Allows files in another folder.
    ///
    /// # Errors
    /// Returns [`Error::Io`] if it does not exist.
    pub(super) fn allow(&mut self, folder: &Path) -> Result<()> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        self.canonical.push(fs::canonicalize(folder).map_err(|e| Error::io(folder, "read", e))?);
        Ok(())
    }

    /// Returns the path of `name`, relative to `folder`; both kinds of slash are accepted.
    ///
    /// # Errors
    /// Returns the reason, in words that follow a colon.
    pub(super) fn resolve(&self, folder: &Path, name: &str) -> std::result::Result<PathBuf, String> {
        let path = folder.join(name.replace('\\', "/"));
        self.check(&path, name).map(|()| path)
    }

    fn check(&self, path: &Path, name: &str) -> std::result::Result<(), String> {
        let canonical = fs::canonicalize(path).map_err(|e| format!("cannot read `{name}`: {e}"))?;
        if !self.canonical.iter().any(|root| canonical.starts_with(root)) {
            let folder = canonical.parent().unwrap_or(Path::new("/")).display();
            return Err(format!(
                "`{name}` lies outside the scene's folder; copy it there, or allow its folder by `--allow-outside {folder}` \
                 or, in a scene, by `[files] roots = [\"{folder}\"]`"
            ));
        }
        if !canonical.is_file() {
            return Err(format!("`{name}` is not a regular file"));
        }
        Ok(())
    }

    /// Returns the file that one of several spellings of a name stands for, relative to `folder`. That is the first that
    /// exists as it is, else in any case. Failing that, it is the bare file name in `folder`, else that in any case.
    /// `shown` is the name in messages.
    ///
    /// # Errors
    /// Returns the reason, in words that follow a colon.
    pub(super) fn find(&self, folder: &Path, spellings: &[Vec<u8>], shown: &str) -> std::result::Result<Found, String> {
        let mut why = None;
        let mut take = |path: PathBuf, beside: bool| match self.check(&path, shown) {
            Ok(()) => Some(Found { path, beside }),
            Err(e) => {
                // A file that is there but not allowed says more than one that is not there.
                if why.is_none() || path.exists() {
                    why = Some(e);
                }
                None
            }
        };
        let names: Vec<PathBuf> = spellings.iter().filter(|s| !s.is_empty()).map(|s| path_of(s)).collect();
        let bare: Vec<PathBuf> = names.iter().filter_map(|n| n.file_name().map(PathBuf::from)).collect();
        for (names, beside) in [(&names, false), (&bare, true)] {
            if let Some(found) = names.iter().find_map(|n| take(folder.join(n), beside)) {
                return Ok(found);
            }
            let in_any_case = |n: &PathBuf| self.any_case(folder, n).and_then(|path| take(path, beside));
            if let Some(found) = names.iter().find_map(in_any_case) {
                return Ok(found);
            }
        }
        Err(why.unwrap_or_else(|| format!("cannot read `{shown}`: it names no file")))
    }

    /// Returns the path that equals `name` but for the case of letters.
    fn any_case(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        let mut at = folder.to_owned();
        for part in name.components() {
            match part {
                Component::Normal(wanted) => {
                    let exact = at.join(wanted);
                    at = if exact.exists() { exact } else { self.entry(&at, wanted)? };
                }
                Component::CurDir => {}
                Component::ParentDir => at.push(".."),
                // An absolute name stands for itself alone.
                Component::RootDir | Component::Prefix(_) => return None,
            }
        }
        Some(at)
    }

    /// Returns the entry of an allowed folder with that name in any case, the first by name.
    fn entry(&self, folder: &Path, wanted: &OsStr) -> Option<PathBuf> {
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let canonical = fs::canonicalize(here).ok()?;
        if !self.canonical.iter().any(|root| canonical.starts_with(root)) {
            return None;
        }
        let wanted = wanted.to_string_lossy().to_lowercase();
        let entries = fs::read_dir(here).ok()?.take(MOST_ENTRIES).flatten();
        let same = entries.map(|e| e.file_name()).filter(|name| name.to_string_lossy().to_lowercase() == wanted);
        same.min().map(|name| folder.join(name))
    }
}

/// Returns the path that bytes of a file name.
#[cfg(unix)]
fn path_of(bytes: &[u8]) -> PathBuf {
    use std::os::unix::ffi::OsStrExt as _;
    PathBuf::from(OsStr::from_bytes(bytes))
}

/// Returns the path that bytes of a file name.
#[cfg(not(unix))]
fn path_of(bytes: &[u8]) -> PathBuf {
    PathBuf::from(String::from_utf8_lossy(bytes).into_owned())
}

/// Returns the folder of a file; empty for a bare name.
pub(super) fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}
