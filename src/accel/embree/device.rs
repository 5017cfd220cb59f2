//! The loaded library and its devices, with owners. Everything here is safe to call.
//!
//! MXCSR is left as Rust has it, without flush-to-zero: Rust's arithmetic may not run under other modes, and the
//! native path, which is compared with this one, runs under the same. (Embree sets its own for its build and puts the
//! old one back.)

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

/// Address space that each device maps when it is made (a heap of its own) and writes little of.
const DEVICE_BYTES: u64 = 128 << 20;

/// Address space that each build thread takes: its stack and its part of the scheduler.
const THREAD_BYTES: u64 = 5 << 20;

/// Address space that the libraries take which Embree needs: TBB and the C++ runtime.
const BESIDE_BYTES: u64 = 16 << 20;

/// The way out where Embree finds no memory.
pub(super) const WITHOUT: &str = "take --backend native";

/// The code of `RTC_ERROR_OUT_OF_MEMORY`.
const OUT_OF_MEMORY: c_int = 4;

/// One loaded library that was found fit for use. It stays loaded until the program ends: its worker threads do, too.
pub struct Library {
    api: Api,
    /// The file, or the bare name that the system's loader resolved.
    pub file: PathBuf,
    /// How the file was found, in a word or two.
    pub because: &'static str,
    /// Major, minor, patch.
    pub version: [u32; 3],
    /// Embree's tasking system by name.
    pub tasking: &'static str,
    /// Whether 16-wide packets are traversed as such on this CPU.
    pub native16: bool,
    /// Whether it looks at geometry masks.
    pub masks: bool,
}

/// The libraries that were loaded so far.
static LOADED: Mutex<Vec<&'static Library>> = Mutex::new(Vec::new());

impl Library {
    /// Loads the library, from the folder `wished` or where [`find::find`] finds it, once for each file.
    ///
    /// # Errors
    /// [`Unavailable`] where it is missing, cannot be loaded, lacks functions, is not version 4, or writes past the
    /// end of the structs it is given.
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

    /// Loads one file and asks it what it is.
    fn load(found: &Found) -> Result<Self> {
        let file = found.file.display();
        // Where only the system's loader knows the file, there is no size to ask for.
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

    /// Its description for reports.
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

/// What Embree reports of a device behind our back.
#[derive(Default)]
struct Log {
    /// The first error: its code, and what Embree says of it.
    error: Mutex<Option<(c_int, String)>>,
    bytes: AtomicIsize,
}

/// An Embree device: its configuration, worker threads and memory account.
pub struct Device {
    library: &'static Library,
    raw: sys::RtcDevice,
    /// At a fixed address, because Embree holds it. Freed after the device, whose last scene holds the device.
    log: Arc<Log>,
}

// SAFETY: Embree's devices may be used from any thread (API manual, section on threads); the log is Sync.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

impl Device {
    /// A device with `threads` build threads (0: one a processor).
    ///
    /// # Errors
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

    /// The library it was made by.
    #[must_use]
    pub fn library(&self) -> &'static Library {
        self.library
    }

    /// Whether 16-wide packets are traversed as such with the instructions it uses.
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

    /// The device's address, valid while `self` is.
    pub(super) fn raw(&self) -> sys::RtcDevice {
        self.raw
    }

    /// The functions to call with it.
    pub(super) fn api(&self) -> &'static Api {
        &self.library.api
    }

    /// Fails with what Embree has reported since the last call.
    pub(super) fn check(&self) -> Result<()> {
        match self.log.error.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some((code, message)) => Err(reported(code, message)),
            None => Ok(()),
        }
    }

    /// How many bytes beyond `ends` the library writes into a ray with hit, eight and sixteen of them, when they hit:
    /// [0, 0, 0] for structs that are long enough. The calls are made on a buffer with ample room.
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

/// Whether the CPU has 8-wide integer vectors, which `simd256` needs.
fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Keeps the first error until it is asked for.
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

/// The error for what Embree reports.
fn reported(code: c_int, message: String) -> Error {
    if code == OUT_OF_MEMORY {
        memory::ran_out("Embree's hierarchy", WITHOUT)
    } else {
        Unavailable::Failed(message).into()
    }
}

/// Keeps count of the bytes; always agrees.
unsafe extern "C" fn note_memory(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `user` is the log of a device that lives.
    unsafe { &*user.cast::<Log>() }.bytes.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// `RTCError` in words.
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
