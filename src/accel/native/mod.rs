//! The native accelerator: an eight-wide bounding volume hierarchy over triangles, and another one over exact spheres.
//!
//! Kernels test one ray against eight boxes or primitives, or eight rays against one. Every kernel gives every ray the same
//! bits as testing all primitives one after the other. `geometry/slab.rs` proves that no box loses a hit,
//! `geometry/triangle.rs` that no ray passes between triangles with a common edge.

pub(super) mod build;
pub(super) mod node;
mod ray;
mod shaft;
mod traverse;
mod validate;

use std::time::Instant;

use rayon::prelude::*;

use self::build::collapse;
use self::build::primitive::PrimRef;
use self::node::bvh8::{Bvh8, Node8};
use self::node::sphere8::Sphere8;
use self::node::tri8::Tri8;
use self::traverse::dispatch::Trees;
pub use self::traverse::dispatch::{Kernel, Scratch};
use super::{BuildQuality, BuildStats, Coherence, Counts, Intersector};
use crate::Result;
use crate::geometry::{Geometry, Hit8, Ray8, Shape, is_usable, slab, sphere};
use crate::math::Vector3;
use crate::simd::Mask8;
use crate::system::memory;

/// The native accelerator. It has its own copy of the triangles. [`super::Unbounded`] adds infinite planes.
#[derive(Clone, Debug)]
pub struct Native {
    pub(super) triangles: Bvh8<Tri8>,
    pub(super) spheres: Bvh8<Sphere8>,
    pub(super) stats: BuildStats,
}

impl Native {
    /// [`Native::build_as`] with [`BuildQuality::Default`].
    ///
    /// # Panics
    /// As [`Native::build_as`].
    #[must_use]
    pub fn build(geometry: &[Geometry]) -> Self {
        Self::build_as(geometry, BuildQuality::Default)
    }

    /// [`Native::try_build_as`], which panics where that returns an error.
    ///
    /// # Panics
    /// If there is not enough memory.
    #[must_use]
    pub fn build_as(geometry: &[Geometry], quality: BuildQuality) -> Self {
        Self::try_build_as(geometry, quality).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Builds the hierarchies over the meshes and spheres of `geometry`. The geometry id of a hit is its index in this list.
    /// Unusable primitives ([`crate::geometry::TriMesh::is_usable`]) are left out and counted. The tree is the same for any
    /// number of threads, and the hits are the same to the bit for every quality.
    ///
    /// # Errors
    /// [`Error::Limit`](crate::Error::Limit) if there is not enough memory for the hierarchy.
    pub fn try_build_as(geometry: &[Geometry], quality: BuildQuality) -> Result<Self> {
        let counts = Counts::of(geometry);
        let what = counts.named("the hierarchy over");
        memory::need(&what, collapse::build_bytes(counts.triangles + counts.spheres, quality), counts.cure())?;
        let start = Instant::now();
        let (mut triangles, mut spheres) = (Vec::new(), Vec::new());
        let mut dropped = 0;
        for (id, g) in geometry.iter().enumerate() {
            let id = id as u32;
            match &g.shape {
                Shape::Mesh(mesh) => {
                    let before = triangles.len();
                    let count = mesh.triangles.len();
                    // Allocates exactly the size of the mesh. Unusable triangles are rare, and removed afterwards.
                    triangles.par_extend((0..count).into_par_iter().map(|i| {
                        let corners = mesh.corners(i);
                        if is_usable(&corners) { triangle_ref(corners, id, i as u32) } else { PrimRef::NONE }
                    }));
                    if triangles[before..].par_iter().any(PrimRef::is_none) {
                        let mut index = 0;
                        triangles.retain(|p| {
                            index += 1;
                            index <= before || !p.is_none()
                        });
                    }
                    dropped += count - (triangles.len() - before);
                }
                Shape::Sphere(s) if s.is_usable() => {
                    let (lo, hi) = sphere::grown_bounds::<f32>(s.centre.into(), s.radius);
                    spheres.push(PrimRef::new([lo.x, lo.y, lo.z], [hi.x, hi.y, hi.z], id, 0));
                }
                Shape::Sphere(_) => dropped += 1,
                Shape::Plane(_) => {}
            }
        }
        let mut stats =
            BuildStats { triangles: triangles.len(), spheres: spheres.len(), dropped, ..Default::default() };
        let triangles = collapse::bvh8(&mut triangles, quality, (&what, counts.cure()), |prims| {
            let mesh = |id: u32| match &geometry[id as usize].shape {
                Shape::Mesh(mesh) => mesh,
                _ => unreachable!("a reference to a triangle names a mesh"),
            };
            let of = |p: &PrimRef| {
                let (id, primitive) = p.id();
                (mesh(id).corners(primitive as usize), id, primitive, geometry[id as usize].mask.0)
            };
            let mut triangles: arrayvec::ArrayVec<_, 8> = prims.iter().map(of).collect();
            largest_first(&mut triangles, |([a, b, c], ..)| (*b - *a).cross(*c - *a).length_squared());
            Tri8::new(&triangles)
        })?;
        let spheres = collapse::bvh8(&mut spheres, quality, (&what, counts.cure()), |prims| {
            let of = |p: &PrimRef| {
                let g = &geometry[p.id().0 as usize];
                let Shape::Sphere(sphere) = g.shape else { unreachable!("a reference to a sphere names one") };
                (sphere, p.id().0, g.mask.0)
            };
            let mut spheres: arrayvec::ArrayVec<_, 8> = prims.iter().map(of).collect();
            largest_first(&mut spheres, |(sphere, ..)| sphere.radius);
            Sphere8::new(&spheres)
        })?;
        stats.nodes = triangles.nodes.len() + spheres.nodes.len();
        stats.leaves = triangles.leaves.len() + spheres.leaves.len();
        stats.depth = triangles.depth.max(spheres.depth);
        stats.bytes = triangles.bytes() + spheres.bytes();
        stats.time = start.elapsed();
        Ok(Self { triangles, spheres, stats })
    }

    /// All bytes of the trees, for the test that they are the same for any number of threads.
    #[doc(hidden)]
    #[must_use]
    pub fn tree_bytes(&self) -> Vec<u8> {
        let (t, s) = (&self.triangles, &self.spheres);
        let leaves = t.leaves.iter().flat_map(Tri8::words).chain(s.leaves.iter().flat_map(Sphere8::words));
        let nodes = t.nodes.iter().chain(&s.nodes).flat_map(Node8::words);
        nodes.chain(leaves).flat_map(u32::to_le_bytes).collect()
    }

    #[inline(always)]
    fn trees(&self) -> Trees<'_> {
        Trees { spheres: &self.spheres, triangles: &self.triangles }
    }

