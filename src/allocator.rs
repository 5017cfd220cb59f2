//! The program's allocator: that of the system, except when memory runs out. Then the program prints one line on
//! standard error and ends with the exit code of a limit, not by SIGABRT.
//!
//! Rust aborts if `Vec`, `Box` or `String` cannot allocate, and the hook that could change this
//! (`std::alloc::set_alloc_error_hook`) is not stable. A null pointer is the only sign of the failure, so this
//! allocator tests for it. Allocations whose failure the caller handles are marked
//! (`vitrum::system::memory::is_fallible`) and get their null pointer.
//!
//! This is a last resort. Each stage checks its memory before it starts (`vitrum::system::memory::need`), which fails
//! with an ordinary error. The library has no such allocator: programs that use it choose their own.

#![allow(unsafe_code, reason = "an allocator is an unsafe trait")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, Ordering};

use vitrum::system::memory;

#[global_allocator]
static ALLOCATOR: OrEnd = OrEnd;

/// Set by the first thread that ends the program.
static ENDING: AtomicBool = AtomicBool::new(false);

/// The system's allocator, which ends the program if memory runs out.
struct OrEnd;

impl OrEnd {
    /// Returns `block`. Ends the program if it is null and the caller does not handle failures.
    #[inline(always)]
    fn or_end(block: *mut u8, bytes: usize) -> *mut u8 {
        if block.is_null() && !memory::is_fallible() {
            end(bytes);
        }
        block
    }
}

// SAFETY: each method hands its arguments to the same method of `System`, which keeps the contract of `GlobalAlloc`, and
// returns what that returned or does not return. `end` does not unwind: it calls nothing that panics or allocates, and
// leaves by `_exit`.
unsafe impl GlobalAlloc for OrEnd {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's word on `layout`.
        Self::or_end(unsafe { System.alloc(layout) }, layout.size())
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's word on `layout`.
        Self::or_end(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's word on `block`, which came from `System` by one of these methods, `layout` and `size`.
        Self::or_end(unsafe { System.realloc(block, layout, size) }, size)
    }

    #[inline]
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's word on `block`, which came from `System` by one of these methods, and `layout`.
        unsafe { System.dealloc(block, layout) }
    }
}

/// Writes the message and ends the program. The first thread that arrives does so; others wait for it.
#[cold]
#[inline(never)]
fn end(bytes: usize) -> ! {
    if ENDING.swap(true, Ordering::SeqCst) {
        // Either the message of the first thread failed to allocate, or another thread comes second. Both are rare, and
        // the first thread takes little time.
        std::thread::sleep(std::time::Duration::from_millis(500));
        leave();
    }
    memory::write_exhausted(Direct, bytes as u64);
    vitrum::image::discard_unfinished_at_once();
    leave()
}

/// Standard error without the lock of `std::io::stderr`, which the thread that failed may hold.
struct Direct;

#[cfg(unix)]
impl std::io::Write for Direct {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        // SAFETY: the pointer and the length are those of a slice.
        let written = unsafe { libc::write(2, bytes.as_ptr().cast(), bytes.len()) };
        usize::try_from(written).map_err(|_| std::io::Error::last_os_error())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(not(unix))]
impl std::io::Write for Direct {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        std::io::stderr().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn leave() -> ! {
    // The exit code of `vitrum::Error::Limit`.
    const LIMIT: i32 = 4;
    // SAFETY: `_exit` has no preconditions. Handlers of `exit` are left out: other threads are at work.
    #[cfg(unix)]
    unsafe {
        libc::_exit(LIMIT)
    }
    #[cfg(not(unix))]
    std::process::exit(LIMIT)
}

/// Reduces the address space that glibc's allocator uses, if address space is limited. It then has one arena instead of
/// one per thread, of 64 MiB each, and large blocks go back to the system when they are freed. Without a limit nothing
/// is changed.
pub fn keep_to_limits() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if vitrum::system::left::address_space_is_limited() {
        const LARGE: libc::c_int = 128 << 10;
        // SAFETY: both settings only choose where later blocks come from.
        unsafe {
            libc::mallopt(libc::M_ARENA_MAX, 1);
            libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
        }
    }
}
