//! Memory asked for before the work that needs it.
//!
//! Rust's collections end the process where an allocation fails. So each stage of a command first calls [`need`] with an
//! upper estimate of what it will take, and lists that grow with the input grow by [`push`], which fails instead. What
//! no estimate foresaw is caught by the program's allocator (`src/allocator.rs`), which ends the program with the
//! message of [`write_exhausted`] and the same exit code.

use std::cell::Cell;
use std::fmt;
use std::io::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use super::left::{Bound, Left, left, left_to_map};
use crate::error::{Error, Result, TooLarge};

/// Bytes that must stay free beside what was asked for: small allocations of every stage.
const ASIDE: u64 = 2 << 20;

/// Bytes, asked for by one call or by several, for which the system's limits are read again: that takes some 50
/// microseconds.
const STEP: u64 = 1 << 20;

/// Bytes asked for since the limits were last read.
static SINCE: AtomicU64 = AtomicU64::new(0);

/// Bytes as a person reads them.
#[derive(Clone, Copy, Debug)]
pub struct Size(pub u64);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const UNITS: [&str; 6] = ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
        if self.0 < 1024 {
            return write!(f, "{} {}", self.0, if self.0 == 1 { "byte" } else { "bytes" });
        }
        let unit = (self.0.ilog2() / 10) as usize;
        let value = self.0 as f64 / (1_u64 << (10 * unit)) as f64;
        // 9.95 would be shown as 10.0.
        if value < 9.95 {
            write!(f, "{value:.1} {}", UNITS[unit - 1])
        } else {
            write!(f, "{value:.0} {}", UNITS[unit - 1])
        }
    }
}

/// The stage at work: what it makes and what makes it smaller, for a message when memory runs out in its middle.
static STAGE: Mutex<Stage> = Mutex::new(Stage { what: [0; Stage::LONGEST], length: 0, cure: "" });

struct Stage {
    what: [u8; Stage::LONGEST],
    length: usize,
    cure: &'static str,
}

impl Stage {
    const LONGEST: usize = 200;
}

thread_local! {
    /// True while this thread makes an allocation whose failure it handles.
    static FALLIBLE: Cell<bool> = const { Cell::new(false) };
}

/// Returns true if this thread handles the failure of the allocation that it makes now.
#[must_use]
pub fn is_fallible() -> bool {
    FALLIBLE.try_with(Cell::get).unwrap_or(false)
}

/// Runs `attempt`, whose allocations may fail.
fn fallibly<T>(attempt: impl FnOnce() -> T) -> T {
    FALLIBLE.set(true);
    let result = attempt();
    FALLIBLE.set(false);
    result
}

/// Begins a stage that makes `what` and takes up to `bytes` of memory.
///
/// # Errors
/// [`Error::TooLarge`], where the system does not leave that much. The message names `what`, its size, what is left, and as
/// cures a higher limit or `cure`, which follows "or".
pub fn need(what: &str, bytes: u64, cure: &'static str) -> Result<()> {
    begin(what, cure);
    room(bytes).map(|_| ()).map_err(|left| too_large(what, amount(bytes), left, cure))
}

/// Begins a stage that maps up to `bytes` for `what` and writes little of it: only limits on mappings count.
///
/// # Errors
/// [`Error::TooLarge`] as [`need`].
pub fn need_mapped(what: &str, bytes: u64, cure: &'static str) -> Result<()> {
    begin(what, cure);
    match left_to_map() {
        Some(left) if left.bytes < bytes.saturating_add(ASIDE) => Err(too_large(what, amount(bytes), Some(left), cure)),
        _ => Ok(()),
    }
}

/// The error for `what`, where a library reports that memory ran out and not how much it asked for.
pub fn ran_out(what: &str, cure: &str) -> Error {
    too_large(what, String::from("more memory"), left(), cure)
}

/// Notes the stage for the message of an allocation that fails.
fn begin(what: &str, cure: &'static str) {
    let mut stage = STAGE.lock().unwrap_or_else(PoisonError::into_inner);
    let longest = what.len().min(Stage::LONGEST);
    let end = (0..=longest).rev().find(|&i| what.is_char_boundary(i)).unwrap_or(0);
    stage.what[..end].copy_from_slice(&what.as_bytes()[..end]);
    (stage.length, stage.cure) = (end, cure);
}

/// Checks that `bytes` can be had now, and some more. Where they cannot, the error is what is left. Returns true where memory
/// counts as used only once it is written.
fn room(bytes: u64) -> std::result::Result<bool, Option<Left>> {
    if SINCE.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes) < STEP {
        return Ok(false);
    }
    SINCE.store(0, Ordering::Relaxed);
    let bytes = bytes.saturating_add(ASIDE);
    match left() {
        Some(left) if left.bytes < bytes => Err(Some(left)),
        Some(left) => Ok(matches!(left.bound, Bound::Group | Bound::Machine) && left.bytes / 4 < bytes),
        // Nothing but an attempt tells.
        None => {
            let attempt = || Vec::<u8>::new().try_reserve_exact(usize::try_from(bytes).unwrap_or(usize::MAX));
            fallibly(attempt).map(|()| false).map_err(|_| None)
        }
    }
}

fn too_large(what: &str, needs: String, left: Option<Left>, cure: &str) -> Error {
    let limit = match left {
        Some(Left { bytes, bound }) => format!("{} left {bound}; {} or {cure}", Size(bytes), bound.cure()),
        None => format!("more than the system gives; {cure}"),
    };
    TooLarge { what: what.into(), needs, limit }.into()
}

