//! Loading of the library, with a test of the structs that it writes.

#![allow(unsafe_code, reason = "calls into the Embree library")]

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use glam::Vec3;

use super::device::Device;
use super::find::{self, CURE};
use super::library::Library;
use super::options::{Frequency, Isa, Quality};
use super::scene::SceneBuilder;
use super::sys::{self, QueryArguments, Valid};
use crate::error::{Result, Unavailable};

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
}

impl Device {
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
        let api = self.api();
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
                let file = self.library().file.display();
                return Err(Unavailable::Unfit(format!("{file} misses a test triangle; {CURE}")).into());
            }
            past[k] = written[ends[k]..].iter().filter(|&&b| b != UNTOUCHED).count();
        }
        Ok(past)
    }
}
