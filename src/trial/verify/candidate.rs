//! The accelerators under test.

use crate::Result;
use crate::accel::native::Native;
use crate::accel::{Accel, Backend, BuildOptions, BuildQuality, Coherence, Intersector};
use crate::geometry::{Geometry, Hit, Hit8, Ray, Ray8};
use crate::simd::Mask8;

/// An accelerator under test.
pub trait Candidate: Sync {
    /// The accelerator.
    type Accel: Intersector + Send;

    /// The name in reports.
    fn name(&self) -> &'static str;

    /// Returns true if it promises the bits of testing every primitive, in whatever packet a ray is traced, and the tie rule.
    fn is_exact(&self) -> bool;

    /// Builds it over `geometry`, once for each of its kernels.
    ///
    /// # Errors
    /// A limit, where the back end is not there or memory runs out.
    fn build(&self, geometry: &[Geometry]) -> Result<Vec<NamedAccel<Self::Accel>>>;

    /// Checks the invariants of the hierarchy over `geometry`, where they can be seen from outside.
    ///
    /// # Errors
    /// The first invariant that is broken, in words.
    fn validate(&self, geometry: &[Geometry]) -> std::result::Result<(), String> {
        let _ = geometry;
        Ok(())
    }
}

/// An accelerator held to one of its kernels.
#[derive(Clone, Debug)]
pub struct NamedAccel<I> {
    /// Name of the kernel.
    pub name: &'static str,
    /// The accelerator.
    pub accel: I,
}

impl<I: Intersector> NamedAccel<I> {
    /// The nearest hits of rays that share a mask.
    pub(super) fn closest(&self, rays: &[Ray], scratch: &mut I::Scratch) -> Vec<Hit> {
        let packets = Ray8::pack(rays);
        let mut hits = vec![Hit8::default(); packets.len()];
        self.accel.closest(&packets, &mut hits, Coherence::Incoherent, scratch);
        (0..rays.len()).map(|i| hits[i / 8].lane(i % 8)).collect()
    }

    /// For each of the rays, which share a mask: true if it is blocked.
    pub(super) fn occluded(&self, rays: &[Ray], scratch: &mut I::Scratch) -> Vec<bool> {
        let packets = Ray8::pack(rays);
        let mut blocked = vec![Mask8::NONE; packets.len()];
        self.accel.occluded(&packets, &mut blocked, Coherence::Incoherent, scratch);
        (0..rays.len()).map(|i| blocked[i / 8].lane(i % 8)).collect()
    }
}

/// A back end under test, by each of its kernels.
#[derive(Clone, Copy, Debug)]
pub struct UnderTest {
    /// The back end.
    pub backend: Backend,
    /// Quality of its hierarchies.
    pub bvh: BuildQuality,
}

impl Candidate for UnderTest {
    type Accel = Accel;

    fn name(&self) -> &'static str {
        self.backend.mode_name()
    }

    fn is_exact(&self) -> bool {
        self.backend.is_exact()
    }

    fn build(&self, geometry: &[Geometry]) -> Result<Vec<NamedAccel<Accel>>> {
        // One thread, because the batches of a group are spread over all threads.
        let accel = Accel::build(self.backend, geometry, BuildOptions { quality: self.bvh, threads: 1 })?;
        let mut all = accel.by_kernel().map(|(name, accel)| NamedAccel { name, accel }).to_vec();
        if self.backend == Backend::Native {
            all.push(NamedAccel { name: "stream", accel });
        }
        Ok(all)
    }

    fn validate(&self, geometry: &[Geometry]) -> std::result::Result<(), String> {
        match self.backend {
            Backend::Native => Native::try_build_as(geometry, self.bvh).map_err(|e| e.to_string())?.validate(geometry),
            Backend::Embree | Backend::EmbreeFast => Ok(()),
        }
    }
}
