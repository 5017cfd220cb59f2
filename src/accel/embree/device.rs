//! The loaded library and its devices, as owning types. Everything here is safe to call.
//!
//! MXCSR is left as Rust sets it, without flush-to-zero. Rust's arithmetic may not run under other modes, and the
//! native path, which is compared with this one, runs under the same. Embree sets its own mode for a build and restores
//! the old one.

#![allow(unsafe_code, reason = "calls into the Embree library")]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::Vec3;

use super::find::{self, CURE, Found};
use super::installed::Installed;
use super::options::{Frequency, Isa, Quality};
use super::scene::SceneBuilder;
use super::sys::{self, Api, QueryArguments, Valid};
use crate::error::{Error, Result, Unavailable};
use crate::system::{memory, threads};

/// Address space in bytes that each device maps for its own heap. Little of it is written.
const DEVICE_BYTES: u64 = 128 << 20;

/// Address space in bytes of each build thread: its stack and its part of the scheduler.
const THREAD_BYTES: u64 = 5 << 20;

/// Address space in bytes of the libraries that Embree depends on: TBB and the C++ runtime.
const BESIDE_BYTES: u64 = 16 << 20;

/// Cure in messages about a lack of memory for Embree.
pub(super) const WITHOUT: &str = "take --backend native";

/// The code of `RTC_ERROR_OUT_OF_MEMORY`.
const OUT_OF_MEMORY: c_int = 4;

/// Loaded library that passed all checks. It stays loaded until the program ends, because its worker threads do.
pub struct Library {
    api: Api,
    /// The file, or the bare name that the system's loader resolved.
    pub file: PathBuf,
    /// Rule that found the file, in a word or two.
    pub because: &'static str,
    /// Major, minor, patch.
    pub version: [u32; 3],
    /// Embree's tasking system by name.
    pub tasking: &'static str,
    /// True if 16-wide packets are traversed 16 wide on this CPU; otherwise Embree splits them.
    pub native16: bool,
    /// True if the library was built to test the geometry masks of rays.
    pub masks: bool,
}

/// Libraries loaded so far.
static LOADED: Mutex<Vec<&'static Library>> = Mutex::new(Vec::new());

