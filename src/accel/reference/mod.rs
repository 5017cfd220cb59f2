//! The arbiter: hits of single rays in `f64`.
//!
//! It takes the same `f32` shapes as every other path. Widening them is exact, so its answers have errors of 2^-53
//! where other paths have errors of 2^-24. [`Reference::judge`] turns that difference into verdicts on their answers.

mod budget;
mod margin;
mod packets;
mod primitive;
mod ray;
mod seams;
mod tree;
mod verdict;

#[cfg(test)]
mod tests;

use std::ops::ControlFlow;
use std::time::Instant;

pub use budget::Budget;
pub use margin::{Contact, Margin};
pub use ray::{Hit64, Ray64};
pub use verdict::{Cause, Examined, Fault, Verdict};

use super::{BuildStats, Counts};
use crate::Result;
use crate::geometry::Geometry;
use crate::system::memory;
use primitive::{Form, Primitive, Probe};
use tree::{EXACT, Tree};

/// Bytes of a primitive in a list that grows by doubling.
const PRIMITIVE_BYTES: usize = 2 * size_of::<Primitive>();

/// Shapes in `f64` with a hierarchy over them.
#[derive(Clone, Debug, Default)]
pub struct Reference {
    /// In the order of their ids.
    primitives: Vec<Primitive>,
    tree: Tree,
    stats: BuildStats,
}

impl Reference {
    /// Checks that there is memory for a hierarchy over `geometry`.
    ///
    /// # Errors
    /// [`Error::Limit`](crate::Error::Limit) if there is not enough.
    pub fn need(geometry: &[Geometry]) -> Result<()> {
        let counts = Counts::of(geometry);
        let bytes = counts.triangles.saturating_add(counts.spheres).saturating_mul(Tree::BYTES_EACH + PRIMITIVE_BYTES);
        memory::need(&counts.named("the f64 hierarchy over"), bytes as u64, counts.cure())
    }

    /// Builds the hierarchy. Primitives that no ray can hit are dropped and counted.
    #[must_use]
    pub fn build(geometry: &[Geometry]) -> Self {
        let start = Instant::now();
        let (primitives, dropped) = Primitive::collect(geometry);
        let tree = Tree::build(&primitives);
        let count = |is: fn(&Form) -> bool| primitives.iter().filter(|p| is(&p.form)).count();
        let (nodes, leaves, depth) = tree.shape();
        let stats = BuildStats {
            triangles: count(|f| matches!(f, Form::Triangle(_))),
            spheres: count(|f| matches!(f, Form::Sphere { .. })),
            planes: count(|f| matches!(f, Form::Plane { .. })),
            dropped,
            nodes,
            leaves,
            depth,
            bytes: tree.bytes(),
            time: start.elapsed(),
        };
        Self { primitives, tree, stats }
    }

    /// Returns the nearest hit, or a miss.
    #[must_use]
    pub fn closest(&self, ray: &Ray64) -> Hit64 {
        self.closest_within(ray, &mut Budget::unlimited())
    }

    /// Returns the nearest hit among those found within `budget`.
    fn closest_within(&self, ray: &Ray64, budget: &mut Budget) -> Hit64 {
        let mut best = Hit64::MISS;
        self.visit(ray, budget, |hit| {
            if hit.is_before(&best) {
                best = hit;
            }
            ControlFlow::Continue(ray.t_max.min(best.t))
        });
        best
    }

    /// Returns true if the ray hits anything that it admits.
    #[must_use]
    pub fn occluded(&self, ray: &Ray64) -> bool {
        let mut met = false;
        self.visit(ray, &mut Budget::unlimited(), |_| {
            met = true;
            ControlFlow::Break(())
        });
        met
    }

    /// Returns all hits, nearest first, ties in order of id. A ray through a shared edge hits both triangles.
    #[must_use]
    pub fn all_hits(&self, ray: &Ray64) -> Vec<Hit64> {
        self.hits_within(ray, &mut Budget::unlimited())
    }

    /// Returns the same hits as [`Reference::all_hits`] if `budget` is not spent afterwards. Otherwise some may be
    /// missing.
    #[must_use]
    pub fn hits_within(&self, ray: &Ray64, budget: &mut Budget) -> Vec<Hit64> {
        let mut hits = Vec::new();
        self.visit(ray, budget, |hit| {
            hits.push(hit);
            ControlFlow::Continue(ray.t_max)
        });
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id().cmp(&b.id())));
        hits
    }

    /// Statistics of the build.
    #[must_use]
    pub fn stats(&self) -> BuildStats {
        self.stats
    }

    /// Calls `see` with the hits of `ray`, in no order. It returns the parameter beyond which it needs no hits.
    fn visit(&self, ray: &Ray64, budget: &mut Budget, mut see: impl FnMut(Hit64) -> ControlFlow<(), f64>) {
        if !ray.is_usable() {
            return;
        }
        let probe = Probe::new(ray);
        let mut far = ray.t_max;
        self.tree.walk(ray, EXACT, budget, |place, budget| {
            let primitive = &self.primitives[place];
            if primitive.mask.meets(ray.admits) {
                for hit in primitive.meetings(&probe).into_iter().filter(|hit| ray.sees(hit.t)) {
                    budget.spend(Budget::CONTACT);
                    far = see(hit)?;
                }
            }
            ControlFlow::Continue(far)
        });
    }
}
