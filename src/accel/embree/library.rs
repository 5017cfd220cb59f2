//! The loaded library. Everything here is safe to call.

#![allow(unsafe_code, reason = "calls into the Embree library")]

use std::path::{Path, PathBuf};

use super::failure::{WITHOUT, error_name, reported};
use super::find::{self, CURE, FoundLibrary};
use super::installed::Installed;
use super::sys::{self, Api};
use crate::error::{Result, Unavailable};
use crate::system::{memory, threads};

/// Address space in bytes that each device maps for its own heap. Little of it is written.
pub(super) const DEVICE_BYTES: u64 = 128 << 20;

/// Address space in bytes of the libraries that Embree depends on: TBB and the C++ runtime.
const BESIDE_BYTES: u64 = 16 << 20;

/// Loaded library that passed all checks. It stays loaded until the program ends, because its worker threads do.
pub struct Library {
    pub(super) api: Api,
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

impl Library {
    /// Loads one file and reads its properties.
    pub(super) fn load(found: &FoundLibrary) -> Result<Self> {
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

/// Returns true if the CPU has 8-wide integer vectors, which `simd256` needs.
pub(super) fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    false
}