impl Library {
    /// Loads the library from the folder `wished`, or from where [`find::find`] finds it. Each file is loaded once.
    ///
    /// # Errors
    /// [`Unavailable`] if the library is missing, cannot be loaded, lacks functions, is not version 4, or writes beyond
    /// the end of the structs that it is given.
    pub fn open(wished: Option<&Path>) -> Result<&'static Self> {
        let found = find::find(wished).map_err(|folder| Unavailable::NotFound {
            library: find::FILE_NAME,
            place: format!("in {} (EMBREE_DIR)", folder.display()),
            cure: format!("correct or unset that, or {CURE}"),
        })?;
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = loaded.iter().find(|l| l.file == found.file) {
            return Ok(known);
        }
        let fresh: &'static Self = Box::leak(Box::new(Self::load(&found)?));
        let past = Device::open(fresh, 1, Frequency::Widest, Isa::Best)?.bytes_written_past(sys::RAY_HIT_ENDS)?;
        if past != [0; 3] {
            let why = "was built for nested instances and would write past its hits; use another build";
            return Err(Unavailable::Unfit(format!("{} {why}", found.file.display())).into());
        }
        loaded.push(fresh);
        Ok(fresh)
    }

    /// Loads one file and reads its properties.
    fn load(found: &Found) -> Result<Self> {
        let file = found.file.display();
        // The size is unknown if only the system's loader can resolve the name.
        let size = std::fs::metadata(&found.file).map_or(0, |m| m.len());
        memory::need_mapped(&format!("Embree ({file})"), size + BESIDE_BYTES + DEVICE_BYTES, WITHOUT)?;
        // SAFETY: loading runs the library's initialisers; Embree's and TBB's have no preconditions. What else may
        // bear this name is the word of whoever set EMBREE_DIR or administers the system.
        let handle = unsafe { libloading::Library::new(&found.file) }.map_err(|e| {
            if found.file == Path::new(find::FILE_NAME) {
                let (place, cure) = (String::from("on this system"), CURE.into());
                return Unavailable::NotFound { library: find::FILE_NAME, place, cure };
            }
            Unavailable::Unfit(format!("cannot load {file}: {e}; {CURE}").replace('\n', " "))
        })?;
        // Worker threads may still run the library's code when the program ends, so it is never unloaded.
        let handle: &'static libloading::Library = Box::leak(Box::new(handle));
        // SAFETY: the handle is never dropped; a library that is not Embree 4 lacks one of the names or, being an
        // older Embree, is refused below before any function is called that changed since.
        let api = unsafe { Api::load(handle) }
            .map_err(|name| Unavailable::Unfit(format!("{file} has no {name}, so it is not Embree 4; {CURE}")))?;
        let config = c"verbose=0,threads=1";
        threads::probe(1)?;
        // SAFETY: a terminated string; the function is the same in all versions.
        let device = unsafe { (api.new_device)(config.as_ptr()) };
        if device.is_null() {
            // SAFETY: null asks for the error of this thread.
            let code = unsafe { (api.device_error)(std::ptr::null_mut()) };
            return Err(reported(code, format!("{file} makes no device: {}", error_name(code))));
        }
        // SAFETY: a device that was just made; unknown properties are answered by 0.
        let property = |which| unsafe { (api.device_property)(device, which) };
        let version = property(sys::PROPERTY_VERSION).unsigned_abs() as u32;
        let version = [version / 10_000, version / 100 % 100, version % 100];
        let [native16, masks, culling] =
            [sys::PROPERTY_NATIVE_RAY16, sys::PROPERTY_RAY_MASK, sys::PROPERTY_BACKFACE_CULLING]
                .map(|p| property(p) != 0);
        let tasking = match property(sys::PROPERTY_TASKING_SYSTEM) {
            1 => "TBB",
            2 => "PPL",
            _ => "internal",
        };
        // SAFETY: released once, not used again.
        unsafe { (api.release_device)(device) };
        if version[0] != 4 {
            return Err(
                Unavailable::Version { library: file.to_string(), found: version, needed: 4, cure: CURE }.into()
            );
        }
        if culling {
            return Err(Unavailable::Unfit(format!("{file} was built to cull back faces; {CURE}")).into());
        }
        Ok(Self { api, file: found.file.clone(), because: found.because, version, tasking, native16, masks })
    }

    /// Description for reports.
    #[must_use]
    pub fn installed(&self) -> Installed {
        let [major, minor, patch] = self.version;
        let isa = match self.native16 {
            true => "AVX-512",
            false if has_avx2() => "AVX2",
            false => "narrower than AVX2",
        };
        Installed {
            version: format!("{major}.{minor}.{patch}"),
            isa,
            tasking: self.tasking,
            file: self.file.display().to_string(),
            found_by: self.because,
        }
    }
}

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
    /// [`Unavailable`] if Embree makes no device; a limit if there is not enough memory or threads.
    pub fn open(library: &'static Library, threads: usize, frequency: Frequency, isa: Isa) -> Result<Arc<Self>> {
        let workers = if threads == 0 { std::thread::available_parallelism().map_or(1, usize::from) } else { threads };
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

    /// Returns the numbers of bytes that the library writes beyond `ends` into a ray with hit, when 1, 8 and 16 rays
    /// hit. The numbers are 0 if the structs are long enough. The calls use a buffer with ample room.
    ///
    /// # Errors
    /// As [`SceneBuilder::commit`].
    pub fn bytes_written_past(self: &Arc<Self>, ends: [usize; 3]) -> Result<[usize; 3]> {
        const ROOM: usize = 16 * 1024;
        const UNTOUCHED: u8 = 0xA5;
        #[repr(C, align(64))]
        struct Buffer([u8; ROOM]);

        let mut scene = SceneBuilder::new(self, true, Quality::Medium)?;
        scene.triangles(
            0,
            u32::MAX,
            &[Vec3::NEG_ONE, Vec3::new(3.0, -1.0, -1.0), Vec3::new(-1.0, 3.0, -1.0)],
            &[[0, 1, 2]],
        )?;
        let scene = scene.commit()?;
        let mut buffer = Box::new(Buffer([UNTOUCHED; ROOM]));
        let start: *mut u8 = std::ptr::from_mut(&mut *buffer).cast();
        let arguments = QueryArguments::new(sys::QUERY_INCOHERENT);
        let api = &self.library.api;
        let mut past = [0; 3];
        for (k, n) in [1, 8, 16].into_iter().enumerate() {
            buffer.0.fill(UNTOUCHED);
            // The fields of a ray in order: from the origin along -z, to infinity, with every mask bit.
            let mut ray = [0_u32; 12];
            ray[6] = (-1.0_f32).to_bits();
            ray[8] = f32::INFINITY.to_bits();
            ray[9] = u32::MAX;
            for (field, value) in ray.into_iter().enumerate() {
                for lane in 0..n {
                    buffer.0[4 * (field * n + lane)..][..4].copy_from_slice(&value.to_ne_bytes());
                }
            }
            for lane in 0..n {
                buffer.0[4 * (18 * n + lane)..][..4].copy_from_slice(&sys::INVALID_GEOMETRY.to_ne_bytes());
            }
            let valid = Valid([-1; 16]);
            // SAFETY: the buffer is aligned for all widths, holds rays in each one's layout, and is longer than any
            // build of Embree writes (1344 bytes at 16 lanes, and 128 more a further instance level).
            unsafe {
                match n {
                    1 => (api.intersect1)(scene.raw(), start.cast(), &arguments),
                    8 => (api.intersect8)(valid.0.as_ptr(), scene.raw(), start.cast(), &arguments),
                    _ => (api.intersect16)(valid.0.as_ptr(), scene.raw(), start.cast(), &arguments),
                }
            }
            let written = std::hint::black_box(&buffer.0);
            let hit = (0..n).all(|lane| written[4 * (18 * n + lane)..][..4] == [0; 4]);
            if !hit {
                let file = self.library.file.display();
                return Err(Unavailable::Unfit(format!("{file} misses a test triangle; {CURE}")).into());
            }
            past[k] = written[ends[k]..].iter().filter(|&&b| b != UNTOUCHED).count();
        }
        Ok(past)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: released once; its scenes hold the device and are gone.
        unsafe { (self.library.api.release_device)(self.raw) }
    }
}

/// Returns true if the CPU has 8-wide integer vectors, which `simd256` needs.
fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    false
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

/// Converts an error code of Embree with its message.
fn reported(code: c_int, message: String) -> Error {
    if code == OUT_OF_MEMORY {
        memory::ran_out("Embree's hierarchy", WITHOUT)
    } else {
        Unavailable::Failed(message).into()
    }
}

/// Memory callback: counts the bytes and allows every allocation.
unsafe extern "C" fn note_memory(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `user` is the log of a device that lives.
    unsafe { &*user.cast::<Log>() }.bytes.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// Name of an `RTCError` in words.
fn error_name(code: c_int) -> &'static str {
    match code {
        1 => "unknown error",
        2 => "invalid argument",
        3 => "invalid operation",
        4 => "out of memory",
        5 => "unsupported CPU",
        6 => "cancelled",
        _ => "error",
    }
}
