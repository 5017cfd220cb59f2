//! What is put on trial.

use std::sync::Arc;

use crate::Result;
use crate::accel::native::{Kernel, Native, Scratch};
use crate::accel::{BuildQuality, BuildStats, Coherence, Intersector, Unbounded};
use crate::geometry::{Geometry, Hit, Hit8, Ray, Ray8};
use crate::simd::Mask8;

/// A path through a scene.
pub trait Candidate: Sync {
    /// What it builds.
    type Accel: Intersector + Send;

    /// The name in reports.
    fn name(&self) -> &'static str;

    /// Whether it promises the bits of testing everything in whatever company a ray is traced, and the tie rule.
    fn is_exact(&self) -> bool;

    /// Builds it over `geometry`, once for each way that rays can take through it.
    ///
    /// # Errors
    /// Where the path is not there, or asks for too much.
    fn build(&self, geometry: &[Geometry]) -> Result<Vec<Way<Self::Accel>>>;

    /// Whether what is built over `geometry` is sound inside, in words where it is not; where it can be told.
    fn validate(&self, geometry: &[Geometry]) -> std::result::Result<(), String> {
        let _ = geometry;
        Ok(())
    }
}

/// One way through a path.
#[derive(Debug)]
pub struct Way<I> {
    /// The name in messages.
    pub name: &'static str,
    /// What traces.
    pub accel: I,
}

impl<I: Intersector> Way<I> {
    /// The nearest hits of rays that share a mask.
    pub(super) fn closest(&self, rays: &[Ray], scratch: &mut I::Scratch) -> Vec<Hit> {
        let packets = Ray8::pack(rays);
        let mut hits = vec![Hit8::default(); packets.len()];
        self.accel.closest(&packets, &mut hits, Coherence::Incoherent, scratch);
        (0..rays.len()).map(|i| hits[i / 8].lane(i % 8)).collect()
    }

    /// Whether each of the rays, which share a mask, is blocked.
    pub(super) fn occluded(&self, rays: &[Ray], scratch: &mut I::Scratch) -> Vec<bool> {
        let packets = Ray8::pack(rays);
        let mut blocked = vec![Mask8::NONE; packets.len()];
        self.accel.occluded(&packets, &mut blocked, Coherence::Incoherent, scratch);
        (0..rays.len()).map(|i| blocked[i / 8].lane(i % 8)).collect()
    }
}

/// The native path: ray by ray, in packets, and as it would choose itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct NativePath {
    /// How its hierarchy is built.
    pub bvh: BuildQuality,
}

/// The native accelerator, held to one kernel.
#[derive(Clone, Debug)]
pub struct Held {
    native: Arc<Native>,
    kernel: Kernel,
}

impl Intersector for Held {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Scratch) {
        self.native.closest_with(self.kernel, rays, hits, coherence, scratch);
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Scratch) {
        self.native.occluded_with(self.kernel, rays, blocked, coherence, scratch);
    }

    fn build_stats(&self) -> BuildStats {
        self.native.build_stats()
    }
}

impl Candidate for NativePath {
    type Accel = Unbounded<Held>;

    fn name(&self) -> &'static str {
        "native"
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn build(&self, geometry: &[Geometry]) -> Result<Vec<Way<Self::Accel>>> {
        let native = Arc::new(Native::build_as(geometry, self.bvh));
        let way = |(name, kernel)| {
            let held = Held { native: Arc::clone(&native), kernel };
            Way { name, accel: Unbounded::new(held, geometry) }
        };
        Ok([
            ("single", Kernel::Single),
            ("packet", Kernel::Packet),
            ("batch", Kernel::Stream),
            ("stream", Kernel::Auto),
        ]
        .map(way)
        .into())
    }

    fn validate(&self, geometry: &[Geometry]) -> std::result::Result<(), String> {
        Native::build_as(geometry, self.bvh).validate(geometry)
    }
}

/// Embree, robust or fast: by calls of one ray, of eight and of sixteen.
#[cfg(feature = "embree")]
#[derive(Clone, Copy, Debug)]
pub struct EmbreePath {
    /// Robust or fast.
    pub mode: crate::accel::embree::Mode,
    /// How its scenes are built: as by its own quality that stands in for this one.
    pub bvh: BuildQuality,
}

#[cfg(feature = "embree")]
impl Candidate for EmbreePath {
    type Accel = Unbounded<crate::accel::embree::Embree>;

    fn name(&self) -> &'static str {
        match self.mode {
            crate::accel::embree::Mode::Robust => "embree robust",
            crate::accel::embree::Mode::Fast => "embree fast",
        }
    }

    fn is_exact(&self) -> bool {
        false
    }

    fn build(&self, geometry: &[Geometry]) -> Result<Vec<Way<Self::Accel>>> {
        use crate::accel::embree::{Embree, Options, Width};
        [("single", Width::One), ("packet", Width::Eight), ("pair", Width::Sixteen)]
            .into_iter()
            .map(|(name, width)| {
                // The batches are what is spread over threads.
                let (mode, quality) = (self.mode, self.bvh.into());
                let options = Options { mode, quality, width, threads: 1, ..Options::default() };
                let accel = Unbounded::new(Embree::build(geometry, &options)?, geometry);
                Ok(Way { name, accel })
            })
            .collect()
    }
}
