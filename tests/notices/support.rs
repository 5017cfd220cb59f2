//! Small scene files, and the notices about them.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use vitrum::load::{self, LoadOptions};
use vitrum::notices::{Notice, survey};
use vitrum::render::{Observer, Options};

/// A folder of its own, with files in it.
pub struct Folder(TempDir);

impl Folder {
    pub fn with(files: &[(&str, &str)]) -> Self {
        let folder = Self(TempDir::new().expect("a folder"));
        for (name, text) in files {
            fs::write(folder.path(name), text).expect("a file");
        }
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

/// Notices about a file of the folder.
pub fn notices_of(file: &Path) -> Vec<Notice> {
    let mut loaded = load::scene(file, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let options = Options { threads: 1, ..Options::default() };
    survey(file, &mut loaded.scene, &loaded.report, &options, &Observer::default()).expect("nobody interrupts a test")
}

/// Their kinds.
pub fn ids(notices: &[Notice]) -> Vec<&'static str> {
    notices.iter().map(|notice| notice.id).collect()
}
