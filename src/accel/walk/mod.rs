//! The hierarchy walked one ray at a time, by a ray/triangle test and a reciprocal of choice: made to compare these, not
//! to be fast.
//!
//! Boxes are those of [`Native`], and every choice shares the walk, so that pictures differ by the choice alone, in time
//! as in error. With the watertight test and true division the hits are those of [`Native`], to the bit. Which choice it
//! is costs a call through a pointer a stream of rays.
//!
//! What is chosen prepares the rays, clips them to boxes and meets triangles. Exact spheres divide truly whatever is
//! chosen.

pub use crate::geometry::triangle_test::TriangleModel;

use std::sync::atomic::{AtomicU64, Ordering};

use super::native::Native;
use super::native::node::bvh8::{Bvh8, NodeRef};
use super::native::node::closest_hit::ClosestHit;
use super::native::node::leaf::{Leaf, LeafHits, Tags};
use super::{BuildQuality, BuildStats, Coherence, Counts, Intersector};
use crate::Result;
use crate::geometry::slab::{SlabRay, upper_end};
use crate::geometry::triangle_test::{Meeting, TriangleTest, TriangleVisitor};
use crate::geometry::{Geometry, Hit, Hit8, Ray, Ray8, sphere};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, Reciprocal, ReciprocalModel, ReciprocalVisitor, Vec3x8};
use crate::system::memory;

/// The native hierarchy with a triangle test and a reciprocal of choice. Planes are left to [`super::Unbounded`].
#[derive(Debug)]
pub struct Walk {
    trees: Trees,
    kernels: Kernels,
    stats: BuildStats,
    tested: AtomicU64,
    settled: AtomicU64,
}

/// TestCounts of triangle tests: those in which a triangle was tested, and those among them that fell to `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TestCounts {
    /// Triangles tested.
    pub tested: u64,
    /// Tests that `f32` left open.
    pub settled: u64,
}

impl TestCounts {
    /// Share of the tests that fell to `f64`; 0 where there were none.
    #[must_use]
    pub fn share(self) -> f64 {
        self.settled as f64 / self.tested.max(1) as f64
    }

    /// What was counted since `before`.
    #[must_use]
    pub fn since(self, before: Self) -> Self {
        Self { tested: self.tested - before.tested, settled: self.settled - before.settled }
    }
}

#[derive(Debug)]
struct Trees {
    triangles: Bvh8<Corners>,
    spheres: Bvh8<Balls>,
}

/// Up to eight triangles; empty slots hold NaN.
#[derive(Debug)]
struct Corners {
    corners: [Vec3x8; 3],
    tags: Tags,
}

/// Up to eight spheres; empty slots hold NaN.
#[derive(Debug)]
struct Balls {
    centre: Vec3x8,
    radius: F32x8,
    tags: Tags,
}

/// What is still to be visited, and where it is entered.
#[derive(Debug, Default)]
pub struct Scratch(Vec<(f32, NodeRef)>);

/// One choice, ready to be called.
#[derive(Clone, Copy, Debug)]
struct Kernels {
    closest: fn(&Trees, &[Ray8], &mut [Hit8], &mut Scratch) -> TestCounts,
    occluded: fn(&Trees, &[Ray8], &mut [Mask8], &mut Scratch) -> TestCounts,
}