/// `bytes` of memory and what is left aside, as errors name them.
fn amount(bytes: u64) -> String {
    format!("{} of memory", Size(bytes.saturating_add(ASIDE)))
}

/// Reserves room for exactly `additional` more values.
///
/// # Errors
/// [`Error::TooLarge`] as [`need`], for `what`.
pub fn reserve<T: Copy + Default>(list: &mut Vec<T>, additional: usize, what: &str, cure: &'static str) -> Result<()> {
    if list.capacity() - list.len() < additional {
        grow(list, additional, what, cure)?;
    }
    Ok(())
}

/// Appends a value. Grows the list by half where it is full.
///
/// # Errors
/// [`Error::TooLarge`] as [`need`], for `what`.
#[inline]
pub fn push<T: Copy + Default>(list: &mut Vec<T>, value: T, what: &str, cure: &'static str) -> Result<()> {
    if list.len() == list.capacity() {
        grow(list, (list.len() / 2).max(16), what, cure)?;
    }
    list.push(value);
    Ok(())
}

#[cold]
#[inline(never)]
fn grow<T: Copy + Default>(list: &mut Vec<T>, additional: usize, what: &str, cure: &'static str) -> Result<()> {
    /// Blocks of at least so many bytes are moved by the system, smaller ones may be copied: glibc's largest threshold.
    const MOVED: usize = 32 << 20;
    let (held, more) = (list.capacity() * size_of::<T>(), additional.saturating_mul(size_of::<T>()));
    let bytes = more.saturating_add(if held < MOVED { held } else { 0 }) as u64;
    let counted_when_written = room(bytes).map_err(|left| too_large(what, amount(bytes), left, cure))?;
    fallibly(|| list.try_reserve_exact(additional)).map_err(|_| too_large(what, amount(bytes), left(), cure))?;
    if counted_when_written {
        // Else the next check would count on this memory once more.
        for value in list.spare_capacity_mut() {
            value.write(T::default());
        }
    }
    Ok(())
}

/// Writes the message for an allocation of `bytes` that failed where nothing could handle it, without allocating.
/// Names the stage that [`need`] began last.
pub fn write_exhausted(mut to: impl Write, bytes: u64) {
    let mut line = [0; 700];
    let mut rest = &mut line[..];
    // A message that does not fit is cut.
    let _ = write_message(&mut rest, bytes);
    let left = rest.len();
    let end = line.len() - left;
    let _ = to.write_all(&line[..end]);
}

fn write_message(to: &mut &mut [u8], bytes: u64) -> std::io::Result<()> {
    // The thread that failed may hold the lock.
    let stage = STAGE.try_lock();
    let (what, cure) = match &stage {
        Ok(stage) => (std::str::from_utf8(&stage.what[..stage.length]).unwrap_or_default(), stage.cure),
        Err(_) => ("", ""),
    };
    let what = if what.is_empty() { "the command" } else { what };
    let cure = if cure.is_empty() { "take a smaller scene" } else { cure };
    write!(to, "error: {what}: {} more of memory needed, ", Size(bytes))?;
    match left() {
        Some(Left { bytes, bound }) => writeln!(to, "{} left {bound}; {} or {cure}", Size(bytes), bound.cure()),
        None => writeln!(to, "more than the system gives; {cure}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_the_unit_that_leaves_one_to_four_digits() {
        let shown =
            [0, 1, 1023, 1024, 1536, 10 << 10, 48 << 20, (1 << 30) - 1, 3 << 29, u64::MAX].map(|n| Size(n).to_string());
        let want = [
            "0 bytes",
            "1 byte",
            "1023 bytes",
            "1.0 KiB",
            "1.5 KiB",
            "10 KiB",
            "48 MiB",
            "1024 MiB",
            "1.5 GiB",
            "16 EiB",
        ];
        assert_eq!(shown, want);
    }

    #[test]
    fn what_no_memory_holds_is_a_limit_that_names_size_and_cure_and_a_little_is_none() {
        for _ in 0..100 {
            need("a thing", 1 << 16, "take less").unwrap();
        }
        for bytes in [1 << 50, u64::MAX] {
            let refused = need("a thing", bytes, "take less").unwrap_err();
            assert_eq!(refused.exit_code(), 4);
            let text = refused.to_string();
            assert!(text.starts_with("a thing: ") && text.ends_with("take less") && text.contains("iB"), "{text}");
        }
        assert!(!is_fallible());
    }

    #[test]
    fn mapping_more_than_no_limit_allows_is_no_error_and_a_library_that_ran_out_says_what_is_left() {
        if left_to_map().is_none() {
            need_mapped("a thing", 1 << 50, "take less").unwrap();
        }
        let text = ran_out("a thing", "take less").to_string();
        assert!(text.starts_with("a thing: more memory needed") && text.ends_with("take less"), "{text}");
    }

    #[test]
    fn a_list_grows_by_pushing_and_refuses_what_no_memory_holds() {
        let mut list = Vec::new();
        for i in 0..100_000_u32 {
            push(&mut list, i, "numbers", "count less").unwrap();
        }
        assert!(list.iter().copied().eq(0..100_000));
        assert!(list.capacity() < 160_000);
        assert_eq!(reserve(&mut list, usize::MAX / 8, "numbers", "count less").unwrap_err().exit_code(), 4);
        assert_eq!(list.len(), 100_000);
    }

    #[test]
    fn the_last_message_names_the_stage_and_fits_its_buffer() {
        let mut out = Vec::new();
        write_exhausted(&mut out, 3 << 20);
        let text = String::from_utf8(out).unwrap();
        assert!(text.starts_with("error: ") && text.ends_with('\n') && text.contains("3.0 MiB more"), "{text}");
    }
}
