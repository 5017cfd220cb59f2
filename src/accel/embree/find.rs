//! Where the library is looked for.

use std::path::{Path, PathBuf};

/// The library's file name.
pub const FILE_NAME: &str = "libembree4.so.4";

/// The folder beside `Cargo.toml` that `tests/get-embree` fills.
const OWN_FOLDER: &str = ".embree";

/// How to get what was not found: the end of every message that says so.
pub const CURE: &str = "install it (Debian 13, Ubuntu 24.04 and later: apt-get install libembree4-4), name \
                        its folder in EMBREE_DIR, or run tests/get-embree of Vitrum's sources, which needs no root; the \
                        native back end does without";

/// What to hand to the dynamic loader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// A file, or the bare name that the system's loader resolves itself.
    pub file: PathBuf,
    /// Where it was found, in a word for reports.
    pub because: &'static str,
}

/// Finds the library: in the folder `wished` (else the environment's `EMBREE_DIR`) and nowhere else where that is
/// given, so that a mistyped wish is not silently replaced; then in a folder `.embree/` beside a `Cargo.toml`, that of
/// the project the program was built from or lies in; then wherever the system's loader looks.
///
/// # Errors
/// The folder that was wished for, where it has no library.
pub fn find(wished: Option<&Path>) -> Result<Found, PathBuf> {
    let from_environment = || std::env::var_os("EMBREE_DIR").filter(|v| !v.is_empty()).map(PathBuf::from);
    if let Some(folder) = wished.map(Path::to_path_buf).or_else(from_environment) {
        let file = ["", "lib", "lib64", "lib/x86_64-linux-gnu"]
            .iter()
            .map(|inner| folder.join(inner).join(FILE_NAME))
            .find(|file| file.exists());
        return file.map(|file| Found { file, because: "EMBREE_DIR" }).ok_or(folder);
    }
    let program = std::env::current_exe().unwrap_or_default();
    let projects = program.ancestors().skip(1).filter(|folder| folder.join("Cargo.toml").is_file());
    let own = projects
        .chain([Path::new(env!("CARGO_MANIFEST_DIR"))])
        .map(|project| project.join(OWN_FOLDER).join(FILE_NAME))
        .find(|file| file.exists());
    Ok(own
        .map_or(Found { file: PathBuf::from(FILE_NAME), because: "system" }, |file| Found { file, because: ".embree" }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wished_folder_is_searched_with_its_usual_subfolders_and_nothing_else_is() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(find(Some(folder.path())), Err(folder.path().to_path_buf()));
        std::fs::create_dir(folder.path().join("lib64")).unwrap();
        let file = folder.path().join("lib64").join(FILE_NAME);
        std::fs::write(&file, "").unwrap();
        assert_eq!(find(Some(folder.path())).unwrap().file, file);
    }
}
