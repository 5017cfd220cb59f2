//! How surfaces divide light: by a formula for light without polarisation, or with what each ray carries of it.

use super::super::extra::Extra8;
use super::super::queue::Rgb8;
use super::super::shading::Shading;
use super::super::surface::Surface8;
use super::WHITE;
use super::dielectric::{fixed_shares, ruled};
use crate::math::Real;
use crate::optics::{Boundary, Crossing, Exact, FresnelFormula, Mueller, thin_reflectance};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// A way that light goes on: its share, tints not counted, and what is carried, in the frame of the plane of incidence.
pub struct Way<C> {
    pub share: Rgb8,
    pub carried: C,
}

/// Reflected, and refracted or straight on.
pub struct Ways<C> {
    pub back: Way<C>,
    pub on: Way<C>,
}

/// How light is divided, as a type, so that a stage holds one way of doing it and no branch.
pub trait Optics: 'static {
    /// What a stage looks at of what a ray carries.
    type Carried: Copy;

    /// The formula for light without polarisation, which is what dispersed light is taken for.
    type Formula: FresnelFormula;

    /// Of the rays that met a surface, in the frames of their planes of incidence at these normals.
    fn before(shading: &Shading, surface: &Surface8, normal: Vec3x8) -> Self::Carried;

    /// Of the rays that leave into `dir`; none where it is what they brought.
    fn along(carried: &Self::Carried, dir: Vec3x8) -> Option<Extra8>;

    /// At a boundary, by each lane's rule.
    fn boundary(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Self::Carried,
    ) -> Ways<Self::Carried>;

    /// At a pane, by each lane's rule.
    fn pane(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Self::Carried,
    ) -> Ways<Self::Carried>;

    /// At a coat.
    fn coat(boundary: &Boundary<F32x8>, at: &Crossing<F32x8>, before: &Self::Carried) -> Way<Self::Carried>;

    /// At a metal.
    fn metal(cos_i: F32x8, eta: Vec3x8, k: Vec3x8, before: &Self::Carried) -> Way<Self::Carried>;

    /// At a mirror that treats all light alike.
    fn mirror(before: &Self::Carried) -> Self::Carried;

    /// Straight through panes (`thin`) and boundaries, of which `fixed` ones have fixed shares: what is not let through,
    /// and what is carried on.
    fn through(
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        thin: Mask8,
        fixed: (Mask8, Rgb8),
        before: &Self::Carried,
    ) -> Way<Self::Carried>;
}

/// By a formula for light without polarisation.
pub struct Unpolarised<F>(std::marker::PhantomData<F>);

impl<F: FresnelFormula> Optics for Unpolarised<F> {
    type Carried = ();
    type Formula = F;

    #[inline(always)]
    fn before(_: &Shading, _: &Surface8, _: Vec3x8) {}

    #[inline(always)]
    fn along((): &(), _: Vec3x8) -> Option<Extra8> {
        None
    }

    #[inline(always)]
    fn boundary(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        (): &(),
    ) -> Ways<()> {
        plain(ruled(shading, surface, Vec3x8::all(F::dielectric(boundary, at)), at.total))
    }

    #[inline(always)]
    fn pane(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        (): &(),
    ) -> Ways<()> {
        plain(ruled(shading, surface, Vec3x8::all(thin_reflectance(F::dielectric(boundary, at))), at.total))
    }

    #[inline(always)]
    fn coat(boundary: &Boundary<F32x8>, at: &Crossing<F32x8>, (): &()) -> Way<()> {
        Way { share: Vec3x8::all(F::dielectric(boundary, at)), carried: () }
    }

    #[inline(always)]
    fn metal(cos_i: F32x8, eta: Vec3x8, k: Vec3x8, (): &()) -> Way<()> {
        Way { share: F::conductor_rgb(cos_i, eta, k), carried: () }
    }

    #[inline(always)]
    fn mirror((): &()) {}

