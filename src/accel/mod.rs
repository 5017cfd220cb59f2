//! Intersection of rays with shapes. This room depends on neither scenes nor materials.
//!
//! [`Intersector`] is the contract of every path: the native hierarchy, Embree, and the `f64` arbiter. One test runs it
//! against all of them.

use std::time::Duration;

use crate::geometry::{Geometry, Hit, Hit8, Ray, Ray8, Shape};
use crate::simd::Mask8;

mod backend;
mod dispatch;
#[cfg_attr(not(feature = "embree"), path = "embree/absent.rs")]
pub mod embree;
pub mod native;
pub mod reference;
mod shafts;
mod unbounded;
pub mod walk;

pub use backend::Backend;
pub use dispatch::{Accel, BuildOptions};
pub use shafts::Shafts;
pub use unbounded::Unbounded;

/// Order of the rays in a stream, as declared by the caller. A back end may verify or ignore it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coherence {
    /// Neighbouring rays have almost the same direction: camera rays of a tile, shadow rays to one light.
    Coherent,
    /// Rays have any directions: rays that leave a curved surface.
    Incoherent,
}

crate::choice! {
    /// Work that goes into building the hierarchy; the picture is the same.
    ///
    /// Embree's qualities LOW, MEDIUM and HIGH stand for these levels if Embree builds.
    pub enum BuildQuality("bvh", derive(Eq, Hash), default(Default)) {
        /// Order of a Morton curve: the quickest build, for previews.
        "fast" => Fast,
        /// Surface area heuristic over bins.
        "default" => Default,
        /// The default, then improved by reinsertion: builds several times as long, for long renders.
        ///
        /// Gains most in scenes in which large and small triangles mix.
        "high" => High,
    }
}

/// Numbers of shapes, for messages about hierarchies that are too large.
#[derive(Clone, Copy, Debug)]
struct Counts {
    triangles: usize,
    spheres: usize,
}

impl Counts {
    fn of(geometry: &[Geometry]) -> Self {
        let mut counts = Self { triangles: 0, spheres: 0 };
        for g in geometry {
            match &g.shape {
                Shape::Mesh(mesh) => counts.triangles += mesh.triangles.len(),
                Shape::Sphere(_) => counts.spheres += 1,
                Shape::Plane(_) => {}
            }
        }
        counts
    }

    /// Returns `what` with the numbers.
    fn named(self, what: &str) -> String {
        let Self { triangles, spheres } = self;
        match (triangles, spheres) {
            (_, 0) => format!("{what} {triangles} triangles"),
            (0, _) => format!("{what} {spheres} spheres"),
            _ => format!("{what} {triangles} triangles and {spheres} spheres"),
        }
    }

    fn cure(self) -> &'static str {
        if self.triangles >= self.spheres { "take fewer triangles" } else { "take fewer spheres" }
    }
}

/// Intersection of rays with shapes. A hit counts if `t_min < t <= t_max`, on either side of a triangle.
///
/// If two hits of a ray have the same `t`, the lower (instance, geometry, primitive) is the nearest one, however the
/// rays were grouped. (Embree has its own rule for ties.)
///
/// Rays with a NaN or a zero direction, an empty interval or a NaN bound hit nothing and affect no other lane.
pub trait Intersector: Sync {
    /// Scratch memory of one thread: stacks and arenas, so that tracing allocates nothing once they have grown.
    type Scratch: Default + Send;

    /// Finds the nearest hit of every active lane, or a miss. Inactive lanes of `hits` are not changed.
    ///
    /// # Panics
    /// If the two slices differ in length.
    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Self::Scratch);

    /// Sets the lanes of `blocked` whose ray hits anything that it admits. Inactive lanes become false.
    ///
    /// # Panics
    /// If the two slices differ in length.
    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Self::Scratch);

    /// Returns the nearest hit of each ray, or a miss, in the order of the rays.
    ///
    /// It packs the rays and allocates memory; [`Intersector::closest`] does neither.
    fn hits(&self, rays: &[Ray]) -> Vec<Hit> {
        let mut scratch = Self::Scratch::default();
        let mut all = Vec::with_capacity(rays.len());
        for alike in rays.chunk_by(|a, b| a.admits == b.admits) {
            let packets = Ray8::pack(alike);
            let mut hits = vec![Hit8::default(); packets.len()];
            self.closest(&packets, &mut hits, Coherence::Incoherent, &mut scratch);
            all.extend((0..alike.len()).map(|i| hits[i / 8].lane(i % 8)));
        }
        all
    }

    /// Statistics of the build.
    fn build_stats(&self) -> BuildStats;

    /// Native's hierarchy over the same geometry, if it traces the rays.
    fn native(&self) -> Option<&native::Native> {
        None
    }
}

/// Statistics of building an accelerator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildStats {
    /// Number of triangles that can be hit.
    pub triangles: usize,
    /// Number of spheres that can be hit.
    pub spheres: usize,
    /// Number of infinite planes.
    pub planes: usize,
    /// Number of primitives left out: coordinates not finite or too large, corners that coincide, radii not above zero.
    pub dropped: usize,
    /// Number of inner nodes.
    pub nodes: usize,
    /// Number of leaves.
    pub leaves: usize,
    /// Levels of inner nodes from the root to the deepest leaf.
    pub depth: usize,
    /// Bytes held after the build, without the shapes.
    pub bytes: usize,
    /// Wall time of the build.
    pub time: Duration,
}

impl BuildStats {
    /// Returns the sum of two parts of one accelerator. The depth is the larger of the two.
    #[must_use]
    pub fn and(self, o: Self) -> Self {
        Self {
            triangles: self.triangles + o.triangles,
            spheres: self.spheres + o.spheres,
            planes: self.planes + o.planes,
            dropped: self.dropped + o.dropped,
            nodes: self.nodes + o.nodes,
            leaves: self.leaves + o.leaves,
            depth: self.depth.max(o.depth),
            bytes: self.bytes + o.bytes,
            time: self.time + o.time,
        }
    }
}
