//! Devices of the loaded library, as an owning type. Everything here is safe to call.
//!
//! MXCSR is left as Rust sets it, without flush-to-zero. Rust's arithmetic may not run under other modes, and the
//! native path, which is compared with this one, runs under the same. Embree sets its own mode for a build and restores
//! the old one.

#![allow(unsafe_code, reason = "calls into the Embree library")]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::failure::{WITHOUT, error_name, reported};
use super::library::{DEVICE_BYTES, Library, has_avx2};
use super::options::{Frequency, Isa};
use super::sys::{self, Api};
use crate::error::Result;
use crate::system::{memory, threads};

/// Address space in bytes of each build thread: its stack and its part of the scheduler.
const THREAD_BYTES: u64 = 5 << 20;

/// Errors and memory use that Embree reports by callbacks.
#[derive(Default)]
struct Log {
    /// First error: its code and Embree's message.
    error: Mutex<Option<(c_int, String)>>,
    bytes: AtomicIsize,
}

/// An Embree device: its configuration, worker threads and memory account.
pub struct Device {
    library: &'static Library,
    raw: sys::RtcDevice,
    /// At a fixed address, because Embree keeps a pointer to it. It is freed after the device, which the device's last
    /// scene keeps alive.
    log: Arc<Log>,
}

// SAFETY: Embree's devices may be used from any thread (API manual, section on threads); the log is Sync.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

impl Device {
    /// Opens a device with `threads` build threads; 0 means one per processor.
    ///
    /// # Errors
    /// [`Unavailable`](crate::error::Unavailable) if Embree makes no device; a limit if there is not enough memory or threads.
    pub fn open(library: &'static Library, threads: usize, frequency: Frequency, isa: Isa) -> Result<Arc<Self>> {
        let workers = threads::count(threads);
        memory::need_mapped("an Embree device", DEVICE_BYTES + workers as u64 * THREAD_BYTES, WITHOUT)?;
        threads::probe(workers)?;
        let mut config = format!("verbose=0,threads={threads}");
        let narrow = matches!(isa, Isa::Sse42 | Isa::Avx);
        if frequency == Frequency::Widest && !narrow && has_avx2() {
            config += ",frequency_level=simd256";
        }
        if let Some(name) = isa.name() {
            config = config + ",isa=" + name;
        }
        let config = CString::new(config).unwrap_or_default();
        let log = Arc::<Log>::default();
        let user: *mut c_void = Arc::as_ptr(&log).cast_mut().cast();
        // SAFETY: a terminated string.
        let raw = unsafe { (library.api.new_device)(config.as_ptr()) };
        if raw.is_null() {
            // SAFETY: null asks for the error of this thread.
            let code = unsafe { (library.api.device_error)(std::ptr::null_mut()) };
            let config = config.to_string_lossy();
            return Err(reported(code, format!("no device for {config}: {}", error_name(code))));
        }
        // SAFETY: the log outlives the device, and both callbacks take it for what it is.
        unsafe {
            (library.api.set_error_function)(raw, note_error, user);
            (library.api.set_memory_function)(raw, note_memory, user);
        }
        Ok(Arc::new(Self { library, raw, log }))
    }

    /// Library that made the device.
    #[must_use]
    pub fn library(&self) -> &'static Library {
        self.library
    }

    /// Returns true if 16-wide packets are traversed 16 wide with the instructions of this device.
    #[must_use]
    pub fn native16(&self) -> bool {
        // SAFETY: the device lives.
        unsafe { (self.library.api.device_property)(self.raw, sys::PROPERTY_NATIVE_RAY16) != 0 }
    }

    /// Bytes that Embree holds for this device.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.log.bytes.load(Ordering::Relaxed).max(0).unsigned_abs()
    }

    /// Address of the device, valid while `self` lives.
    pub(super) fn raw(&self) -> sys::RtcDevice {
        self.raw
    }

    /// Functions to call with the device.
    pub(super) fn api(&self) -> &'static Api {
        &self.library.api
    }

    /// Returns the first error that Embree reported since the last call, if any.
    pub(super) fn check(&self) -> Result<()> {
        match self.log.error.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some((code, message)) => Err(reported(code, message)),
            None => Ok(()),
        }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: released once; its scenes hold the device and are gone.
        unsafe { (self.library.api.release_device)(self.raw) }
    }
}

/// Error callback: keeps the first error until [`Device::check`] takes it.
unsafe extern "C" fn note_error(user: *mut c_void, code: c_int, message: *const c_char) {
    let text = if message.is_null() {
        String::new()
    } else {
        // SAFETY: Embree hands over a terminated string that lives through the call.
        unsafe { CStr::from_ptr(message) }.to_string_lossy().replace('\n', " ")
    };
    // SAFETY: `user` is the log of a device that lives.
    let log = unsafe { &*user.cast::<Log>() };
    log.error
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .get_or_insert_with(|| (code, format!("{}: {text}", error_name(code))));
}

/// Memory callback: counts the bytes and allows every allocation.
unsafe extern "C" fn note_memory(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `user` is the log of a device that lives.
    unsafe { &*user.cast::<Log>() }.bytes.fetch_add(bytes, Ordering::Relaxed);
    true
}
