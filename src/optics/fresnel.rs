//! Reflectance of a boundary between dielectrics.

use super::boundary::{Boundary, Crossing};
use super::conductor::{conductor_at_normal, conductor_exact, conductor_schlick};
use super::polarised::Amplitudes;
use super::schlick::schlick;
use crate::math::{Real, Vector3};

crate::choice! {
    /// Formula for the share of light that a surface reflects.
    pub enum FresnelModel("fresnel", derive(Eq, Hash), default(Exact), visitor(FresnelVisitor, FresnelFormula)) {
        /// Reflectance at normal incidence, used at every angle.
        "off" => Off by AtNormal,
        /// Schlick's approximation of 1994.
        "schlick" => Schlick by Schlick,
        /// Fresnel equations for unpolarised light.
        "exact" => Exact by Exact,
        /// Fresnel equations with the polarisation carried along every path.
        ///
        /// Unpolarised light is divided as by [`Exact`]; [`super::Mueller`] describes the polarisation.
        "polarised" => Polarised by Exact,
    }
}

/// Fresnel formula as a type, so that a shading stage is compiled for it and holds no branch.
pub trait FresnelFormula: Copy + Send + Sync + 'static {
    /// Unpolarised reflectance of a dielectric boundary, 0..=1; 1 under total reflection.
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
    /// `R = r_s^2 (1 + q^2) / 2` with `r_s = kc / (cos_i + b)^2` and `q = r_p / r_s = (c b - s^2) / (c b + s^2)`.
    ///
    /// This equals half the sum of `((n1 c_i - n2 c_t) / (n1 c_i + n2 c_t))^2` and the same with `c_i` and `c_t` swapped,
    /// without the cancellation at index ratios near 1. The relative error is at most 1.2e-6 at every angle and index ratio
    /// where products are fused. Elsewhere it is at most 1.3e-3 next to the critical angle. Between equal indices the
    /// result is exactly 0.
    #[inline(always)]
    fn dielectric<R: Real>(boundary: &Boundary<R>, at: &Crossing<R>) -> R {
        let one = R::one();
        let Amplitudes { s: r_s, q } = Amplitudes::new(boundary, at);
        let r = (r_s * r_s) * q.fma(q, one) * R::splat(0.5);
        // `min` also turns 0/0 into 1: no light enters if the index ratio is beyond all bounds.
        let r = R::select(at.total, one, r.min(one));
        R::select(boundary.kc.eq(R::zero()), R::zero(), r)
    }

    #[inline(always)]
    fn conductor<R: Real>(cos_i: R, eta: R, k: R) -> R {
        conductor_exact(cos_i, eta, k)
    }
}

impl FresnelFormula for Schlick {
    /// `R0 + (1 - R0) (1 - c)^5`, with `c` the cosine on the thinner side. When leaving the denser medium it is `cos_t`
    /// (with `cos_i` the error would be up to 0.97).
    ///
    /// Its error against the Fresnel equations is up to 0.06 (water), 0.036 (glass) and 0.076 (diamond). It is 0.17 between
    /// water and glass and 0.855 between indices 1 and 1.0003, since the index enters only through `R0`. Equal indices are
    /// no boundary and reflect exactly 0, although the formula goes to 1 at grazing incidence.
    #[inline(always)]
    fn dielectric<R: Real>(boundary: &Boundary<R>, at: &Crossing<R>) -> R {
        let leaving = boundary.kc.gt(R::zero());
        let r = schlick(boundary.r0, R::select(leaving, at.cos_t, at.cos_i));
        let r = R::select(at.total, R::one(), r);
        R::select(boundary.kc.eq(R::zero()), R::zero(), r)
    }

    #[inline(always)]
    fn conductor<R: Real>(cos_i: R, eta: R, k: R) -> R {
        conductor_schlick(cos_i, eta, k)
    }
}

impl FresnelFormula for AtNormal {
    #[inline(always)]
    fn dielectric<R: Real>(boundary: &Boundary<R>, at: &Crossing<R>) -> R {
        R::select(at.total, R::one(), boundary.r0)
    }

    #[inline(always)]
    fn conductor<R: Real>(_cos_i: R, eta: R, k: R) -> R {
        conductor_at_normal(eta, k)
    }
}

/// Reflectance of a thin pane with all its inner reflections summed, `2 R / (1 + R)`, from one face's `R`.
#[inline(always)]
pub fn thin_reflectance<R: Real>(r: R) -> R {
    (r + r) / (R::one() + r)
}
