//! The textbook in double-double: cancellation that costs an `f32` or `f64` everything costs it half its digits.
//!
//! There is another such oracle in the crate (`optics::oracle`, for `vitrum verify` and `vitrum price --formulas`), with
//! arithmetic of its own. This one is over a library's and shares no line with it, so that neither judges by its own
//! mistakes: they are held to agree below.

use twofloat::TwoFloat as D;
use vitrum::math::Vector3;

pub fn d(x: impl Into<f64>) -> D {
    D::from(x.into())
}

pub fn narrow(x: D) -> f64 {
    x.hi() + x.lo()
}

/// `a / b`. Not the library's (twofloat 0.8.4), whose residual is rounded before it is used, so that its quotient of
/// two double-doubles is good to 53 bits only.
pub fn over(a: D, b: D) -> D {
    let q = a.hi() / b.hi();
    let rest = a - b * q;
    D::new_add(q, rest.hi() / b.hi())
}

#[derive(Clone, Copy)]
pub struct V(pub [D; 3]);

impl V {
    pub fn of(v: Vector3<f32>) -> Self {
        Self([d(v.x), d(v.y), d(v.z)])
    }

    pub fn dot(self, o: Self) -> D {
        self.0[0] * o.0[0] + self.0[1] * o.0[1] + self.0[2] * o.0[2]
    }

    /// `self a + o b`.
    pub fn sum(self, a: D, o: Self, b: D) -> Self {
        Self(std::array::from_fn(|k| self.0[k] * a + o.0[k] * b))
    }

    pub fn unit(self) -> Self {
        let length = self.dot(self).sqrt();
        Self(self.0.map(|x| over(x, length)))
    }

    /// The angle between this unit vector and another vector, from their difference, so that small angles keep
    /// their digits.
    pub fn angle_to(self, o: Vector3<f32>) -> f64 {
        let o = [o.x, o.y, o.z].map(f64::from);
        let e: [f64; 3] = std::array::from_fn(|k| (o[k] - self.0[k].hi()) - self.0[k].lo());
        let me = self.0.map(narrow);
        let cross = |i: usize, j: usize| e[i] * me[j] - e[j] * me[i];
        let sine = (cross(0, 1).powi(2) + cross(1, 2).powi(2) + cross(2, 0).powi(2)).sqrt();
        let cosine = o[0] * me[0] + o[1] * me[1] + o[2] * me[2];
        sine.atan2(cosine)
    }
}

/// `i - 2 (i . n) n` of the directions that `i` and `n` stand for.
pub fn mirror(i: V, n: V) -> V {
    i.sum(d(1.0), n, i.dot(n) * -2.0)
}

/// Snell's law for the directions that `i` and `n` stand for; nothing under total reflection.
pub fn refract(i: Vector3<f32>, n: Vector3<f32>, n1: f64, n2: f64) -> Option<V> {
    let (i, n) = (V::of(i).unit(), V::of(n).unit());
    let eta = over(d(n1), d(n2));
    let c = -i.dot(n);
    let cos2_t = d(1.0) - eta * eta * (d(1.0) - c * c);
    (cos2_t >= 0.0).then(|| i.sum(eta, n, eta * c - cos2_t.sqrt()))
}

/// Squared cosine of the refracted angle, negative under total reflection.
pub fn cos2_t(c: D, n1: f64, n2: f64) -> D {
    let eta = over(d(n1), d(n2));
    d(1.0) - eta * eta * (d(1.0) - c * c)
}

/// Reflectances of both polarisations at the cosine `c`.
pub fn reflectances(c: impl Into<f64>, n1: f64, n2: f64) -> (f64, f64) {
    let c = d(c);
    let cos2_t = cos2_t(c, n1, n2);
    if cos2_t < 0.0 {
        return (1.0, 1.0);
    }
    let (cos_t, n1, n2) = (cos2_t.sqrt(), d(n1), d(n2));
    let s = over(n1 * c - n2 * cos_t, n1 * c + n2 * cos_t);
    let p = over(n2 * c - n1 * cos_t, n2 * c + n1 * cos_t);
    (narrow(s * s), narrow(p * p))
}

