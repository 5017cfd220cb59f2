//! Single-ray traversal of the native hierarchy with a selectable ray/triangle test and reciprocal. It serves to compare
//! these, not to be fast.
//!
//! Boxes are those of [`Native`] and every choice shares the traversal. So two pictures differ by the choice alone, in time
//! and in error. With the watertight test and true division the hits are those of [`Native`] to the bit. The choice costs one
//! call through a function pointer per stream of rays.
//!
//! The choice affects the preparation of rays, box tests and triangle tests. Exact spheres always use true division.

use std::sync::atomic::{AtomicU64, Ordering};

use super::native::Native;
use super::native::node::bvh8::{Bvh8, NodeRef};
use super::native::node::closest_hit::{ClosestHit, LeafHits};
use super::native::node::leaf::Leaf;
use super::native::node::sphere8::Sphere8;
use super::native::node::tri8::Tri8;
use super::{BuildQuality, BuildStats, Coherence, Intersector};
use crate::Result;
use crate::geometry::slab::{SlabRay, upper_end};
pub use crate::geometry::triangle_test::TriangleModel;
use crate::geometry::triangle_test::{Meeting, TriangleTest, TriangleVisitor};
use crate::geometry::{Geometry, Hit, Hit8, Octant, Ray, Ray8, sphere};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, Reciprocal, ReciprocalModel, ReciprocalVisitor, Vec3x8, set_lanes};

/// The native hierarchy with a selectable triangle test and reciprocal. [`super::Unbounded`] adds infinite planes.
#[derive(Debug)]
pub struct Walk {
    native: Native,
    kernels: Kernels,
    tested: AtomicU64,
    settled: AtomicU64,
}

/// Numbers of triangle tests, counted by lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TestCounts {
    /// Triangles tested.
    pub tested: u64,
    /// Tests that `f32` could not decide and `f64` did.
    pub settled: u64,
}

impl TestCounts {
    /// Share of the tests that `f64` decided; 0 if there were no tests.
    #[must_use]
    pub fn share(self) -> f64 {
        self.settled as f64 / self.tested.max(1) as f64
    }

    /// The counts since `before`.
    #[must_use]
    pub fn since(self, before: Self) -> Self {
        Self { tested: self.tested - before.tested, settled: self.settled - before.settled }
    }
}

/// A traversal stack: nodes with the ray parameters at which their boxes are entered.
#[derive(Debug, Default)]
pub struct Scratch(Vec<(f32, NodeRef)>);

/// The closest-hit and any-hit functions of one choice.
#[derive(Clone, Copy, Debug)]
struct Kernels {
    closest: fn(&Native, &[Ray8], &mut [Hit8], &mut Scratch) -> TestCounts,
    occluded: fn(&Native, &[Ray8], &mut [Mask8], &mut Scratch) -> TestCounts,
}

impl Walk {
    /// [`Walk::try_build`], which panics where that returns an error.
    ///
    /// # Panics
    /// If there is not enough memory.
    #[must_use]
    pub fn build(
        geometry: &[Geometry],
        quality: BuildQuality,
        triangles: TriangleModel,
        reciprocal: ReciprocalModel,
    ) -> Self {
        Self::try_build(geometry, quality, triangles, reciprocal).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Builds the hierarchy of [`Native::try_build_as`] over the meshes and spheres of `geometry`.
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
        let kernels = triangles.dispatch(SelectTriangleTest(reciprocal));
        let [tested, settled] = [AtomicU64::new(0), AtomicU64::new(0)];
        Ok(Self { native, kernels, tested, settled })
    }

    /// Numbers of triangle tests since the build.
    #[must_use]
    pub fn test_counts(&self) -> TestCounts {
        TestCounts { tested: self.tested.load(Ordering::Relaxed), settled: self.settled.load(Ordering::Relaxed) }
    }

    fn count(&self, counts: TestCounts) {
        self.tested.fetch_add(counts.tested, Ordering::Relaxed);
        self.settled.fetch_add(counts.settled, Ordering::Relaxed);
    }
}

impl Intersector for Walk {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], _coherence: Coherence, scratch: &mut Scratch) {
        assert_eq!(rays.len(), hits.len());
        self.count((self.kernels.closest)(&self.native, rays, hits, scratch));
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], _coherence: Coherence, scratch: &mut Scratch) {
        assert_eq!(rays.len(), blocked.len());
        self.count((self.kernels.occluded)(&self.native, rays, blocked, scratch));
    }

    fn build_stats(&self) -> BuildStats {
        self.native.stats
    }
}

/// Selects the kernels by triangle test, then by reciprocal.
struct SelectTriangleTest(ReciprocalModel);

impl TriangleVisitor for SelectTriangleTest {
    type Output = Kernels;

    fn visit<T: TriangleTest>(self, test: T) -> Kernels {
        self.0.dispatch(SelectReciprocal(test))
    }
}

/// Selects the kernels of a triangle test by reciprocal.
struct SelectReciprocal<T>(T);

impl<T: TriangleTest> ReciprocalVisitor for SelectReciprocal<T> {
    type Output = Kernels;

    fn visit<D: Reciprocal>(self, _reciprocal: D) -> Kernels {
        Kernels { closest: closest::<T, D>, occluded: occluded::<T, D> }
    }
}

