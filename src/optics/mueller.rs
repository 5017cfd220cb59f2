//! Polarisation carried along a path, from the camera towards the lights.
//!
//! A surface acts on light by a Mueller matrix. In the frame of the surface, the first axis `s` lies across the plane of
//! incidence. For every boundary and every metal the matrix in this frame is
//!
//! ```text
//! a  b  0  0
//! b  a  0  0
//! 0  0  c -d
//! 0  0  d  c
//! ```
//!
//! The camera sees intensity: the first row of the product of all matrices from the camera on. Unpolarised light adds its
//! radiance times the first element of that row. So a ray carries that element as its weight, and the ratio of the other
//! three to it. This is the *diattenuation vector* of the path so far (Lu & Chipman 1996). It is zero at the camera and
//! never longer than 1.
//!
//! Frames: `x` is the axis that is carried, and `y = dir x x` with the direction of the *ray*, for every ray alike.
//! With the electric field's components along them and a time factor `exp(-i w t)`, `Q = |E_x|^2 - |E_y|^2` and `U + i
//! V = 2 E_x conj(E_y)`.

use super::boundary::{Boundary, Crossing};
use super::conductor::Metal;
use super::polarised::Amplitudes;
use crate::math::{Real, Vector3};

/// Action of a surface on light, in the frame of its plane of incidence. All zero if no light goes this way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mueller<R> {
    /// Share of unpolarised light that goes on: the mean of both polarisations, 0..=1.
    pub a: R,
    /// Half the difference between the shares of the `s` and the `p` part, within `-a..=a`.
    pub b: R,
    /// Cosine of the phase between the two parts, times the root of the product of their shares.
    pub c: R,
    /// Sine of that phase, times the same root. It is 0 except for total reflection and metals.
    pub d: R,
}

/// Excess of a path's transmittance for polarised light over that for unpolarised light, relative to the latter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diattenuation<R> {
    /// Linear polarisation along the frame's `x` (1 if only that is transmitted) against along its `y` (-1).
    pub q: R,
    /// Linear polarisation at 45 degrees between `x` and `y` against across that.
    pub u: R,
    /// Circular polarisation, one hand against the other.
    pub v: R,
}

/// Orientation of a plane of incidence in a ray's frame.
#[derive(Clone, Copy, Debug)]
pub struct PlaneOfIncidence<R> {
    /// Unit vector across the plane of incidence and across the ray: `x` of the surface's frame.
    pub s: Vector3<R>,
    /// Cosine of twice the angle from `x` to `s`.
    pub cos2: R,
    /// Sine of twice the angle from `x` to `s`.
    pub sin2: R,
}

impl<R: Real> Mueller<R> {
    /// A surface that sends no light this way.
    #[inline(always)]
    #[must_use]
    pub fn none() -> Self {
        let zero = R::zero();
        Self { a: zero, b: zero, c: zero, d: zero }
    }

    /// Light that goes straight on, reduced to the same share for both polarisations.
    #[inline(always)]
    #[must_use]
    pub fn straight(share: R) -> Self {
        Self { a: share, b: R::zero(), c: share, d: R::zero() }
    }

    /// An ideal mirror: the same share for both polarisations, with the `p` axis turned over.
    #[inline(always)]
    #[must_use]
    pub fn mirror(share: R) -> Self {
        Self { a: share, b: R::zero(), c: -share, d: R::zero() }
    }

    /// Reflection off a dielectric. `a` is the reflectance of [`super::Exact`] to the bit.
    #[inline(always)]
    #[must_use]
    pub fn reflected(boundary: &Boundary<R>, at: &Crossing<R>) -> Self {
        let (one, half, zero) = (R::one(), R::splat(0.5), R::zero());
        let Amplitudes { s, q } = Amplitudes::new(boundary, at);
        let r_s = (s * s).min(one);
        let partial =
            Self { a: (s * s * q.fma(q, one) * half).min(one), b: r_s * (-q).fma(q, one) * half, c: -r_s * q, d: zero };
        let total = Self::totally_reflected(boundary, at.cos_i);
        Self::select(boundary.kc.eq(zero), Self::none(), Self::select(at.total, total, partial))
    }

