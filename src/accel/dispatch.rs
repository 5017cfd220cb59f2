//! An accelerator of any back end, chosen at run time.

use std::sync::Arc;

use super::backend::Backend;
use super::embree::{self, Embree, Installed, Width};
use super::native::{self, Kernel, Native};
use super::unbounded::Unbounded;
use super::{BuildQuality, BuildStats, Coherence, Intersector};
use crate::error::Result;
use crate::geometry::{Geometry, Hit8, Ray8};
use crate::simd::Mask8;

/// Options of a build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildOptions {
    /// Build quality of the hierarchy. Embree uses its own quality that comes closest.
    pub quality: BuildQuality,
    /// Number of threads of Embree's build; 0 means one per processor. The native back end builds in rayon's current
    /// pool.
    pub threads: usize,
}

impl From<BuildQuality> for BuildOptions {
    fn from(quality: BuildQuality) -> Self {
        Self { quality, ..Self::default() }
    }
}

/// Meshes, spheres and infinite planes, ready for rays. The back end is dispatched once per stream; inside a stream all
/// calls are static. Clones share the hierarchy.
#[derive(Clone)]
pub struct Accel {
    backend: Backend,
    hierarchy: Unbounded<Hierarchy>,
}

/// A hierarchy and its kernel.
#[derive(Clone)]
enum Hierarchy {
    Native(Arc<Native>, Kernel),
    Embree(Embree),
}

/// Scratch memory of the back end in use.
#[derive(Default)]
pub struct Scratch {
    native: Option<native::Scratch>,
    embree: embree::Scratch,
}

impl Accel {
    /// Builds the hierarchy of `backend` over `geometry`. The geometry index of a hit is the index in this list.
    /// Primitives that no ray can hit are dropped and counted ([`BuildStats::dropped`]).
    ///
    /// # Errors
    /// [`Error::Unavailable`](crate::Error::Unavailable) if the back end is not there or would lose a shape; a limit if
    /// there is not enough memory.
    pub fn build(backend: Backend, geometry: &[Geometry], options: impl Into<BuildOptions>) -> Result<Self> {
        let BuildOptions { quality, threads } = options.into();
        let hierarchy = match backend.mode() {
            None => Hierarchy::Native(Native::try_build_as(geometry, quality)?.into(), Kernel::Auto),
            Some(mode) => {
                let options = embree::Options { mode, quality: quality.into(), threads, ..Default::default() };
                Hierarchy::Embree(Embree::build(geometry, &options)?)
            }
        };
        Ok(Self { backend, hierarchy: Unbounded::new(hierarchy, geometry) })
    }

    /// Back end that traces the rays.
    #[must_use]
    pub fn backend(&self) -> Backend {
        self.backend
    }

    /// Embree's hierarchy, if Embree traces the rays.
    #[must_use]
    pub fn embree(&self) -> Option<&Embree> {
        match self.hierarchy.inner() {
            Hierarchy::Native(..) => None,
            Hierarchy::Embree(embree) => Some(embree),
        }
    }

    /// Library that traces the rays; none for the native back end.
    #[must_use]
    pub fn library(&self) -> Option<Installed> {
        self.embree().map(Embree::library)
    }

    /// Returns this accelerator restricted to each single kernel, with the kernel's name: single rays, packets of 8,
    /// and native's ray streams or Embree's packets of 16. The hits are the same, except for Embree's ties.
    #[must_use]
    pub fn by_kernel(&self) -> [(&'static str, Self); 3] {
        let with = |hierarchy| Self { backend: self.backend, hierarchy: self.hierarchy.with_inner(hierarchy) };
        match self.hierarchy.inner() {
            Hierarchy::Native(native, _) => {
                [("single", Kernel::Single), ("packet", Kernel::Packet), ("batch", Kernel::Stream)]
                    .map(|(name, kernel)| (name, with(Hierarchy::Native(Arc::clone(native), kernel))))
            }
            Hierarchy::Embree(embree) => [("single", Width::One), ("packet", Width::Eight), ("pair", Width::Sixteen)]
                .map(|(name, width)| (name, with(Hierarchy::Embree(embree.with_width(width))))),
        }
    }
}

impl Intersector for Accel {
    type Scratch = super::unbounded::Scratch<Scratch>;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Self::Scratch) {
        self.hierarchy.closest(rays, hits, coherence, scratch);
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Self::Scratch) {
        self.hierarchy.occluded(rays, blocked, coherence, scratch);
    }

    fn build_stats(&self) -> BuildStats {
        self.hierarchy.build_stats()
    }

    fn native(&self) -> Option<&Native> {
        self.hierarchy.native()
    }
}

impl Intersector for Hierarchy {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Scratch) {
        match self {
            Self::Native(native, kernel) => {
                native.closest_with(*kernel, rays, hits, coherence, scratch.native.get_or_insert_default());
            }
            Self::Embree(embree) => embree.closest(rays, hits, coherence, &mut scratch.embree),
        }
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Scratch) {
        match self {
            Self::Native(native, kernel) => {
                native.occluded_with(*kernel, rays, blocked, coherence, scratch.native.get_or_insert_default());
            }
            Self::Embree(embree) => embree.occluded(rays, blocked, coherence, &mut scratch.embree),
        }
    }

    fn build_stats(&self) -> BuildStats {
        match self {
            Self::Native(native, _) => native.build_stats(),
            Self::Embree(embree) => embree.build_stats(),
        }
    }

    fn native(&self) -> Option<&Native> {
        match self {
            Self::Native(native, _) => Some(native),
            Self::Embree(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::{GeometryMask, Plane, Ray, Shape, Sphere};

    #[test]
    fn planes_are_part_of_every_accelerator_and_of_each_of_its_kernels() {
        let floor = Shape::Plane(Plane { point: Vec3::ZERO, normal: Vec3::Y });
        let ball = Shape::Sphere(Sphere { centre: Vec3::new(0.0, 5.0, 0.0), radius: 1.0 });
        let geometry = [floor, ball].map(|shape| Geometry { shape, mask: GeometryMask::OPAQUE });
        let rays = Ray8::pack(&[Ray::new(Vec3::Y, Vec3::NEG_Y), Ray::new(Vec3::Y, Vec3::Y)]);
        for backend in Backend::ALL.into_iter().filter(|b| b.availability().is_ok()) {
            let accel = Accel::build(backend, &geometry, BuildOptions::default()).unwrap();
            assert_eq!((accel.backend(), accel.build_stats().planes, accel.build_stats().spheres), (backend, 1, 1));
            let kernels = accel.by_kernel().map(|(_, accel)| accel);
            for accel in kernels.iter().chain([&accel]) {
                let mut hits = [Hit8::default()];
                accel.closest(&rays, &mut hits, Coherence::Incoherent, &mut Default::default());
                assert_eq!([0, 1].map(|i| (hits[0].lane(i).t, hits[0].geometry[i])), [(1.0, 0), (3.0, 1)]);
            }
        }
    }
}