/// Reflectance of unpolarised light.
pub fn reflectance(c: impl Into<f64>, n1: f64, n2: f64) -> f64 {
    let (s, p) = reflectances(c, n1, n2);
    0.5 * (s + p)
}

/// Reflectance of a metal: complex division of the Fresnel amplitudes, all in double-double.
pub fn metal(c: f32, eta: f32, k: f32) -> f64 {
    let (c, eta, k) = (d(c), d(eta), d(k));
    let s2 = d(1.0) - c * c;
    // n cos_t = sqrt((eta + i k)^2 - sin^2) = a + i b.
    let (re, im) = (eta * eta - k * k - s2, eta * k * 2.0);
    let modulus = (re * re + im * im).sqrt();
    let a = ((modulus + re) * 0.5).sqrt();
    let b2 = (modulus - re) * 0.5;
    let b = b2.sqrt();
    let r_s = over((c - a) * (c - a) + b2, (c + a) * (c + a) + b2);
    // r_p = (n^2 c - n cos_t) / (n^2 c + n cos_t).
    let (x, y) = ((eta * eta - k * k) * c, im * c);
    let r_p = over((x - a) * (x - a) + (y - b) * (y - b), (x + a) * (x + a) + (y + b) * (y + b));
    narrow((r_s + r_p) * 0.5)
}

#[test]
fn the_crates_own_oracle_agrees_to_far_more_digits_than_f64_has() {
    use vitrum::optics::oracle;
    let mut state = 5_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut refracted = 0;
    for k in 0..2000 {
        let (n1, n2) = [(1.0, 1.5), (1.5, 1.0), (1.0, 1.0 + 1e-7), (2.42, 1.33)][k % 4];
        let i = Vector3::new(next(), next(), next());
        let n = Vector3::new(next(), next(), next());
        let n = if i.dot(n) > 0.0 { -n } else { n };
        let (ours, theirs) = (refract(i, n, n1, n2), oracle::refract(i, n, n1, n2));
        assert_eq!(ours.is_some(), theirs.is_some());
        if let (Some(ours), Some(theirs)) = (ours, theirs) {
            let nearest = Vector3::new(ours.0[0].hi(), ours.0[1].hi(), ours.0[2].hi());
            // The nearest f64 is half an ulp off; both say by how much, and say the same to 20 digits.
            let off = theirs.furthest_component(nearest);
            let rest = ours.0.iter().map(|x| x.lo().abs()).fold(0.0, f64::max);
            assert!((off - rest).abs() <= 1e-20, "{off:e} {rest:e}");
            refracted += 1;
        }
        let c = f64::from(next().abs());
        let reflectance = reflectance(c, n1, n2);
        assert!((oracle::reflectance(c, n1, n2) - reflectance).abs() <= 1e-14 * reflectance, "{c} {n1} {n2}");
    }
    assert!(refracted > 1000, "{refracted}");
}

#[test]
fn the_oracle_itself_keeps_twenty_nine_digits() {
    for x in [2.0, 1.5, 1e-8, 0.3] {
        let root = d(x).sqrt();
        assert!(narrow(root * root - x).abs() <= 1e-29 * x, "sqrt({x})");
    }
    let third = over(d(1.0), d(3.0));
    assert!(narrow(third * 3.0 - 1.0).abs() <= 1e-29);
    assert!(narrow(over(third, third * third) - 3.0).abs() <= 1e-29);
    // 1 - cos^2 of an angle whose cosine is 1 - 2^-60 is 2^-59 to first order.
    let c = d(1.0) - d(2.0_f64.powi(-60));
    assert!((narrow(d(1.0) - c * c) * 2.0_f64.powi(59) - 1.0).abs() <= 1e-10);
}
