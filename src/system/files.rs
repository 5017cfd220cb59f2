//! Whole regular files, up to a size, into memory that was asked for first.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use super::memory::{self, Size};
use crate::{Error, Result};

/// The bytes of a regular file of at most `limit` bytes.
///
/// # Errors
/// `Io` where the system refuses or the file changes its length meanwhile, `File` where it is no regular file, `Limit`
/// where it is larger or there is no memory for it.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let unreadable = |e| Error::io(path, "read", e);
    // Before opening: opening a pipe would wait for its writer.
    let metadata = fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(Error::file(path, "is not a regular file"));
    }
    let mut file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    if length > limit {
        return Err(Error::Limit(format!(
            "{}: the file has {length} bytes ({}); at most {limit} are read",
            path.display(),
            Size(length)
        )));
    }
    let mut bytes = Vec::new();
    let what = format!("{} ({})", path.display(), Size(length));
    // One byte more shows that a file has grown, and keeps `read_to_end` from asking for more.
    memory::reserve(&mut bytes, length as usize + 1, &what, "take a smaller file")?;
    file.by_ref().take(length + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 != length {
        let change = if bytes.len() as u64 > length { "grew" } else { "shrank" };
        let why = format!("it {change} while it was read; try again when nothing writes to it");
        return Err(unreadable(io::Error::other(why)));
    }
    Ok(bytes)
}

/// The first bytes of a regular file, at most `count`.
///
/// # Errors
/// `Io` where the system refuses, `File` where it is no regular file.
pub fn read_start(path: &Path, count: u64) -> Result<Vec<u8>> {
    let unreadable = |e| Error::io(path, "read", e);
    if !fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(Error::file(path, "is not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path).map_err(unreadable)?.take(count).read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

/// Creates a folder, and those above it, where they are missing.
///
/// # Errors
/// `Io` where the system refuses, or a file or a link to nothing has the name of one of them.
pub fn create_folder(path: &Path) -> Result<()> {
    fs::create_dir_all(path).map_err(|e| {
        let in_the_way = path.ancestors().find(|p| fs::symlink_metadata(p).is_ok() && !p.is_dir());
        let e = in_the_way.map_or(e, |p| {
            let what = if p.exists() { "a file" } else { "a link to a folder that does not exist" };
            io::Error::other(format!("{} is {what}; choose another folder", p.display()))
        });
        Error::io(path, "create", e)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_the_limit_and_a_folder_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for length in [0, 1, 1000] {
            fs::write(&path, vec![7; length]).unwrap();
            assert_eq!(read(&path, 1000).unwrap(), vec![7; length]);
        }
        assert_eq!(read(&path, 999).unwrap_err().exit_code(), 4);
        assert_eq!(read(folder.path(), 999).unwrap_err().exit_code(), 2);
        assert_eq!(read(&folder.path().join("b"), 999).unwrap_err().exit_code(), 3);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_whose_length_is_not_what_the_system_says_is_refused() {
        // Files of /proc have length 0 and grow while they are read.
        let refused = read(Path::new("/proc/self/maps"), 1 << 20).unwrap_err();
        assert!(refused.exit_code() == 3 && refused.to_string().contains("grew while it was read"), "{refused}");
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_is_made_and_what_is_in_its_way_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        create_folder(&path("a/b")).unwrap();
        create_folder(&path("a/b")).unwrap();
        fs::write(path("file"), "").unwrap();
        std::os::unix::fs::symlink("nowhere", path("link")).unwrap();
        for (inside, words) in
            [("file/b", "file is a file;"), ("link/b", "link is a link to a folder that does not exist;")]
        {
            let refused = create_folder(&path(inside)).unwrap_err();
            assert!(refused.exit_code() == 3 && refused.to_string().contains(words), "{refused}");
        }
    }
}
