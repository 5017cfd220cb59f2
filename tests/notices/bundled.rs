//! Scenes of the project give no cause for a warning.

use std::fs;
use std::path::Path;

use super::support::notices_of;

#[test]
fn no_check_fires_on_the_scenes_of_the_project() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut count = 0;
    for folder in [folder.join("hard"), folder] {
        for file in fs::read_dir(folder).expect("the folder is there").map(|f| f.expect("readable").path()) {
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            // The larger ones of the sweep differ from the smallest in their triangles alone.
            if !name.ends_with(".toml") || (name.starts_with("sweep-") && name != "sweep-1k.toml") {
                continue;
            }
            let notices = notices_of(&file);
            assert!(notices.is_empty(), "{name}: {notices:?}");
            count += 1;
        }
    }
    assert!(count >= 18, "{count} scenes");
}
