//! Whole command lines that may be anything: the program ends with one of its exit codes, tells an error in one line,
//! and leaves no unfinished file.

use std::path::Path;
use std::process::{Command, Stdio};

use super::entry;

/// Ending of a command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// By itself, with this exit code.
    Code(i32),
    /// It asked for more work than it was given time for.
    CutOff,
}

/// Address space that a program gets, in KiB: what it cannot have it must say.
const KIBIBYTES: u64 = 8 << 20;

/// Runs `program` in a folder of the project's small files, with `seconds` of processor time.
///
/// # Panics
/// Where it ends in any way but those that are documented.
pub fn run(program: &Path, words: &[String], seconds: u32) -> Ending {
    let outer = entry::folder();
    // One level down, so that `..` stays within what is thrown away.
    let inner = outer.path().join("inner");
    std::fs::create_dir(&inner).expect("folders can be made");
    for file in std::fs::read_dir(outer.path()).expect("the folder can be listed").flatten() {
        if file.path().is_file() {
            let _ = std::fs::rename(file.path(), inner.join(file.file_name()));
        }
    }
    let limits = format!("ulimit -v {KIBIBYTES}; ulimit -t {seconds}; ulimit -f 1048576; ulimit -c 0; exec \"$@\"");
    let output = Command::new("sh")
        .args(["-c", &limits, "sh"])
        .arg(program)
        .args(words.iter().filter(|w| !w.contains('\0')))
        .current_dir(&inner)
        .stdin(Stdio::null())
        .output()
        .expect("sh is there");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{words:?}: {said}");
    let Some(code) = output.status.code() else {
        let signal = output.status.to_string();
        assert!(["24 (", "9 ("].iter().any(|s| signal.contains(s)), "{words:?}: {signal}: {said}");
        return Ending::CutOff;
    };
    assert!(matches!(code, 0..=4), "{words:?}: {code}: {said}");
    // Usage errors of the argument parser take several lines.
    if matches!(code, 3 | 4) || (code == 2 && !said.contains("--help")) {
        let lines = said.lines().filter(|line| line.starts_with("error: ")).count();
        let last = said.lines().last().unwrap_or_default();
        assert!(lines == 1 && last.starts_with("error: "), "{words:?}: {said}");
        assert!(last.len() < 1000 + 2 * words.iter().map(String::len).sum::<usize>(), "{words:?}: {said}");
    }
    for file in std::fs::read_dir(&inner).expect("the folder can be listed").flatten() {
        let name = file.file_name().to_string_lossy().into_owned();
        assert!(!name.ends_with(".part"), "{words:?} left {name}");
    }
    Ending::Code(code)
}
