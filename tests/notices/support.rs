//! Small scene files, and the notices about them.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::error::{Error, Unavailable};
use vitrum::load::{self, LoadOptions};
use vitrum::notices::{Facts, Notice, of_picture, of_scene, survey};
use vitrum::render::{Observer, Options, Outcome, reference, render};

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

/// Notices about a file by every back end, which are the same.
pub fn notices_by_all(file: &Path) -> Vec<Notice> {
    let loaded = load::scene(file, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let (scene, report) = (&loaded.scene, &loaded.report);
    let options = &Options { threads: 1, ..Options::default() };
    let observer = Observer::default();
    let facts = Facts { file, scene, report, options };
    let all = |outcome: Outcome| [of_scene(&facts), of_picture(&facts, &outcome)].concat();
    let native = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default()).expect("there is memory");
    let notices = all(render(scene, &native, options, &observer).expect("renders"));
    let arbiter = all(reference::render(scene, options, &observer).expect("renders"));
    assert_eq!(notices, arbiter, "native, and the `f64` renderer");
    let build = |backend| Accel::build(backend, &scene.geometry, BuildOptions::default());
    match build(Backend::Embree) {
        Ok(embree) => {
            let theirs = all(render(scene, &embree, options, &observer).expect("renders"));
            assert_eq!(notices, theirs, "native, and Embree");
        }
        Err(Error::Unavailable(Unavailable::NotCompiledIn)) => {}
        Err(why) => assert!(std::env::var_os("VITRUM_REQUIRE_EMBREE").is_none(), "{why}"),
    }
    notices
}

/// The only notice about a scene file of this text, by every back end.
pub fn only_notice(text: &str) -> Notice {
    let folder = Folder::with(&[("a.toml", text)]);
    let mut notices = notices_by_all(&folder.path("a.toml"));
    assert_eq!(notices.len(), 1, "{notices:?}");
    notices.remove(0)
}

/// Kinds of the notices about a scene file of this text, by every back end.
pub fn kinds(text: &str) -> Vec<&'static str> {
    let folder = Folder::with(&[("a.toml", text)]);
    ids(&notices_by_all(&folder.path("a.toml")))
}

/// Their kinds.
pub fn ids(notices: &[Notice]) -> Vec<&'static str> {
    notices.iter().map(|notice| notice.id).collect()
}