impl Walk {
    /// [`Walk::try_build`] where there is memory for it.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn build(
        geometry: &[Geometry],
        quality: BuildQuality,
        triangles: TriangleModel,
        reciprocal: ReciprocalModel,
    ) -> Self {
        Self::try_build(geometry, quality, triangles, reciprocal).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Builds over the meshes and spheres of `geometry`, as [`Native::try_build_as`] does.
    ///
    /// # Errors
    /// As [`Native::try_build_as`].
    pub fn try_build(
        geometry: &[Geometry],
        quality: BuildQuality,
        triangles: TriangleModel,
        reciprocal: ReciprocalModel,
    ) -> Result<Self> {
        let native = Native::try_build_as(geometry, quality)?;
        // Leaves are written anew, of one kind after the other.
        let leaves =
            native.triangles.leaves.len() * size_of::<Corners>() + native.spheres.leaves.len() * size_of::<Balls>();
        let counts = Counts::of(geometry);
        memory::need(&counts.named("the hierarchy over"), leaves as u64, counts.cure())?;
        let nan = Vec3x8::splat(glam::Vec3::NAN);
        let tags = |ids: &[(u32, u32)]| Tags::new(ids.iter().map(|&(g, p)| (g, p, geometry[g as usize].mask.0)));
        let trees = Trees {
            triangles: with_leaves(native.triangles, |leaf| {
                let ids: Vec<_> = leaf.ids().collect();
                let mut corners = [nan; 3];
                for i in 0..ids.len() {
                    corners.iter_mut().zip(leaf.triangle(i)).for_each(|(eight, corner)| eight.set_lane(i, corner));
                }
                Corners { corners, tags: tags(&ids) }
            }),
            spheres: with_leaves(native.spheres, |leaf| {
                let ids: Vec<_> = leaf.ids().collect();
                let (mut centre, mut radius) = (nan, nan.x);
                for i in 0..ids.len() {
                    let sphere = leaf.sphere(i);
                    centre.set_lane(i, sphere.centre);
                    radius.set_lane(i, sphere.radius);
                }
                Balls { centre, radius, tags: tags(&ids) }
            }),
        };
        let kernels = triangles.dispatch(By(reciprocal));
        let [tested, settled] = [AtomicU64::new(0), AtomicU64::new(0)];
        Ok(Self { trees, kernels, stats: native.stats, tested, settled })
    }

    /// TestCounts of triangle tests so far.
    #[must_use]
    pub fn lanes(&self) -> TestCounts {
        TestCounts { tested: self.tested.load(Ordering::Relaxed), settled: self.settled.load(Ordering::Relaxed) }
    }

    fn count(&self, lanes: TestCounts) {
        self.tested.fetch_add(lanes.tested, Ordering::Relaxed);
        self.settled.fetch_add(lanes.settled, Ordering::Relaxed);
    }
}

impl Intersector for Walk {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], _coherence: Coherence, scratch: &mut Scratch) {
        assert_eq!(rays.len(), hits.len());
        self.count((self.kernels.closest)(&self.trees, rays, hits, scratch));
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], _coherence: Coherence, scratch: &mut Scratch) {
        assert_eq!(rays.len(), blocked.len());
        self.count((self.kernels.occluded)(&self.trees, rays, blocked, scratch));
    }

    fn build_stats(&self) -> BuildStats {
        self.stats
    }
}

/// Finds the kernels of a triangle test for a reciprocal.
struct By(ReciprocalModel);

impl TriangleVisitor for By {
    type Output = Kernels;

    fn visit<T: TriangleTest>(self, test: T) -> Kernels {
        self.0.dispatch(With(test))
    }
}

/// Finds the kernels of a reciprocal for a triangle test.
struct With<T>(T);

impl<T: TriangleTest> ReciprocalVisitor for With<T> {
    type Output = Kernels;

    fn visit<D: Reciprocal>(self, _reciprocal: D) -> Kernels {
        Kernels { closest: closest::<T, D>, occluded: occluded::<T, D> }
    }
}

fn with_leaves<L, M>(tree: Bvh8<L>, leaf: impl Fn(&L) -> M) -> Bvh8<M> {
    let leaves = tree.leaves.iter().map(leaf).collect();
    Bvh8 { nodes: tree.nodes, leaves, root: tree.root, depth: tree.depth }
}

/// One ray in all eight lanes.
struct One<T: TriangleTest> {
    triangle: T::Ray<F32x8>,
    /// By the reciprocal of choice.
    slab: SlabRay<F32x8>,
    origin: Vec3x8,
    dir: Vec3x8,
    t_min: F32x8,
    admits: u8,
    /// For each axis, 1 where the ray runs backwards along it.
    octant: [usize; 3],
}

impl<T: TriangleTest> One<T> {
    #[inline(always)]
    fn new<D: Reciprocal>(ray: &Ray) -> Self {
        let (origin, dir) = (Vec3x8::splat(ray.origin), Vec3x8::splat(ray.dir));
        let slab = SlabRay::by(origin, dir, D::of);
        let backwards = |x: F32x8| usize::from(x.lane(0).is_sign_negative());
        Self {
            triangle: T::prepare_by::<F32x8, D>(origin, dir),
            slab,
            origin,
            dir,
            t_min: F32x8::from(ray.t_min),
            admits: ray.admits.0,
            octant: [slab.inverse.x, slab.inverse.y, slab.inverse.z].map(backwards),
        }
    }

    /// The triangles that the ray sees up to `t_max`.
    #[inline(always)]
    fn meet<D: Reciprocal>(&self, leaf: &Corners, t_max: f32, lanes: &mut TestCounts) -> (u8, Meeting<F32x8>) {
        let admitted = leaf.tags.admitted(self.admits);
        let met = T::meet_by::<F32x8, D>(&self.triangle, &leaf.corners);
        lanes.tested += u64::from(admitted.count_ones());
        lanes.settled += u64::from((met.settled.bits() & admitted).count_ones());
        let seen = met.hit & self.t_min.lt(met.t) & met.t.le(F32x8::from(t_max));
        (seen.bits() & admitted, met)
    }

