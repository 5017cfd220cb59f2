//! The Embree library is loaded only where it is fit for use, and its FFI keeps to its own memory.
//!
//! Where no library is found the tests that need one say so and pass, unless VITRUM_REQUIRE_EMBREE is set.

use std::io::Write;
use std::path::Path;
use std::process::Command;

use vitrum::accel::embree::Library;
use vitrum::accel::embree::device::Device;
use vitrum::accel::embree::{Embree, Frequency, Isa, Options, find, sys};

/// The library, or word on the terminal that the test was left out (test output that passes is not shown).
fn library(test: &str) -> Option<&'static Library> {
    match Library::open(None) {
        Ok(library) => Some(library),
        Err(e) if std::env::var_os("VITRUM_REQUIRE_EMBREE").is_some() => panic!("{test}: {e}"),
        Err(e) => {
            writeln!(std::io::stderr(), "SKIPPED {test}: {e}").ok();
            None
        }
    }
}

#[test]
fn nothing_is_written_behind_the_structs_at_any_width() {
    let Some(library) = library("canary") else { return };
    let device = Device::open(library, 1, Frequency::Widest, Isa::Best).unwrap();
    assert_eq!(device.bytes_written_past(sys::RAY_HIT_ENDS).unwrap(), [0, 0, 0]);
}

#[test]
fn the_shorter_structs_of_4_2_are_overrun_by_4_32_and_64_bytes() {
    // What embree4-rs 0.0.16 and embree4-sys 0.0.12 hand over: hits without `instPrimID`, which 4.3 and later write.
    let Some(library) = library("the layout of 4.2") else { return };
    let device = Device::open(library, 1, Frequency::Widest, Isa::Best).unwrap();
    let past = device.bytes_written_past(sys::RAY_HIT_ENDS_4_2).unwrap();
    assert_eq!(past, if library.version >= [4, 3, 0] { [4, 32, 64] } else { [0, 0, 0] });
}

/// Case PA-05 of the catalogue.
#[test]
fn structs_have_the_sizes_of_the_c_headers() {
    assert_eq!([size_of::<sys::RtcRay1>(), size_of::<sys::RtcRay8>(), size_of::<sys::RtcRay16>()], [48, 384, 768]);
    assert_eq!([size_of::<sys::RtcHit1>(), size_of::<sys::RtcHit8>(), size_of::<sys::RtcHit16>()], [48, 288, 576]);
    let sizes = [size_of::<sys::RtcRayHit1>(), size_of::<sys::RtcRayHit8>(), size_of::<sys::RtcRayHit16>()];
    assert_eq!(sizes, [96, 672, 1344]);
    let alignments = [align_of::<sys::RtcRayHit1>(), align_of::<sys::RtcRayHit8>(), align_of::<sys::RtcRayHit16>()];
    assert_eq!(alignments, [16, 32, 64]);
}

fn refusal(folder: &Path) -> String {
    let options = Options { library: Some(folder.to_path_buf()), ..Options::default() };
    let Err(error) = Embree::build(&[], &options) else { panic!("accepted {}", folder.display()) };
    assert_eq!(error.exit_code(), 4);
    let message = error.to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    message
}

/// Case PA-08 of the catalogue.
#[test]
fn a_folder_without_the_library_is_refused_with_the_cure() {
    let folder = tempfile::tempdir().unwrap();
    let message = refusal(folder.path());
    assert!(message.contains(find::FILE_NAME) && message.contains("tests/get-embree"), "{message}");
}

#[test]
fn a_file_that_is_no_library_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(find::FILE_NAME), "not a library").unwrap();
    assert!(refusal(folder.path()).contains("cannot load"));
}

/// A shared library made of `source`, in a folder under the name of Embree's.
fn compiled(source: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fake.c");
    std::fs::write(&file, source).unwrap();
    // The linker driver that Rust itself uses.
    let mut cc = Command::new("cc");
    cc.args(["-w", "-shared", "-fPIC", "-o"]).arg(folder.path().join(find::FILE_NAME)).arg(file);
    assert!(cc.status().unwrap().success());
    folder
}

#[test]
fn a_library_that_lacks_a_function_is_refused_by_its_name() {
    let folder = compiled("void *rtcNewDevice(const char *config) { return 0; }");
    assert!(refusal(folder.path()).contains("has no rtcReleaseDevice"));
}

/// Case PA-08 of the catalogue.
#[test]
fn another_major_version_is_refused() {
    let speaking = "int device; void *rtcNewDevice(const char *config) { return &device; }
        long rtcGetDeviceProperty(void *device, int property) { return property == 0 ? 31305 : 0; }\n";
    let silent = sys::Api::SYMBOLS.iter().filter(|name| !speaking.contains(*name));
    let silent: String = silent.map(|name| format!("void {name}(void) {{}}\n")).collect();
    let folder = compiled(&format!("{speaking}{silent}"));
    assert!(refusal(folder.path()).contains("version 3.13.5, not 4"));
}
