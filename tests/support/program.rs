//! The program `vitrum`, and the files that it leaves.

use std::path::{Path, PathBuf};

/// Returns the path of the built program.
pub fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin("vitrum")
}

/// Returns the sorted names of the files in a folder.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
