//! Double-double numbers, with twice the digits of `f64`, for computations that cancel in `f64`.
//!
//! The classical algorithms (Dekker 1971, Knuth 4.2.2) in the form of Joldes, Muller & Popescu 2017: relative error of a
//! sum or product below 2^-102, of a quotient or root below 2^-99.

use std::ops::{Add, Mul, Neg, Sub};

/// The sum of two `f64`; the low part is at most half an ulp of the high part.
#[derive(Clone, Copy, Debug)]
pub struct Double {
    high: f64,
    low: f64,
}

/// Converts a number to [`Double`].
#[must_use]
pub fn d(x: impl Into<f64>) -> Double {
    Double { high: x.into(), low: 0.0 }
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let part = s - a;
    (s, (a - (s - part)) + (b - part))
}

fn quick_two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    Double { high, low: b - (high - a) }
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    (p, a.mul_add(b, -p))
}

impl Double {
    /// The nearest `f64`.
    #[must_use]
    pub fn narrow(self) -> f64 {
        self.high + self.low
    }

    /// Returns true if the number is negative.
    #[must_use]
    pub fn is_negative(self) -> bool {
        self.high < 0.0
    }

    /// `self / o`, for `o` not zero.
    #[must_use]
    pub fn over(self, o: Self) -> Self {
        let first = self.high / o.high;
        let rest = self - o * d(first);
        let second = rest.high / o.high;
        let rest = rest - o * d(second);
        let q = quick_two_sum(first, second);
        q + d(rest.high / o.high)
    }

    /// Square root; zero for numbers that are not positive.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return d(0.0);
        }
        // Two Newton steps on the root itself, each doubling the digits.
        let root = d(self.high.sqrt());
        let half = d(0.5);
        let once = (root + self.over(root)) * half;
        (once + self.over(once)) * half
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let (s, e) = two_sum(self.high, o.high);
        let (t, f) = two_sum(self.low, o.low);
        let sum = quick_two_sum(s, e + t);
        quick_two_sum(sum.high, sum.low + f)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let (p, e) = two_product(self.high, o.high);
        quick_two_sum(p, e + (self.high * o.low + self.low * o.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_nine_digits_are_kept() {
        for x in [2.0, 1.5, 1e-8, 0.3, 7e9] {
            let root = d(x).sqrt();
            assert!((root * root - d(x)).narrow().abs() <= 1e-29 * x, "sqrt({x})");
        }
        let third = d(1.0).over(d(3.0));
        assert!((third * d(3.0) - d(1.0)).narrow().abs() <= 1e-29);
        assert!((third.over(third * third) - d(3.0)).narrow().abs() <= 1e-29);
        // 1 - cos^2 of an angle whose cosine is 1 - 2^-60 is 2^-59 to first order.
        let c = d(1.0) - d(2.0_f64.powi(-60));
        assert!(((d(1.0) - c * c).narrow() * 2.0_f64.powi(59) - 1.0).abs() <= 1e-10);
    }

    #[test]
    fn whole_numbers_are_exact() {
        let (a, b) = (d(9_007_199_254_740_993.0), d(3.0));
        assert_eq!((a * b - a - a - a).narrow(), 0.0);
        assert_eq!((a * a).over(a).narrow(), a.narrow());
    }
}
