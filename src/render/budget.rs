//! Error budgets, which bound the sum of everything a proven cut-off removes from a pixel.
//!
//! Cutting each small ray proves nothing, since many small rays may be cut from one pixel. So every ray carries a
//! budget: the share of the allowed error that may be cut from it and all its descendants. A camera ray starts with the
//! whole budget.
//!
//! A ray's *toll* is its weight times the bound on its radiance ([`super::ceiling`]), divided by the allowed error.
//! Cutting the ray uses up at most its toll. At each surface the secondary rays whose tolls the budget can pay in full
//! are cut. The rest of the budget is divided among the rays that continue. By induction over depth, what is cut from a
//! ray and its descendants never exceeds its budget. A pixel is the mean of its camera rays, so no channel is off by
//! more than the allowed error.
//!
//! Budgets and tolls are kept per channel, so that rays in different channels do not compete. Continuing rays share the
//! budget in proportion to the square roots of their tolls. An even division would starve the heavy ray, which has most
//! left to divide. A division in proportion to the tolls would never cut any ray, since each budget would shrink as
//! fast as the weight.

use crate::math::{Real, Vector3};

/// Budget of a camera ray. The difference to 1 covers the rounding of weights, tolls and budgets along a path of 4096
/// surfaces with eight roundings at each (`gamma(32768)` is 0.00196 in `f32`).
pub const WHOLE: f64 = 1.0 - 1.0 / 256.0;

/// Result of dividing a budget between two secondary rays of one surface.
#[derive(Clone, Copy, Debug)]
pub struct Division<R: Real> {
    /// Lanes in which the first and the second ray are cut.
    pub cut: [R::Mask; 2],
    /// Budgets of the first and the second ray where they continue.
    pub budget: [Vector3<R>; 2],
}

/// Divides a ray's budget between its two secondary rays by their tolls. A missing ray has toll 0. A NaN toll is never
/// cut.
#[inline(always)]
pub fn divide<R: Real>(budget: Vector3<R>, tolls: [Vector3<R>; 2]) -> Division<R> {
    let [first, second] = tolls;
    let both = pays(budget, first + second);
    let first_is_less = first.max_component().le(second.max_component());
    let cut_first = both | (first_is_less & pays(budget, first));
    let cut_second = both | (!first_is_less & pays(budget, second));
    let part =
        Vector3::new(root_share(first.x, second.x), root_share(first.y, second.y), root_share(first.z, second.z));
    let shared = budget.times(part);
    let rest = |whole: Vector3<R>, toll: Vector3<R>| at_least_zero(whole - toll);
    Division {
        cut: [cut_first, cut_second],
        budget: [
            Vector3::select(cut_second, rest(budget, second), shared),
            Vector3::select(cut_first, rest(budget, first), at_least_zero(budget - shared)),
        ],
    }
}

/// Returns the lanes in which `budget` covers `toll` in every channel.
#[inline(always)]
pub fn pays<R: Real>(budget: Vector3<R>, toll: Vector3<R>) -> R::Mask {
    toll.x.le(budget.x) & toll.y.le(budget.y) & toll.z.le(budget.z)
}

#[inline(always)]
fn root_share<R: Real>(one: R, other: R) -> R {
    let (one, other) = (one.sqrt(), other.sqrt());
    let sum = one + other;
    R::select(sum.gt(R::zero()), one / sum, R::splat(0.5))
}

#[inline(always)]
fn at_least_zero<R: Real>(v: Vector3<R>) -> Vector3<R> {
    Vector3::new(v.x.max(R::zero()), v.y.max(R::zero()), v.z.max(R::zero()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(x: f64) -> Vector3<f64> {
        Vector3::all(x)
    }

    #[test]
    fn what_is_cut_and_what_is_handed_on_never_exceed_the_budget() {
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            10_f64.powf((state >> 33) as f64 / f64::from(1_u32 << 31) * 8.0 - 6.0)
        };
        let (mut cut, mut kept) = (0, 0);
        for _ in 0..100_000 {
            let mut colour = || Vector3::new(number(), number(), number());
            let (budget, tolls) = (colour(), [colour(), colour()]);
            let division = divide(budget, tolls);
            let mut used = grey(0.0);
            for (k, &toll) in tolls.iter().enumerate() {
                used = used + if division.cut[k] { toll } else { division.budget[k] };
                if division.cut[k] { cut += 1 } else { kept += 1 }
            }
            assert!(pays(budget * (1.0 + 1e-15), used), "{budget:?} {tolls:?} {division:?}");
        }
        assert!(cut > 1000 && kept > 1000);
    }

    #[test]
    fn the_smaller_is_cut_first_and_both_where_both_fit() {
        let division = divide(grey(1.0), [grey(0.25), grey(0.5)]);
        assert_eq!(division.cut, [true, true]);
        let division = divide(grey(1.0), [grey(0.75), grey(0.5)]);
        assert_eq!((division.cut, division.budget[0]), ([false, true], grey(0.5)));
        let division = divide(grey(1.0), [grey(4.0), grey(36.0)]);
        assert_eq!((division.cut, division.budget), ([false, false], [grey(0.25), grey(0.75)]));
        // One ray alone keeps the whole budget.
        let division = divide(grey(1.0), [grey(4.0), grey(0.0)]);
        assert_eq!((division.cut[0], division.budget[0]), (false, grey(1.0)));
        // The toll must fit in every channel.
        let division = divide(grey(1.0), [Vector3::new(0.1, 0.1, 2.0), grey(0.0)]);
        assert!(!division.cut[0]);
    }
}