    /// [`Intersector::closest`] with a given kernel.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn closest_with(
        &self,
        kernel: Kernel,
        rays: &[Ray8],
        hits: &mut [Hit8],
        coherence: Coherence,
        scratch: &mut Scratch,
    ) {
        assert_eq!(rays.len(), hits.len());
        self.trees().closest((kernel, coherence), rays, hits, scratch);
    }

    /// [`Intersector::occluded`] with a given kernel.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn occluded_with(
        &self,
        kernel: Kernel,
        rays: &[Ray8],
        blocked: &mut [Mask8],
        coherence: Coherence,
        scratch: &mut Scratch,
    ) {
        assert_eq!(rays.len(), blocked.len());
        self.trees().occluded((kernel, coherence), rays, blocked, scratch);
    }
}

/// Swaps the largest primitive to the front, where any-hit packets test it first.
fn largest_first<T>(primitives: &mut [T], size: impl Fn(&T) -> f32) {
    let (mut largest, mut most) = (0, f32::NEG_INFINITY);
    for (i, primitive) in primitives.iter().enumerate() {
        let size = size(primitive);
        (largest, most) = if size > most { (i, size) } else { (largest, most) };
    }
    primitives.swap(0, largest);
}

/// The reference to a triangle, with the box that the triangle test clamps `t` to.
fn triangle_ref(corners: [glam::Vec3; 3], geometry: u32, primitive: u32) -> PrimRef {
    let [a, b, c] = corners;
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    let (lo, hi): (Vector3<f32>, Vector3<f32>) = slab::grown(lo.into(), hi.into());
    PrimRef::new([lo.x, lo.y, lo.z], [hi.x, hi.y, hi.z], geometry, primitive)
}

impl Intersector for Native {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Scratch) {
        self.closest_with(Kernel::Auto, rays, hits, coherence, scratch);
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Scratch) {
        self.occluded_with(Kernel::Auto, rays, blocked, coherence, scratch);
    }

    fn build_stats(&self) -> BuildStats {
        self.stats
    }

    fn native(&self) -> Option<&Self> {
        Some(self)
    }
}
