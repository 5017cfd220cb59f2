//! What may be asked of Embree.

use std::path::PathBuf;

use crate::accel::BuildQuality;

/// How a scene is built and traced. None of the choices but `mode` and `spheres` changes what is hit, ties apart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Robust or fast.
    pub mode: Mode,
    /// How much work the build puts into the hierarchy.
    pub quality: Quality,
    /// How wide its nodes are.
    pub frequency: Frequency,
    /// Which instructions it may use.
    pub isa: Isa,
    /// How many rays go into a call.
    pub width: Width,
    /// What intersects spheres.
    pub spheres: Spheres,
    /// Build threads; 0 is one a processor. (Rays are traced by the threads that ask.)
    pub threads: usize,
    /// Builds over shapes, too, that Embree would lose ([`super::reach`]), where this is an error otherwise.
    pub even_lost: bool,
    /// The folder with the library, instead of the one in `EMBREE_DIR` and the other usual places.
    pub library: Option<PathBuf>,
}

/// The accuracy of Embree's triangle and box tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// `RTC_SCENE_FLAG_ROBUST`: Plücker triangle test, conservative boxes; next to no rays lost between neighbours.
    #[default]
    Robust,
    /// Möller-Trumbore and fused slabs: 20 to 30 % faster, and rays at edges may be lost. `t` is compared with the
    /// interval before it is rounded, so a hit within an ulp of either end may be seen or missed.
    Fast,
}

/// `RTCBuildQuality`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum Quality {
    /// Morton order: the quickest build, for bounding boxes that change each frame.
    Low = 0,
    /// Binned surface area heuristic.
    #[default]
    Medium = 1,
    /// With spatial splits; in robust mode Embree has none and builds as for `Medium`.
    High = 2,
}

impl From<BuildQuality> for Quality {
    /// What stands in for a quality of the native hierarchy.
    fn from(quality: BuildQuality) -> Self {
        match quality {
            BuildQuality::Fast => Self::Low,
            BuildQuality::Default => Self::Medium,
            BuildQuality::High => Self::High,
        }
    }
}

/// Embree's `frequency_level`, by which it chooses the width of its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frequency {
    /// `simd256` wherever the CPU has AVX2, that is 8-wide nodes: 10 to 25 % faster than its own choice on CPUs for
    /// which that is 4-wide.
    #[default]
    Widest,
    /// Whatever Embree chooses for the CPU it believes to run on.
    Own,
}

/// The instructions that Embree may use. Below AVX-512 its reciprocals are refined guesses, and `t` may be an ulp off
/// where it is exact otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Isa {
    /// All that the CPU has.
    #[default]
    Best,
    /// Up to SSE 4.2.
    Sse42,
    /// Up to AVX.
    Avx,
    /// Up to AVX2, what eight lanes of `f32` in the native path use.
    Avx2,
    /// Up to AVX-512.
    Avx512,
}

impl Isa {
    /// All but [`Isa::Best`].
    pub const LEVELS: [Self; 4] = [Self::Sse42, Self::Avx, Self::Avx2, Self::Avx512];

    /// Embree's name for it; none for [`Isa::Best`].
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Best => None,
            Self::Sse42 => Some("sse4.2"),
            Self::Avx => Some("avx"),
            Self::Avx2 => Some("avx2"),
            Self::Avx512 => Some("avx512"),
        }
    }
}

/// How many rays go into a call of Embree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Width {
    /// By coherence, by how many lanes hold a ray, and by what the CPU has.
    #[default]
    Auto,
    /// One at a time: `rtcIntersect1`.
    One,
    /// A packet at a time: `rtcIntersect8`.
    Eight,
    /// Two packets at a time: `rtcIntersect16`. Without AVX-512 Embree takes them apart again.
    Sixteen,
}

/// What intersects spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spheres {
    /// The native path's own function, called back by Embree: the same bits in both.
    #[default]
    Native,
    /// Embree's sphere points, to compare speed with: other bits.
    Points,
}
