//! Finding what a ray meets. Knows shapes, and neither scenes nor materials.
//!
//! [`Intersector`] is the contract that every path keeps: the native hierarchy, Embree, and the `f64` arbiter; one
//! test runs it against all of them.

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

/// What the caller knows of a stream's order. A back end may check it, and may ignore it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coherence {
    /// Neighbouring rays go almost the same way: camera rays of a tile, shadow rays to one light.
    Coherent,
    /// Rays go anywhere: what leaves a curved surface.
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

    /// `what` and the numbers.
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

/// Rays against shapes. `t_min < t <= t_max` counts as met; so does either face of a triangle.
///
/// Where two hits of a ray have the same `t`, the lower (instance, geometry, primitive) is the nearest one, however
/// the rays were grouped. (Embree settles its ties its own way.)
///
/// Rays with a NaN or a zero direction, an empty interval or a NaN bound meet nothing and disturb no other lane.
pub trait Intersector: Sync {
    /// Arenas and stacks, one a thread, so that tracing allocates nothing once warm.
    type Scratch: Default + Send;

    /// The nearest hit of every active lane, or a miss. Inactive lanes of `hits` are left untouched.
    ///
    /// # Panics
    /// Where the two slices differ in length.
    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Self::Scratch);

    /// Whether anything that the ray admits is met. Inactive lanes of `blocked` come out false.
    ///
    /// # Panics
    /// Where the two slices differ in length.
    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Self::Scratch);

    /// Returns the nearest hit of each ray, or a miss, in the order of the rays.
    ///
    /// It packs rays and allocates; [`Intersector::closest`] does neither.
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

    /// What was built.
    fn build_stats(&self) -> BuildStats;

    /// Native's hierarchy over the same geometry, where the rays go through it.
    fn native(&self) -> Option<&native::Native> {
        None
    }
}

/// What building an accelerator came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildStats {
    /// Triangles that can be hit.
    pub triangles: usize,
    /// Spheres that can be hit.
    pub spheres: usize,
    /// Infinite planes.
    pub planes: usize,
    /// Primitives left out: coordinates not finite or too large, corners that coincide, radii not above zero.
    pub dropped: usize,
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Levels of inner nodes from the root to the deepest leaf.
    pub depth: usize,
    /// Bytes held after the build, shapes apart.
    pub bytes: usize,
    /// Wall time of the build.
    pub time: Duration,
}

impl BuildStats {
    /// The sum of two parts of one accelerator (the deeper depth of the two).
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
