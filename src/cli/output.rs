//! Output to the user. Results go to standard output, everything else to standard error. Neither panics if it is
//! closed.

use std::io::{self, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::wording;
use crate::image::Destination;
use crate::{Error, Result};

/// Writes a line to standard error. A failure is ignored, since it cannot be reported.
pub(super) fn log(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Writes the error that ends the program to standard error, as one line. Later calls write nothing: the thread that handles
/// a second Ctrl-C may end the program while the main thread ends it for the first.
pub(super) fn log_failure(error: &Error) {
    static LOGGED: AtomicBool = AtomicBool::new(false);
    if !LOGGED.swap(true, Ordering::SeqCst) {
        log(&format!("error: {}", one_line(&wording::message(error))));
    }
}

/// Replaces control characters of a message by escapes, since file names may contain line ends.
pub(super) fn one_line(message: &str) -> String {
    let shown = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    message.chars().map(shown).collect()
}

/// Writes text to standard output.
///
/// # Errors
/// Io, except that a closed pipe is no error.
pub(super) fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Error::io("standard output", "write", e)),
        _ => Ok(()),
    }
}

/// Writes a value as JSON to standard output.
///
/// # Errors
/// As [`print`].
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<()> {
    print(&json(value, Path::new("standard output"))?)
}

/// Returns a value as JSON with a final line end, for the file or stream of this name.
///
/// # Errors
/// Io, if the value cannot be written as JSON.
fn json(value: &impl serde::Serialize, name: &Path) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::io(name, "write", io::Error::other(e)))?;
    Ok(text + "\n")
}

/// Writes a file: all of it, or none.
///
/// # Errors
/// As [`Destination::write`].
pub(super) fn save(file: &Path, bytes: &[u8]) -> Result<()> {
    Destination::new(file)?.write(bytes, || true)
}

/// Writes a value as JSON to a file.
///
/// # Errors
/// As [`save`].
pub(super) fn save_json(file: &Path, value: &impl serde::Serialize) -> Result<()> {
    save(file, json(value, file)?.as_bytes())
}