/// One ray, broadcast to all lanes.
struct BroadcastRay<T: TriangleTest> {
    triangle: T::Ray<F32x8>,
    /// Origin, and inverse direction by the selected reciprocal.
    slab: SlabRay<F32x8>,
    dir: Vec3x8,
    t_min: F32x8,
    admits: u8,
    octant: Octant,
}

impl<T: TriangleTest> BroadcastRay<T> {
    #[inline(always)]
    fn new<D: Reciprocal>(ray: &Ray) -> Self {
        let (origin, dir) = (Vec3x8::splat(ray.origin), Vec3x8::splat(ray.dir));
        let slab = SlabRay::by(origin, dir, D::of);
        let backwards = |x: F32x8| usize::from(x.lane(0).is_sign_negative());
        Self {
            triangle: T::prepare_by::<F32x8, D>(origin, dir),
            slab,
            dir,
            t_min: F32x8::from(ray.t_min),
            admits: ray.admits.0,
            octant: [slab.inverse.x, slab.inverse.y, slab.inverse.z].map(backwards),
        }
    }

    /// Tests the triangles of a leaf, and counts the tests. The lanes returned have a hit with `t_min < t <= t_max`.
    #[inline(always)]
    fn intersect_triangles<D: Reciprocal>(&self, leaf: &Tri8, t_max: f32, counts: &mut TestCounts) -> LeafHits {
        let admitted = leaf.tags().admitted(self.admits);
        let Meeting { hit, t, u, v, settled } = T::meet_by::<F32x8, D>(&self.triangle, &leaf.corners());
        counts.tested += u64::from(admitted.count_ones());
        counts.settled += u64::from((settled.bits() & admitted).count_ones());
        let hit = hit & self.t_min.lt(t) & t.le(F32x8::from(t_max));
        LeafHits { lanes: hit & Mask8::from_bits(admitted), t, u, v }
    }

    /// Tests the spheres of a leaf. The lanes returned have a hit with `t_min < t <= t_max`.
    #[inline(always)]
    fn intersect_spheres(&self, leaf: &Sphere8, t_max: f32) -> LeafHits {
        let slab = SlabRay::new(self.slab.origin, self.dir);
        let (t, hit) = sphere::intersect(&slab, self.dir, leaf.centre, leaf.radius, self.t_min, F32x8::from(t_max));
        let lanes = hit & Mask8::from_bits(leaf.tags().admitted(self.admits));
        LeafHits { lanes, t, u: F32x8::ZERO, v: F32x8::ZERO }
    }

    /// Visits the leaves whose boxes the ray hits, near ones first. `visit` may lower `t_max`, and returns true to stop.
    /// Returns true if `visit` did.
    #[inline(always)]
    fn traverse<L>(
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
            let base = stack.len();
            for i in set_lanes(enter.le(leave).bits()) {
                // Insertion sort: farther children stay below.
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
    native: &Native,
    rays: &[Ray8],
    hits: &mut [Hit8],
    scratch: &mut Scratch,
) -> TestCounts {
    let mut counts = TestCounts::default();
    for (rays, hits) in rays.iter().zip(hits) {
        for i in set_lanes(rays.active) {
            let ray = rays.lane(i);
            let Some(t_max) = upper_end(&ray) else {
                hits.set_lane(i, &Hit::MISS);
                continue;
            };
            let ray = BroadcastRay::<T>::new::<D>(&ray);
            let mut closest = ClosestHit::new(t_max);
            ray.traverse(&native.spheres, closest.t, scratch, |leaf, t_max| {
                closest.update(&ray.intersect_spheres(leaf, *t_max), leaf.tags());
                *t_max = closest.t;
                false
            });
            ray.traverse(&native.triangles, closest.t, scratch, |leaf, t_max| {
                closest.update(&ray.intersect_triangles::<D>(leaf, *t_max, &mut counts), leaf.tags());
                *t_max = closest.t;
                false
            });
            hits.set_lane(i, &closest.hit());
        }
    }
    counts
}

fn occluded<T: TriangleTest, D: Reciprocal>(
    native: &Native,
    rays: &[Ray8],
    blocked: &mut [Mask8],
    scratch: &mut Scratch,
) -> TestCounts {
    let mut counts = TestCounts::default();
    for (rays, blocked) in rays.iter().zip(blocked) {
        let mut bits = 0;
        for i in set_lanes(rays.active) {
            let ray = rays.lane(i);
            let Some(t_max) = upper_end(&ray) else { continue };
            let ray = BroadcastRay::<T>::new::<D>(&ray);
            let spheres = |leaf: &Sphere8, t_max: &mut f32| ray.intersect_spheres(leaf, *t_max).lanes != Mask8::NONE;
            let hit = ray.traverse(&native.spheres, t_max, scratch, spheres)
                || ray.traverse(&native.triangles, t_max, scratch, |leaf, t_max| {
                    ray.intersect_triangles::<D>(leaf, *t_max, &mut counts).lanes != Mask8::NONE
                });
            bits |= u8::from(hit) << i;
        }
        *blocked = Mask8::from_bits(bits);
    }
    counts
}