    /// The spheres that the ray sees up to `t_max`, and where.
    #[inline(always)]
    fn meet_balls(&self, leaf: &Balls, t_max: f32) -> (u8, F32x8) {
        let slab = SlabRay::new(self.origin, self.dir);
        let (t, met) = sphere::intersect(&slab, self.dir, leaf.centre, leaf.radius, self.t_min, F32x8::from(t_max));
        (met.bits() & leaf.tags.admitted(self.admits), t)
    }

    /// Visits the leaves whose boxes the ray meets, near ones first, until `visit` says that it is enough; it may lower
    /// the limit. Whether it did.
    #[inline(always)]
    fn walk<L>(
        &self,
        tree: &Bvh8<L>,
        mut t_max: f32,
        Scratch(stack): &mut Scratch,
        mut visit: impl FnMut(&L, &mut f32) -> bool,
    ) -> bool {
        stack.clear();
        if tree.root != NodeRef::NONE {
            stack.push((f32::NEG_INFINITY, tree.root));
        }
        while let Some((enter, here)) = stack.pop() {
            if enter > t_max {
                continue;
            }
            if here.is_leaf() {
                if visit(&tree.leaves[here.index()], &mut t_max) {
                    return true;
                }
                continue;
            }
            let node = &tree.nodes[here.index()];
            let (near, far) = node.boxes.sorted(self.octant);
            let (enter, leave) = self.slab.clip_sorted(near, far, self.t_min, F32x8::from(t_max));
            let mut met = enter.le(leave).bits();
            let base = stack.len();
            while met != 0 {
                let i = met.trailing_zeros() as usize;
                met &= met - 1;
                // Farther ones stay below.
                let entry = (enter.lane(i), node.children[i]);
                let mut k = stack.len();
                stack.push(entry);
                while k > base && stack[k - 1].0 < entry.0 {
                    stack[k] = stack[k - 1];
                    k -= 1;
                }
                stack[k] = entry;
            }
        }
        false
    }
}

fn closest<T: TriangleTest, D: Reciprocal>(
    trees: &Trees,
    rays: &[Ray8],
    hits: &mut [Hit8],
    scratch: &mut Scratch,
) -> TestCounts {
    let mut lanes = TestCounts::default();
    for (rays, hits) in rays.iter().zip(hits) {
        for i in (0..8).filter(|i| rays.active >> i & 1 != 0) {
            let ray = rays.lane(i);
            let Some(t_max) = upper_end(&ray) else {
                hits.set_lane(i, &Hit::MISS);
                continue;
            };
            let one = One::<T>::new::<D>(&ray);
            let mut best = ClosestHit::new(t_max);
            one.walk(&trees.spheres, best.t, scratch, |leaf, t_max| {
                let (met, t) = one.meet_balls(leaf, *t_max);
                let met = LeafHits { lanes: Mask8::from_bits(met), t, u: F32x8::ZERO, v: F32x8::ZERO };
                best.update(&met, &leaf.tags);
                *t_max = best.t;
                false
            });
            one.walk(&trees.triangles, best.t, scratch, |leaf, t_max| {
                let (seen, met) = one.meet::<D>(leaf, *t_max, &mut lanes);
                best.update(&LeafHits { lanes: Mask8::from_bits(seen), t: met.t, u: met.u, v: met.v }, &leaf.tags);
                *t_max = best.t;
                false
            });
            hits.set_lane(i, &best.hit());
        }
    }
    lanes
}

fn occluded<T: TriangleTest, D: Reciprocal>(
    trees: &Trees,
    rays: &[Ray8],
    blocked: &mut [Mask8],
    scratch: &mut Scratch,
) -> TestCounts {
    let mut lanes = TestCounts::default();
    for (rays, blocked) in rays.iter().zip(blocked) {
        let mut bits = 0;
        for i in (0..8).filter(|i| rays.active >> i & 1 != 0) {
            let ray = rays.lane(i);
            let Some(t_max) = upper_end(&ray) else { continue };
            let one = One::<T>::new::<D>(&ray);
            let met = one.walk(&trees.spheres, t_max, scratch, |leaf, t_max| one.meet_balls(leaf, *t_max).0 != 0)
                || one.walk(&trees.triangles, t_max, scratch, |leaf, t_max| {
                    one.meet::<D>(leaf, *t_max, &mut lanes).0 != 0
                });
            bits |= u8::from(met) << i;
        }
        *blocked = Mask8::from_bits(bits);
    }
    lanes
}
