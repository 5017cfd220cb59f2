//! Atomic writing of files: a file is complete or absent.

use std::fs::{File, Metadata, OpenOptions, Permissions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::part::{self, folder_of};
use crate::{Error, Result};

/// Temporary file of the write in progress, for [`discard_unfinished`].
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

fn unfinished() -> MutexGuard<'static, Option<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary file of a write in progress, for a process that is about to exit.
pub fn discard_unfinished() {
    if let Some(path) = unfinished().take() {
        // A failure is ignored, because the process is about to exit.
        let _ = std::fs::remove_file(path);
    }
}

/// Does the same as [`discard_unfinished`] without waiting, since the calling thread may be the one that writes.
pub fn discard_unfinished_at_once() {
    if let Ok(mut unfinished) = UNFINISHED.try_lock()
        && let Some(path) = unfinished.take()
    {
        let _ = std::fs::remove_file(path);
    }
}

/// Destination of a file, checked to be writable.
#[derive(Clone, Debug)]
pub struct Destination {
    /// Name as given by the user.
    name: PathBuf,
    kind: DestinationKind,
}

#[derive(Clone, Debug)]
enum DestinationKind {
    /// Regular file, existing or not, with symbolic links resolved.
    File { path: PathBuf, permissions: Option<Permissions> },
    /// Device or pipe, which cannot be replaced by renaming.
    Stream,
}

impl Destination {
    /// Checks `name` and its folder, so that a long job fails before it starts.
    ///
    /// # Errors
    /// Returns [`Error::Io`] if the folder is missing or not writable, or if `name` is a folder or a read-only file.
    pub fn new(name: &Path) -> Result<Self> {
        let refuse = |kind: io::ErrorKind, why: &str| Error::io(name, "write", io::Error::new(kind, why));
        let system = |e| Error::io(name, "write", e);
        if name.file_name().is_none() {
            return Err(refuse(io::ErrorKind::IsADirectory, "it names a folder, not a file"));
        }
        let there = match std::fs::metadata(name) {
            Ok(metadata) => Some(metadata),
            Err(e) if e.kind() == io::ErrorKind::NotFound => None,
            Err(e) => return Err(system(e)),
        };
        let kind = match there {
            Some(m) if m.is_dir() => return Err(refuse(io::ErrorKind::IsADirectory, "it is a folder")),
            Some(m) if !m.is_file() => DestinationKind::Stream,
            Some(m) if m.permissions().readonly() => {
                return Err(refuse(io::ErrorKind::PermissionDenied, "it is read-only"));
            }
            Some(m) => DestinationKind::File {
                path: std::fs::canonicalize(name).map_err(system)?,
                permissions: Some(Metadata::permissions(&m)),
            },
            None => DestinationKind::File { path: end_of_links(name).map_err(system)?, permissions: None },
        };
        let destination = Self { name: name.to_path_buf(), kind };
        if let DestinationKind::File { path, .. } = &destination.kind {
            // A test write is made instead of reading permission bits: disks may also be full or read-only.
            tempfile::tempfile_in(folder_of(path)).map_err(|e| match e.kind() {
                io::ErrorKind::NotFound if path != name => {
                    let why = format!("it is a link to {}, whose folder does not exist", path.display());
                    refuse(io::ErrorKind::NotFound, &why)
                }
                io::ErrorKind::NotFound => refuse(io::ErrorKind::NotFound, "its folder does not exist"),
                _ => system(without_path(e)),
            })?;
            part::remove_leftovers(path);
        }
        Ok(destination)
    }

    /// Returns the name as given by the user.
    #[must_use]
    pub fn name(&self) -> &Path {
        &self.name
    }

    /// Returns true for a device or pipe. Bytes are written to it at once and cannot be taken back.
    #[must_use]
    pub fn is_stream(&self) -> bool {
        matches!(self.kind, DestinationKind::Stream)
    }

    /// Writes `bytes` to a temporary file in the same folder, syncs it to the disk, and renames it. Calls `proceed`
    /// right before the renaming; if that returns false, nothing is left behind.
    ///
    /// # Errors
    /// Returns [`Error::Io`], or [`Error::Interrupted`] if `proceed` returns false. An existing file then keeps its old
    /// content.
    pub fn write(&self, bytes: &[u8], proceed: impl FnOnce() -> bool) -> Result<()> {
        let system = |e| Error::io(&self.name, "write", with_cure(without_path(e)));
        let DestinationKind::File { path, permissions } = &self.kind else {
            if !proceed() {
                return Err(Error::Interrupted);
            }
            let mut stream = OpenOptions::new().write(true).open(&self.name).map_err(system)?;
            return stream.write_all(bytes).and_then(|()| stream.flush()).map_err(system);
        };
        let mut file = {
            // Locked across the creation, so that the file is registered at every moment at which it exists.
            let mut unfinished = unfinished();
            let file = part::create(path, permissions.is_none()).map_err(system)?;
            *unfinished = Some(file.path().to_path_buf());
            file
        };
        let filled = fill(file.as_file_mut(), bytes, permissions.as_ref()).map_err(system);
        let mut unfinished = unfinished();
        // From here on nothing is removed after the renaming; before it, dropping `file` removes it.
        *unfinished = None;
        filled?;
        if !proceed() {
            return Err(Error::Interrupted);
        }
        file.persist(path).map_err(|e| system(e.error))?;
        Ok(())
    }
}

fn fill(file: &mut File, bytes: &[u8], permissions: Option<&Permissions>) -> io::Result<()> {
    file.write_all(bytes)?;
    if let Some(permissions) = permissions {
        file.set_permissions(permissions.clone())?;
    }
    file.sync_all()
}

/// Returns the path that a missing name resolves to: the end of a chain of symbolic links, or the name itself.
fn end_of_links(name: &Path) -> io::Result<PathBuf> {
    /// Largest number of links followed, as in Linux.
    const MOST: usize = 40;
    let mut path = name.to_path_buf();
    for _ in 0..MOST {
        match std::fs::read_link(&path) {
            Ok(target) => path = folder_of(&path).join(target),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Returns the system's error, with a cure if it is about the limit on file sizes.
fn with_cure(e: io::Error) -> io::Error {
    if e.kind() == io::ErrorKind::FileTooLarge {
        return io::Error::new(
            e.kind(),
            "it would be larger than files may be here; raise `ulimit -f` or write fewer pixels",
        );
    }
    e
}

/// Returns the system's error without the temporary name that `tempfile` adds.
fn without_path(e: io::Error) -> io::Error {
    let source = e.get_ref().and_then(|inner| inner.source()).and_then(|source| source.downcast_ref::<io::Error>());
    match source.map(|source| (source.raw_os_error(), source.kind())) {
        Some((Some(code), _)) => io::Error::from_raw_os_error(code),
        Some((None, kind)) => kind.into(),
        None => e,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_whole_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        Destination::new(&path).unwrap().write(b"first", || true).unwrap();
        Destination::new(&path).unwrap().write(b"second", || true).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(names_in(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_write_that_is_called_off_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, b"old").unwrap();
        let refused = Destination::new(&path).unwrap().write(b"new", || false);
        assert!(matches!(refused, Err(Error::Interrupted)));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(names_in(folder.path()), ["a.png"]);
    }

    #[test]
    fn unfit_places_are_refused_before_anything_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let read_only = folder.path().join("read-only.png");
        std::fs::write(&read_only, b"").unwrap();
        let mut permissions = std::fs::metadata(&read_only).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&read_only, permissions).unwrap();
        for path in [folder.path().to_path_buf(), folder.path().join("missing/a.png"), read_only, PathBuf::from("..")] {
            let error = Destination::new(&path).unwrap_err();
            assert_eq!(error.exit_code(), 3, "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_modes_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real.png"), folder.path().join("link.png"));
        std::fs::write(&real, b"old").unwrap();
        std::fs::set_permissions(&real, Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink("real.png", &link).unwrap();
        Destination::new(&link).unwrap().write(b"new", || true).unwrap();
        assert_eq!(std::fs::read(&real).unwrap(), b"new");
        assert_eq!(std::fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_is_followed_and_one_to_nowhere_refused() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("deep")).unwrap();
        symlink("deep/second", path("first")).unwrap();
        symlink("real.png", path("deep/second")).unwrap();
        Destination::new(&path("first")).unwrap().write(b"new", || true).unwrap();
        assert_eq!(std::fs::read(path("deep/real.png")).unwrap(), b"new");
        assert!(std::fs::symlink_metadata(path("first")).unwrap().is_symlink());
        assert_eq!(names_in(&path("deep")), ["real.png", "second"]);
        symlink("missing/real.png", path("nowhere")).unwrap();
        symlink("loop", path("loop")).unwrap();
        for name in ["nowhere", "loop"] {
            let error = Destination::new(&path(name)).unwrap_err();
            assert!(error.exit_code() == 3 && error.to_string().contains("link"), "{error}");
        }
        assert_eq!(names_in(folder.path()), ["deep", "first", "loop", "nowhere"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error_and_stays_a_device() {
        let full = Destination::new(Path::new("/dev/full")).unwrap();
        assert!(full.is_stream());
        assert_eq!(full.write(b"x", || true).unwrap_err().exit_code(), 3);
        assert!(!std::fs::metadata("/dev/full").unwrap().is_file());
    }
}
