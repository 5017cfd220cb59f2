//! Textbook formulas evaluated with twice the digits of `f64`. Their cancellation leaves more than 50 correct bits.

use crate::math::Vector3;
use crate::math::double::{Double, d};

/// Three components.
#[derive(Clone, Copy, Debug)]
pub struct Direction([Double; 3]);

impl Direction {
    /// Converts a vector without rounding.
    #[must_use]
    pub fn of(v: Vector3<impl Into<f64>>) -> Self {
        Self([d(v.x), d(v.y), d(v.z)])
    }

    fn dot(self, o: Self) -> Double {
        self.0[0] * o.0[0] + self.0[1] * o.0[1] + self.0[2] * o.0[2]
    }

    /// `self a + o b`.
    fn sum(self, a: Double, o: Self, b: Double) -> Self {
        Self(std::array::from_fn(|k| self.0[k] * a + o.0[k] * b))
    }

    fn unit(self) -> Self {
        let length = self.dot(self).sqrt();
        Self(self.0.map(|x| x.over(length)))
    }

    /// Returns the angle to another vector, in radians. It is computed from their difference, so that small angles keep
    /// their digits.
    #[must_use]
    pub fn angle_to(self, o: Vector3<impl Into<f64>>) -> f64 {
        let me = self.unit();
        let them = Self::of(o).unit();
        let apart: [f64; 3] = std::array::from_fn(|k| (them.0[k] - me.0[k]).narrow());
        // The chord of unit vectors is twice the sine of half the angle.
        let chord = apart.iter().map(|x| x * x).sum::<f64>().sqrt();
        2.0 * (chord * 0.5).min(1.0).asin()
    }

    /// The largest difference between a component of this vector and of another.
    #[must_use]
    pub fn furthest_component(self, o: Vector3<impl Into<f64>>) -> f64 {
        let o = Self::of(o);
        (0..3).map(|k| (o.0[k] - self.0[k]).narrow().abs()).fold(0.0, f64::max)
    }
}

/// Returns `i - 2 (i . n) n` of exactly these vectors.
#[must_use]
pub fn mirror<T: Into<f64>>(i: Vector3<T>, n: Vector3<T>) -> Direction {
    let (i, n) = (Direction::of(i), Direction::of(n));
    i.sum(d(1.0), n, i.dot(n) * d(-2.0))
}

/// Snell's law for the directions of `i` and `n`; `None` under total reflection.
#[must_use]
pub fn refract<T: Into<f64>>(i: Vector3<T>, n: Vector3<T>, n1: f64, n2: f64) -> Option<Direction> {
    let (i, n) = (Direction::of(i).unit(), Direction::of(n).unit());
    let eta = d(n1).over(d(n2));
    let c = -i.dot(n);
    let cos2_t = d(1.0) - eta * eta * (d(1.0) - c * c);
    (!cos2_t.is_negative()).then(|| i.sum(eta, n, eta * c - cos2_t.sqrt()))
}

/// Reflectances for light polarised across and in the plane of incidence, at the cosine `c`.
#[must_use]
pub fn reflectances(c: impl Into<f64>, n1: f64, n2: f64) -> (f64, f64) {
    let (c, n1, n2) = (d(c), d(n1), d(n2));
    let eta = n1.over(n2);
    let cos2_t = d(1.0) - eta * eta * (d(1.0) - c * c);
    if cos2_t.is_negative() {
        return (1.0, 1.0);
    }
    let cos_t = cos2_t.sqrt();
    let s = (n1 * c - n2 * cos_t).over(n1 * c + n2 * cos_t);
    let p = (n2 * c - n1 * cos_t).over(n2 * c + n1 * cos_t);
    ((s * s).narrow(), (p * p).narrow())
}

/// Reflectance of unpolarised light at the cosine `c`.
#[must_use]
pub fn reflectance(c: impl Into<f64>, n1: f64, n2: f64) -> f64 {
    let (s, p) = reflectances(c, n1, n2);
    0.5 * (s + p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_reflectances_come_out() {
        // Normal incidence on glass, and Mitsuba 3's golden value at 80 degrees (test_fresnel.py).
        assert!((reflectance(1.0, 1.0, 1.5) - 0.04).abs() < 1e-15);
        assert!((reflectance(80.0_f32.to_radians().cos(), 1.0, 1.5) - 0.387_704_354_691_473).abs() < 1e-6);
        assert_eq!(reflectance(0.5, 1.5, 1.0), 1.0);
    }

    #[test]
    fn right_angles_are_mirrored_and_bent_as_by_hand() {
        let half = 0.5_f32.sqrt();
        let (i, n) = (Vector3::new(half, -half, 0.0), Vector3::new(0.0_f32, 1.0, 0.0));
        assert!(mirror(i, n).angle_to(Vector3::new(half, half, 0.0)) < 1e-15);
        // sin(th2) = sin(45) / sqrt(2) = 1/2.
        let bent = refract(i, n, 1.0, std::f64::consts::SQRT_2).expect("no total reflection");
        assert!(bent.angle_to(Vector3::new(0.5, -0.75_f32.sqrt(), 0.0)) < 1e-7);
        assert!(refract(i, n, 1.5, 1.0).is_none());
    }
}
