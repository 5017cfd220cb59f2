//! Embree 4 as an [`Intersector`](crate::accel::Intersector), like the native path.
//!
//! The library is loaded at run time (`library.rs`). Packets are converted to its structs and hits back (`packet.rs`).
//! Spheres use the native path's own test (`sphere.rs`). So only the traversal and the triangle test differ.
//!
//! Differences from the native path: ties are settled by Embree's own rule. Hits behind the ray's origin, or nearer
//! than 2^-125, are not found. In robust mode `t_min < t <= t_max` holds for the `t` that is reported; in fast mode it
//! is tested before `t` is rounded.

use crate::error::{Error, Unavailable};

pub mod device;
mod failure;
mod fill;
pub mod find;
mod fit;
mod hierarchy;
mod installed;
mod library;
mod options;
mod packed;
mod packet;
pub mod reach;
pub mod scene;
mod sphere;
/// Public only for the tests of the structs' sizes.
#[doc(hidden)]
pub mod sys;

pub use hierarchy::{Embree, Scratch};
pub use installed::Installed;
pub use library::Library;
pub use options::{Frequency, Isa, Mode, Options, Quality, Spheres, Width};
pub use packed::Packed;

/// True in builds with the feature `embree`.
pub const COMPILED_IN: bool = true;

/// Loads the library and describes it.
///
/// # Errors
/// [`Unavailable`] if it is missing or unfit.
pub fn installed() -> Result<Installed, Unavailable> {
    match Library::open(None) {
        Ok(library) => Ok(library.installed()),
        Err(Error::Unavailable(why)) => Err(why),
        Err(Error::TooLarge(why)) => Err(why.into()),
        Err(other) => Err(Unavailable::Failed(other.to_string())),
    }
}

#[cfg(test)]
mod tests;
