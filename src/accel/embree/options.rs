//! Options of the Embree back end.

use std::path::PathBuf;

use crate::accel::BuildQuality;

/// Options of building and tracing. Only `mode` and `spheres` change hits, apart from ties.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Robust or fast.
    pub mode: Mode,
    /// Build quality of the hierarchy.
    pub quality: Quality,
    /// Choice of the width of nodes.
    pub frequency: Frequency,
    /// Instructions that Embree may use.
    pub isa: Isa,
    /// Number of rays in a call.
    pub width: Width,
    /// Implementation of the sphere test.
    pub spheres: Spheres,
    /// Number of build threads; 0 means one per processor. Rays are traced by the calling threads.
    pub threads: usize,
    /// Builds even over shapes that Embree would lose ([`super::reach`]), which is an error otherwise.
    pub even_lost: bool,
    /// Folder of the library, instead of `EMBREE_DIR` and the other usual places.
    pub library: Option<PathBuf>,
}

/// The accuracy of Embree's triangle and box tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// `RTC_SCENE_FLAG_ROBUST`: Plücker triangle test and conservative boxes. Almost no rays are lost between
    /// neighbours.
    #[default]
    Robust,
    /// Möller-Trumbore triangle test and fused slab test: 20 to 30 % faster, but rays at edges may be lost. `t` is
    /// compared with the interval before it is rounded, so a hit within an ulp of either end may be found or missed.
    Fast,
}

/// `RTCBuildQuality`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum Quality {
    /// Order of a Morton curve: the quickest build, meant for geometry that changes every frame.
    Low = 0,
    /// Binned surface area heuristic.
    #[default]
    Medium = 1,
    /// Surface area heuristic with spatial splits. In robust mode Embree has no such splits and builds as for `Medium`.
    High = 2,
}

impl From<BuildQuality> for Quality {
    /// Embree's quality that corresponds to one of the native hierarchy.
    fn from(quality: BuildQuality) -> Self {
        match quality {
            BuildQuality::Fast => Self::Low,
            BuildQuality::Default => Self::Medium,
            BuildQuality::High => Self::High,
        }
    }
}

/// Embree's `frequency_level`, which determines the width of its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frequency {
    /// `simd256` on every CPU with AVX2, which gives 8-wide nodes. This is 10 to 25 % faster than Embree's own choice
    /// on CPUs for which that is 4-wide.
    #[default]
    Widest,
    /// Embree's own choice for the CPU that it detects.
    Own,
}

/// Instructions that Embree may use. Below AVX-512 its reciprocals are refined estimates, so `t` may be an ulp off
/// where it is exact otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Isa {
    /// All instructions of the CPU.
    #[default]
    Best,
    /// Up to SSE 4.2.
    Sse42,
    /// Up to AVX.
    Avx,
    /// Up to AVX2, as the native path's eight lanes of `f32`.
    Avx2,
    /// Up to AVX-512.
    Avx512,
}

impl Isa {
    /// All levels except [`Isa::Best`].
    pub const LEVELS: [Self; 4] = [Self::Sse42, Self::Avx, Self::Avx2, Self::Avx512];

    /// Embree's name of the level; none for [`Isa::Best`].
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

/// Number of rays in a call of Embree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Width {
    /// Chosen by coherence, the number of active lanes and the CPU.
    #[default]
    Auto,
    /// Single rays: `rtcIntersect1`.
    One,
    /// Packets of 8: `rtcIntersect8`.
    Eight,
    /// Packets of 16: `rtcIntersect16`. Without AVX-512 Embree splits them.
    Sixteen,
}

/// Implementation of the sphere test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spheres {
    /// The native path's own function, called back by Embree. Both paths give the same bits.
    #[default]
    Native,
    /// Embree's sphere points, for comparing speed. Their hits have other bits.
    Points,
}
