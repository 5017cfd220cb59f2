//! Stand-in for the Embree back end in builds without the feature `embree`: the same types and functions, of which
//! none can be built.

use crate::accel::{BuildStats, Coherence, Intersector};
use crate::error::{Result, Unavailable};
use crate::geometry::{Geometry, Hit8, Ray8};
use crate::simd::Mask8;

mod installed;
mod options;
pub mod reach;

pub use installed::Installed;
pub use options::{Frequency, Isa, Mode, Options, Quality, Spheres, Width};

/// True in builds with the feature `embree`.
pub const COMPILED_IN: bool = false;

/// Embree's hierarchy, of which there is none.
#[derive(Clone, Debug)]
pub enum Embree {}

/// Rays in Embree's layout, of which there are none.
#[derive(Debug, Default)]
pub struct Packed(());

/// Room for a call, which none needs.
#[derive(Debug, Default)]
pub struct Scratch(());

/// Fails.
///
/// # Errors
/// [`Unavailable::NotCompiledIn`].
pub fn installed() -> std::result::Result<Installed, Unavailable> {
    Err(Unavailable::NotCompiledIn)
}

#[allow(clippy::missing_errors_doc, reason = "as in builds with the feature; none can be called but `build`")]
impl Embree {
    /// Fails.
    ///
    /// # Errors
    /// [`Unavailable::NotCompiledIn`].
    pub fn build(_: &[Geometry], _: &Options) -> Result<Self> {
        Err(Unavailable::NotCompiledIn.into())
    }

    /// Returns the same hierarchy, traced by calls of this width.
    #[must_use]
    pub fn with_width(&self, _: Width) -> Self {
        match *self {}
    }

    /// The library that traces.
    #[must_use]
    pub fn library(&self) -> Installed {
        match *self {}
    }

    /// Puts rays into `Packed`.
    pub fn pack(&self, _: &[Ray8], _: Width, _: bool, _: &mut Packed) {
        match *self {}
    }

    /// Traces packed rays.
    pub fn trace_packed(&self, _: &mut Packed, _: Coherence) {
        match *self {}
    }

    /// Reads hits out of `Packed`.
    pub fn unpack(&self, _: &Packed, _: &[Ray8], _: &mut [Hit8]) {
        match *self {}
    }

    /// Reads blocked lanes out of `Packed`.
    pub fn unpack_blocked(&self, _: &Packed, _: &[Ray8], _: &mut [Mask8]) {
        match *self {}
    }
}

impl Intersector for Embree {
    type Scratch = Scratch;

    fn closest(&self, _: &[Ray8], _: &mut [Hit8], _: Coherence, _: &mut Scratch) {
        match *self {}
    }

    fn occluded(&self, _: &[Ray8], _: &mut [Mask8], _: Coherence, _: &mut Scratch) {
        match *self {}
    }

    fn build_stats(&self) -> BuildStats {
        match *self {}
    }
}
