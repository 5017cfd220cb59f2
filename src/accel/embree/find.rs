//! Search for the Embree library.

use std::path::{Path, PathBuf};

/// The library's file name.
pub const FILE_NAME: &str = "libembree4.so.4";

/// The folder beside `Cargo.toml` that `tests/get-embree` fills.
const OWN_FOLDER: &str = ".embree";

/// Cure in messages about a missing library.
pub const CURE: &str = "install it (Debian 13, Ubuntu 24.04 and later: apt-get install libembree4-4), name \
                        its folder in EMBREE_DIR, or run tests/get-embree of Vitrum's sources, which needs no root; the \
                        native back end does without";

/// File for the dynamic loader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundLibrary {
    /// Path of a file, or a bare name that the system's loader resolves.
    pub file: PathBuf,
    /// Rule that found the file, in one word for reports.
    pub because: &'static str,
}

/// Finds the library. The folder `wished`, or else the one in `EMBREE_DIR`, is the only place searched if it is given,
/// so that a mistyped folder is not silently replaced. Otherwise folders `.embree/` beside a `Cargo.toml` are searched:
/// those above the program, then that of the project it was built from. The last resort is the search path of the
/// system's loader.
///
/// # Errors
/// The folder that was given, if it does not contain the library.
pub fn find(wished: Option<&Path>) -> Result<FoundLibrary, PathBuf> {
    let from_environment = || std::env::var_os("EMBREE_DIR").filter(|v| !v.is_empty()).map(PathBuf::from);
    if let Some(folder) = wished.map(Path::to_path_buf).or_else(from_environment) {
        let file = ["", "lib", "lib64", "lib/x86_64-linux-gnu"]
            .iter()
            .map(|inner| folder.join(inner).join(FILE_NAME))
            .find(|file| file.exists());
        return file.map(|file| FoundLibrary { file, because: "EMBREE_DIR" }).ok_or(folder);
    }
    let program = std::env::current_exe().unwrap_or_default();
    let projects = program.ancestors().skip(1).filter(|folder| folder.join("Cargo.toml").is_file());
    let own = projects
        .chain([Path::new(env!("CARGO_MANIFEST_DIR"))])
        .map(|project| project.join(OWN_FOLDER).join(FILE_NAME))
        .find(|file| file.exists());
    Ok(own.map_or(FoundLibrary { file: PathBuf::from(FILE_NAME), because: "system" }, |file| FoundLibrary {
        file,
        because: ".embree",
    }))
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