    /// Total reflection keeps all light of both polarisations, and `p` falls behind `s`. Half of the phase has the
    /// tangent `cos_i sqrt(sin_i^2 - (n2 / n1)^2) / sin_i^2`.
    #[inline(always)]
    fn totally_reflected(boundary: &Boundary<R>, cos_i: R) -> Self {
        let one = R::one();
        let s2 = (one - cos_i) * (one + cos_i);
        let beta = ((-cos_i).fma(cos_i, boundary.kc) + boundary.kc_low).safe_sqrt();
        let (x, y) = (s2, cos_i * beta);
        let over = one / x.fma(x, y * y);
        Self { a: one, b: R::zero(), c: (x - y) * (x + y) * over, d: (x + x) * y * over }
    }

    /// Refraction through a dielectric boundary; no light under total reflection.
    #[inline(always)]
    #[must_use]
    pub fn refracted(boundary: &Boundary<R>, at: &Crossing<R>) -> Self {
        let (one, half, zero) = (R::one(), R::splat(0.5), R::zero());
        let c = at.cos_i;
        let sum = c + at.b;
        let s2 = (one - c) * (one + c);
        // Cosine of the angle by which the ray is bent. The amplitudes of the two parts differ by this factor.
        let over = one / (boundary.eta * c.fma(at.b, s2));
        let t_s = R::splat(4.0) * c * at.b / (sum * sum);
        let t_p = t_s * over * over;
        let partial = Self { a: (t_s + t_p) * half, b: (t_s - t_p) * half, c: t_s * over, d: zero };
        Self::select(boundary.kc.eq(zero), Self::straight(one), Self::select(at.total, Self::none(), partial))
    }

    /// Reflection off a metal with relative index `eta + i k`. `a` is [`super::conductor_exact`] to the bit.
    #[inline(always)]
    #[must_use]
    pub fn metal(cos_i: R, eta: R, k: R) -> Self {
        let (one, half) = (R::one(), R::splat(0.5));
        let Metal { r_s, q2, q_re, q_im } = Metal::new(cos_i, eta, k);
        Self { a: (half * r_s.fma(q2, r_s)).min(one), b: half * (-r_s).fma(q2, r_s), c: -(r_s * q_re), d: r_s * q_im }
    }

    /// Reflection from and transmission through a pane whose face reflects as `self`, with the same medium on both
    /// sides. All inner reflections are summed without regard to their phases, which a thickness of many wavelengths
    /// averages out. If the face reflects totally, so does the pane.
    #[inline(always)]
    #[must_use]
    pub fn pane(self, total: R::Mask) -> (Self, Self) {
        let (one, half, zero) = (R::one(), R::splat(0.5), R::zero());
        let (r_s, r_p) = (self.a + self.b, self.a - self.b);
        let both = |r: R| {
            let back = (r + r) / (one + r);
            (back, (one - r) / (one + r))
        };
        let ((back_s, on_s), (back_p, on_p)) = (both(r_s), both(r_p));
        // Once in, k times to and fro, once out: t_s t_p (r_s r_p)^k in all. Odd k go back.
        let open = (-self.c).fma(self.c, one);
        let through = R::select(open.gt(zero), (one - r_s) * (one - r_p) / open, zero);
        let back =
            Self { a: (back_s + back_p) * half, b: (back_s - back_p) * half, c: through.fma(self.c, self.c), d: zero };
        let on = Self { a: (on_s + on_p) * half, b: (on_s - on_p) * half, c: through, d: zero };
        (Self::select(total, self, back), Self::select(total, Self::none(), on))
    }