    #[inline(always)]
    fn through(
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        thin: Mask8,
        (fixed, shares): (Mask8, Rgb8),
        (): &(),
    ) -> Way<()> {
        let face = F::dielectric(boundary, at);
        let reflectance = Real::select(thin, thin_reflectance(face), face);
        Way { share: Vec3x8::select(fixed & !at.total, shares, Vec3x8::all(reflectance)), carried: () }
    }
}

#[inline(always)]
fn plain(share: Rgb8) -> Ways<()> {
    Ways { back: Way { share, carried: () }, on: Way { share: WHITE - share, carried: () } }
}

/// With what each ray carries of its polarisation.
pub struct Polarised;

impl Polarised {
    /// Both ways at surfaces of which `fixed` ones have fixed shares: those treat both polarisations alike.
    #[inline(always)]
    fn ways(back: Mueller<F32x8>, on: Mueller<F32x8>, (fixed, shares): (Mask8, Rgb8), before: &Extra8) -> Ways<Extra8> {
        let back = Mueller::select(fixed, Mueller::mirror(F32x8::ONE), back);
        let on = Mueller::select(fixed, Mueller::straight(F32x8::ONE), on);
        let (back, on) = ([back; 3], [on; 3]);
        let share = Vec3x8::select(fixed, shares, before.gain(&back));
        Ways {
            back: Way { share, carried: before.then(&back) },
            on: Way { share: WHITE - share, carried: before.then(&on) },
        }
    }
}

impl Optics for Polarised {
    type Carried = Extra8;
    type Formula = Exact;

    #[inline(always)]
    fn before(shading: &Shading, surface: &Surface8, normal: Vec3x8) -> Extra8 {
        shading.extras[surface.place as usize].facing(surface.incident, normal)
    }

    #[inline(always)]
    fn along(carried: &Extra8, dir: Vec3x8) -> Option<Extra8> {
        Some(carried.along(dir))
    }

    #[inline(always)]
    fn boundary(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Extra8,
    ) -> Ways<Extra8> {
        let (fixed, shares) = fixed_shares(shading, surface, WHITE);
        let (back, on) = (Mueller::reflected(boundary, at), Mueller::refracted(boundary, at));
        Self::ways(back, on, (fixed & !at.total, shares), before)
    }

    #[inline(always)]
    fn pane(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Extra8,
    ) -> Ways<Extra8> {
        let (fixed, shares) = fixed_shares(shading, surface, WHITE);
        let (back, on) = Mueller::reflected(boundary, at).pane(at.total);
        Self::ways(back, on, (fixed & !at.total, shares), before)
    }

    #[inline(always)]
    fn coat(boundary: &Boundary<F32x8>, at: &Crossing<F32x8>, before: &Extra8) -> Way<Extra8> {
        let surface = [Mueller::reflected(boundary, at); 3];
        Way { share: before.gain(&surface), carried: before.then(&surface) }
    }

    #[inline(always)]
    fn metal(cos_i: F32x8, eta: Vec3x8, k: Vec3x8, before: &Extra8) -> Way<Extra8> {
        let channel = |eta: F32x8, k: F32x8| Mueller::metal(cos_i, eta, k);
        let surface = [channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z)];
        Way { share: before.gain(&surface), carried: before.then(&surface) }
    }

    #[inline(always)]
    fn mirror(before: &Extra8) -> Extra8 {
        before.then(&[Mueller::mirror(F32x8::ONE); 3])
    }

    #[inline(always)]
    fn through(
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        thin: Mask8,
        (fixed, shares): (Mask8, Rgb8),
        before: &Extra8,
    ) -> Way<Extra8> {
        let face = Mueller::reflected(boundary, at);
        let (pane, pane_on) = face.pane(at.total);
        let back = Mueller::select(thin, pane, face);
        let on = Mueller::select(thin, pane_on, Mueller::refracted(boundary, at));
        let Ways { back, on } = Self::ways(back, on, (fixed & !at.total, shares), before);
        Way { share: back.share, carried: on.carried }
    }
}
