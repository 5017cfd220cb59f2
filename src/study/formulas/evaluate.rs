//! Formulas of light at a boundary, evaluated in every number type.

use std::hint::black_box;

use glam::DVec3;

use super::timing::{Time, time};
use crate::math::{LaneMask, Real, Vector3};
use crate::optics::Boundary;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// A ray at a boundary, or eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case<R> {
    pub incident: Vector3<R>,
    pub normal: Vector3<R>,
    /// Cosine of the angle of incidence, for formulas of the angle alone.
    pub cos: R,
    pub boundary: Boundary<R>,
}

/// Formula over every number type.
pub(super) trait Answer: Copy + Sync + 'static {
    /// Returns the answer, and true where there is none.
    fn answer<R: Real>(self, case: &Case<R>) -> (Vector3<R>, R::Mask);
}

/// [`Answer`] of unknown type, for lists.
pub(super) trait Formula: Sync {
    fn eight(&self, case: &Case<F32x8>) -> (Vec3x8, Mask8);
    fn double(&self, case: &Case<f64>) -> (Vector3<f64>, bool);
    fn time(&self) -> Time;
}

impl<A: Answer> Formula for A {
    fn eight(&self, case: &Case<F32x8>) -> (Vec3x8, Mask8) {
        self.answer(case)
    }

    fn double(&self, case: &Case<f64>) -> (Vector3<f64>, bool) {
        self.answer(case)
    }

    fn time(&self) -> Time {
        let rays = batch();
        let eights: Vec<Case<F32x8>> = rays.as_chunks::<8>().0.iter().map(eight).collect();
        let ones: Vec<Case<f32>> = rays.iter().map(|(n1, n2, i, n)| case::<f32>(*n1, *n2, *i, *n)).collect();
        let doubles: Vec<Case<f64>> = rays.iter().map(|(n1, n2, i, n)| case::<f64>(*n1, *n2, *i, *n)).collect();
        let answer = *self;
        time([&mut || run(answer, &eights), &mut || run(answer, &ones), &mut || run(answer, &doubles)])
    }
}

/// Evaluates a batch once: short enough to be undisturbed and long enough to be timed.
#[inline(never)]
fn run<A: Answer, R: Real>(answer: A, cases: &[Case<R>]) -> usize {
    const PASSES: usize = 64;
    for _ in 0..PASSES {
        for case in black_box(cases) {
            let (direction, none) = answer.answer(case);
            black_box(Vector3::select(none, case.incident, direction));
        }
    }
    PASSES * cases.len()
}

/// Indices on both sides, direction of travel and normal.
pub(super) type Drawn = (f64, f64, DVec3, DVec3);

/// Rays spread evenly over all cosines, alternately into glass and out of it, few enough for the first-level cache.
fn batch() -> Vec<Drawn> {
    const RAYS: usize = 64;
    let normal = DVec3::new(0.36, 0.48, 0.8);
    (0..RAYS)
        .map(|k| {
            let cosine = (k as f64 + 0.5) / RAYS as f64;
            let turn = 2.399_963 * k as f64;
            let across = normal.cross(DVec3::new(turn.cos(), turn.sin(), 0.3)).normalize();
            let incident = across * (1.0 - cosine * cosine).sqrt() - normal * cosine;
            let (n1, n2) = if k % 2 == 0 { (1.0, 1.5) } else { (1.5, 1.0) };
            (n1, n2, incident, normal)
        })
        .collect()
}

fn case<R: Real>(n1: f64, n2: f64, i: DVec3, n: DVec3) -> Case<R> {
    let vector = |v: DVec3| Vector3::new(R::splat(v.x), R::splat(v.y), R::splat(v.z));
    Case { incident: vector(i), normal: vector(n), cos: R::splat(-i.dot(n)), boundary: Boundary::new(n1, n2) }
}

/// Returns eight rays, each at its own boundary.
fn eight(rays: &[Drawn; 8]) -> Case<F32x8> {
    let cases = rays.map(|(n1, n2, i, n)| case::<f32>(n1, n2, i, n));
    let lanes = |f: &dyn Fn(&Case<f32>) -> f32| F32x8::from_fn(|k| f(&cases[k]));
    let vector = |f: &dyn Fn(&Case<f32>) -> Vector3<f32>| {
        Vector3::new(lanes(&|c| f(c).x), lanes(&|c| f(c).y), lanes(&|c| f(c).z))
    };
    Case {
        incident: vector(&|c| c.incident),
        normal: vector(&|c| c.normal),
        cos: lanes(&|c| c.cos),
        boundary: Boundary {
            eta: lanes(&|c| c.boundary.eta),
            kc: lanes(&|c| c.boundary.kc),
            kc_low: lanes(&|c| c.boundary.kc_low),
            r0: lanes(&|c| c.boundary.r0),
        },
    }
}

/// Returns lane `k` of a mask.
pub(super) fn lane(mask: Mask8, k: usize) -> bool {
    mask.any() && mask.lane(k)
}
