//! How much light a boundary reflects.

use super::{Boundary, Crossing};
use crate::math::{Real, Vector3};

/// The choice between the formulas, where it is still data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FresnelModel {
    /// The Fresnel equations for unpolarised light.
    #[default]
    Exact,
    /// Schlick's approximation (1994).
    Schlick,
    /// No angle dependence: the reflectance at normal incidence for every angle.
    Off,
}

/// The choice between the formulas as a type, so that a shading stage holds one of them and no branch.
pub trait FresnelFormula: Copy + Send + Sync + 'static {
    /// The data form of this choice.
    const MODEL: FresnelModel;

    /// Unpolarised reflectance of a dielectric boundary, 0..=1; 1 where the crossing is total.
    fn dielectric<R: Real>(boundary: &Boundary<R>, at: &Crossing<R>) -> R;

    /// Unpolarised reflectance of a metal with relative index `eta + i k` (metal over incident medium), 0..=1.
    fn conductor<R: Real>(cos_i: R, eta: R, k: R) -> R;

    /// [`FresnelFormula::conductor`] for three channels.
    #[inline(always)]
    fn conductor_rgb<R: Real>(cos_i: R, eta: Vector3<R>, k: Vector3<R>) -> Vector3<R> {
        Vector3::new(
            Self::conductor(cos_i, eta.x, k.x),
            Self::conductor(cos_i, eta.y, k.y),
            Self::conductor(cos_i, eta.z, k.z),
        )
    }
}

/// The Fresnel equations.
#[derive(Clone, Copy, Debug)]
pub struct Exact;

/// Schlick's approximation.
#[derive(Clone, Copy, Debug)]
pub struct Schlick;

/// The reflectance at normal incidence, at every angle.
#[derive(Clone, Copy, Debug)]
pub struct AtNormal;

impl FresnelFormula for Exact {
    const MODEL: FresnelModel = FresnelModel::Exact;

    /// `R = r_s^2 (1 + q^2) / 2` with `r_s = kc / (cos_i + b)^2` and `q = r_p / r_s = (c b - s^2) / (c b + s^2)`:
    /// the same numbers as `((n1 c_i - n2 c_t) / (n1 c_i + n2 c_t))^2` and its twin, halved, without their
    /// cancellation at index ratios near 1.
    #[inline(always)]
    fn dielectric<R: Real>(boundary: &Boundary<R>, at: &Crossing<R>) -> R {
        let one = R::one();
        let c = at.cos_i.min(one);
        let sum = c + at.b;
        let r_s = boundary.kc / (sum * sum);
        let cb = c * at.b;
        let s2 = (one - c) * (one + c);
        let q = (cb - s2) / (cb + s2);
        let r = (r_s * r_s) * q.fma(q, one) * R::splat(0.5);
        // `min` also turns 0/0 at grazing incidence (cos_i = b = 0) into 1.
        let r = r.min(one);
        let r = R::select(at.total, one, r);
        R::select(boundary.kc.eq(R::zero()), R::zero(), r)
    }

    #[inline(always)]
    fn conductor<R: Real>(cos_i: R, eta: R, k: R) -> R {
        conductor_exact(cos_i, eta, k)
    }
}

impl FresnelFormula for Schlick {
    const MODEL: FresnelModel = FresnelModel::Schlick;

    /// `R0 + (1 - R0) (1 - c)^5`, with `c` the cosine on the thinner side: `cos_t` when leaving the denser medium.
    #[inline(always)]
    fn dielectric<R: Real>(boundary: &Boundary<R>, at: &Crossing<R>) -> R {
        let leaving = boundary.kc.gt(R::zero());
        let r = schlick(boundary.r0, R::select(leaving, at.cos_t, at.cos_i));
        R::select(at.total, R::one(), r)
    }

    #[inline(always)]
    fn conductor<R: Real>(cos_i: R, eta: R, k: R) -> R {
        conductor_schlick(cos_i, eta, k)
    }
}

impl FresnelFormula for AtNormal {
    const MODEL: FresnelModel = FresnelModel::Off;

    #[inline(always)]
    fn dielectric<R: Real>(boundary: &Boundary<R>, at: &Crossing<R>) -> R {
        R::select(at.total, R::one(), boundary.r0)
    }

    #[inline(always)]
    fn conductor<R: Real>(_cos_i: R, eta: R, k: R) -> R {
        conductor_at_normal(eta, k)
    }
}

/// Schlick's weight on a given cosine.
#[inline(always)]
fn schlick<R: Real>(r0: R, cos: R) -> R {
    let m = (R::one() - cos).max(R::zero());
    let m2 = m * m;
    (R::one() - r0).fma(m2 * m2 * m, r0)
}

/// Reflectance of a metal at normal incidence: `((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2)`.
#[inline(always)]
fn conductor_at_normal<R: Real>(eta: R, k: R) -> R {
    let k2 = k * k;
    let (less, more) = (eta - R::one(), eta + R::one());
    less.fma(less, k2) / more.fma(more, k2)
}

/// Schlick's approximation with a metal's reflectance at normal incidence.
#[inline(always)]
pub fn conductor_schlick<R: Real>(cos_i: R, eta: R, k: R) -> R {
    schlick(conductor_at_normal(eta, k), cos_i)
}

/// The Fresnel equations for a metal, unpolarised (Born & Wolf, section 14.2, in the real form of Mitsuba and
/// Lagarde's notes: `a^2 + b^2` and `2 a cos`).
#[inline(always)]
pub fn conductor_exact<R: Real>(cos_i: R, eta: R, k: R) -> R {
    let c = cos_i.min(R::one());
    let c2 = c * c;
    let s2 = (R::one() - c) * (R::one() + c);
    // a^2 - b^2 = eta^2 - k^2 - sin^2 and a b = eta k define a + i b, the metal's own cosine times its index.
    let difference = (eta - k) * (eta + k) - s2;
    let product = eta * k;
    let a2_plus_b2 = difference.fma(difference, R::splat(4.0) * product * product).sqrt();
    let a = (R::splat(0.5) * (a2_plus_b2 + difference)).safe_sqrt();
    let twice_ac = R::splat(2.0) * a * c;
    let sum = a2_plus_b2 + c2;
    let r_s = (sum - twice_ac) / (sum + twice_ac);
    let product_sum = a2_plus_b2.fma(c2, s2 * s2);
    let slope = twice_ac * s2;
    let r_p = r_s * ((product_sum - slope) / (product_sum + slope));
    (R::splat(0.5) * (r_s + r_p)).min(R::one())
}

/// Reflectance of a thin pane with all its inner reflections summed, `2 R / (1 + R)`, from one face's `R`.
#[inline(always)]
pub fn thin_reflectance<R: Real>(r: R) -> R {
    (r + r) / (R::one() + r)
}
