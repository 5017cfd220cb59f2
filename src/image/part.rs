//! Temporary files for outputs, and removal of those that killed processes left behind.
//!
//! A process locks its temporary file until the file has its final name or is removed. The system releases the lock
//! when the process ends for any reason. So a file that can be locked is a leftover. Process ids are not used: they are
//! reused, and mean nothing to another container or host that shares the folder.

use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

const SUFFIX: &str = ".part";

/// Length of the random part between the output's name and the suffix: a hyphen and characters from `tempfile`.
const RANDOM: usize = 6;

/// Number of characters of the output's name that are kept, since file names have at most 255 bytes.
const LONGEST_NAME: usize = 50;

/// Number of attempts to create a temporary file. Another process may remove the file before it is locked; after this
/// many losses something else is wrong.
const TRIES: usize = 16;

/// Returns the prefix of temporary files for `output`, such as `.vitrum-a.png-`.
fn prefix(output: &Path) -> String {
    let name = output.file_name().unwrap_or_default().to_string_lossy();
    format!(".vitrum-{}-", name.chars().take(LONGEST_NAME).collect::<String>())
}

/// Returns the folder of a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Creates a locked temporary file in the folder of `output`. Only the owner can read it, unless `open`: then it has
/// the default permissions less the user's umask.
pub(super) fn create(output: &Path, open: bool) -> io::Result<NamedTempFile> {
    let prefix = prefix(output);
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    #[cfg(unix)]
    if open {
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    }
    #[cfg(not(unix))]
    let _ = open;
    let mut last = None;
    for _ in 0..TRIES {
        let file = builder.tempfile_in(folder_of(output))?;
        // Some file systems have no locks. There nothing is locked, and nothing removed.
        let _ = file.as_file().lock();
        if is_there(file.as_file(), file.path()) {
            return Ok(file);
        }
        last = Some(file);
    }
    last.ok_or_else(|| io::Error::other("temporary files vanish as they are created"))
}

/// Returns true if `path` still refers to `file`.
fn is_there(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let id = |m: fs::Metadata| (m.dev(), m.ino());
        file.metadata()
            .map(id)
            .ok()
            .is_some_and(|own| fs::symlink_metadata(path).map(id).is_ok_and(|there| there == own))
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

/// Removes temporary files for `output` whose processes have ended.
pub(super) fn remove_leftovers(output: &Path) {
    let prefix = prefix(output);
    let is_ours = |name: OsString| {
        let name = name.to_string_lossy().into_owned();
        let random = name.strip_prefix(&prefix).and_then(|rest| rest.strip_suffix(SUFFIX));
        random.is_some_and(|r| r.len() == RANDOM && r.bytes().all(|b| b.is_ascii_alphanumeric()))
    };
    let Ok(entries) = fs::read_dir(folder_of(output)) else { return };
    for path in entries.flatten().filter(|e| is_ours(e.file_name())).map(|e| e.path()) {
        remove_where_left(&path);
    }
}

fn remove_where_left(path: &PathBuf) {
    // Pipes, which would block, and links are not opened.
    if !fs::symlink_metadata(path).is_ok_and(|m| m.is_file()) {
        return;
    }
    let Ok(file) = File::open(path) else { return };
    match file.try_lock() {
        // The lock is held until the file is removed, so that a process that has just created it notices.
        Ok(()) if is_there(&file, path) => {
            let _ = fs::remove_file(path);
        }
        Ok(()) | Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_a_process_that_is_gone_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("a.png");
        let left = create(&output, true).unwrap().keep().unwrap().0;
        // A process that has ended holds no lock.
        drop(left);
        let busy = create(&output, true).unwrap();
        let others = [".vitrum-b.png-abcdef.part", ".vitrum-a.png-abcdef.parts", ".vitrum-a.png-x-bcde.part", "a.png"];
        for name in others {
            fs::write(folder.path().join(name), "kept").unwrap();
        }
        let mut kept: Vec<String> = others.iter().map(|name| (*name).to_owned()).collect();
        kept.push(busy.path().file_name().unwrap().to_str().unwrap().to_owned());
        kept.sort();
        assert_eq!(names(folder.path()).len(), 6);
        remove_leftovers(&output);
        assert_eq!(names(folder.path()), kept);
    }

    #[test]
    fn a_name_as_long_as_names_may_be_leaves_room_for_the_rest() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("\u{1f52d}".repeat(62) + ".png");
        let file = create(&output, true).unwrap();
        assert!(file.path().file_name().unwrap().len() <= 255);
        assert!(is_there(file.as_file(), file.path()));
        fs::remove_file(file.path()).unwrap();
        assert!(!is_there(file.as_file(), file.path()));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_bears_such_a_name_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("precious"), folder.path().join(".vitrum-a.png-abcdef.part"));
        fs::write(&target, "x").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        remove_leftovers(&folder.path().join("a.png"));
        assert!(target.exists() && link.exists());
    }
}