    /// Selects `yes` in lanes in which `mask` is true, else `no`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            a: R::select(mask, yes.a, no.a),
            b: R::select(mask, yes.b, no.b),
            c: R::select(mask, yes.c, no.c),
            d: R::select(mask, yes.d, no.d),
        }
    }
}

impl<R: Real> Diattenuation<R> {
    /// Diattenuation of a path that treats all polarisations alike, such as one without surfaces.
    #[inline(always)]
    #[must_use]
    pub fn none() -> Self {
        Self { q: R::zero(), u: R::zero(), v: R::zero() }
    }

    /// Returns the same diattenuation in the frame whose `x` is the plane's `s`.
    #[inline(always)]
    #[must_use]
    pub fn in_plane(&self, plane: &PlaneOfIncidence<R>) -> Self {
        Self {
            q: self.q.fma(plane.cos2, self.u * plane.sin2),
            u: self.u.fma(plane.cos2, -(self.q * plane.sin2)),
            v: self.v,
        }
    }

    /// Returns the factor that a surface puts on the weight of a path with this diattenuation, in the surface's frame.
    /// It is in 0..=1, and clamped against rounding.
    #[inline(always)]
    #[must_use]
    pub fn gain(&self, surface: &Mueller<R>) -> R {
        self.q.fma(surface.b, surface.a).max(R::zero()).min(R::one())
    }

    /// Returns the diattenuation of the path extended by the surface, in the surface's frame; none if no light goes on.
    #[inline(always)]
    #[must_use]
    pub fn then(&self, surface: &Mueller<R>) -> Self {
        let gain = self.gain(surface);
        let over = R::select(gain.gt(R::zero()), R::one() / gain, R::zero());
        Self {
            q: self.q.fma(surface.a, surface.b) * over,
            u: self.u.fma(surface.c, self.v * surface.d) * over,
            v: self.v.fma(surface.c, -(self.u * surface.d)) * over,
        }
    }
}

impl<R: Real> PlaneOfIncidence<R> {
    /// Plane of incidence of a ray with unit direction `dir` and frame axis `x`, a unit vector across `dir`, at a
    /// surface with normal `normal`. At normal incidence, where any plane would do, it is the one across `x`.
    ///
    /// The angle is computed in the frame, so `s` is as exactly across the ray as `x` is, at any incidence.
    #[inline(always)]
    #[must_use]
    pub fn of_incidence(dir: Vector3<R>, x: Vector3<R>, normal: Vector3<R>) -> Self {
        let y = dir.cross(x);
        let (along_x, along_y) = (normal.dot(x), normal.dot(y));
        let across = along_x.fma(along_x, along_y * along_y);
        let leaning = across.gt(R::splat(1e-30));
        let over = R::select(leaning, R::one() / across.sqrt(), R::one());
        let cos = R::select(leaning, -along_y * over, R::one());
        let sin = R::select(leaning, along_x * over, R::zero());
        Self { s: x * cos + y * sin, cos2: (cos - sin) * (cos + sin), sin2: (cos + cos) * sin }
    }
}

/// Returns a unit vector across the unit vector `dir`: a frame for a ray without polarisation.
#[inline(always)]
pub fn any_across<R: Real>(dir: Vector3<R>) -> Vector3<R> {
    let zero = R::zero();
    let in_xy = Vector3::new(-dir.y, dir.x, zero);
    let in_yz = Vector3::new(zero, -dir.z, dir.y);
    Vector3::select(dir.z.abs().lt(dir.x.abs()), in_xy, in_yz).normalized()
}

/// Returns the unit vector across `dir` closest to `axis`, which is nearly across it. Rounding and bent normals tilt
/// frames a little.
#[inline(always)]
pub fn made_across<R: Real>(axis: Vector3<R>, dir: Vector3<R>) -> Vector3<R> {
    dir.fma(-axis.dot(dir), axis).normalized()
}
