//! Division of light at surfaces, by a formula for unpolarised light or by the polarisation that rays carry.

use super::super::extra::Extra8;
use super::super::queue::Rgb8;
use super::super::shading::Shading;
use super::super::surface::Surface8;
use super::WHITE;
use super::dielectric::{fixed_shares, ruled};
use crate::math::Real;
use crate::optics::{
    Boundary, Crossing, Exact, FresnelFormula, FresnelModel, FresnelVisitor, Mueller, thin_reflectance,
};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Lobe of light that leaves a surface: its share, excluding tints, and the carried polarisation in the frame of the
/// plane of incidence.
pub struct Lobe<C> {
    pub share: Rgb8,
    pub carried: C,
}

/// Both lobes of a transparent surface: `reflection`, and `transmission`, which is refracted or passes straight.
pub struct Lobes<C> {
    pub reflection: Lobe<C>,
    pub transmission: Lobe<C>,
}

/// Code to be called with the optics of a render.
pub trait OpticsVisitor {
    /// Result of the call.
    type Output;

    /// Is called with the optics as a type.
    fn visit<O: Optics>(self) -> Self::Output;
}

/// Calls `visitor` with the optics of a Fresnel formula.
pub fn dispatch<V: OpticsVisitor>(model: FresnelModel, visitor: V) -> V::Output {
    struct OfFormula<V>(V);
    impl<V: OpticsVisitor> FresnelVisitor for OfFormula<V> {
        type Output = V::Output;
        fn visit<F: FresnelFormula>(self, _formula: F) -> V::Output {
            self.0.visit::<Unpolarised<F>>()
        }
    }
    match model {
        FresnelModel::Polarised => visitor.visit::<Polarised>(),
        unpolarised => unpolarised.dispatch(OfFormula(visitor)),
    }
}

/// Polarised or unpolarised optics, as a type, so that a stage contains one of them and no branch.
pub trait Optics: 'static {
    /// Polarisation that a ray carries, as far as stages use it.
    type Carried: Copy;

    /// Formula for unpolarised light. Dispersed light always counts as unpolarised.
    type Formula: FresnelFormula;

    /// Returns the polarisation of the rays that hit a surface, in the frames of their planes of incidence at these
    /// normals.
    fn arriving(shading: &Shading, surface: &Surface8, normal: Vec3x8) -> Self::Carried;

    /// Returns the extras of rays that leave in `dir`, or `None` if they equal those of the arriving rays.
    fn leaving(carried: &Self::Carried, dir: Vec3x8) -> Option<Extra8>;

    /// Divides light at a boundary, by each lane's rule.
    fn boundary(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Self::Carried,
    ) -> Lobes<Self::Carried>;

    /// Divides light at a pane, by each lane's rule.
    fn pane(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Self::Carried,
    ) -> Lobes<Self::Carried>;

    /// Reflects light at a coat.
    fn coat(boundary: &Boundary<F32x8>, at: &Crossing<F32x8>, before: &Self::Carried) -> Lobe<Self::Carried>;

    /// Reflects light at a metal.
    fn metal(cos_i: F32x8, eta: Vec3x8, k: Vec3x8, before: &Self::Carried) -> Lobe<Self::Carried>;

    /// Returns the polarisation after a mirror that reflects all polarisations alike.
    fn mirror(before: &Self::Carried) -> Self::Carried;

    /// Transmits light straight through panes (`thin`) and boundaries, of which `fixed` ones have fixed shares. Returns
    /// the share that is not transmitted, and the polarisation of the rest.
    fn through(
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        thin: Mask8,
        fixed: (Mask8, Rgb8),
        before: &Self::Carried,
    ) -> Lobe<Self::Carried>;
}

/// Optics by a formula for unpolarised light.
pub struct Unpolarised<F>(std::marker::PhantomData<F>);

impl<F: FresnelFormula> Optics for Unpolarised<F> {
    type Carried = ();
    type Formula = F;

    #[inline(always)]
    fn arriving(_: &Shading, _: &Surface8, _: Vec3x8) {}

    #[inline(always)]
    fn leaving((): &(), _: Vec3x8) -> Option<Extra8> {
        None
    }

    #[inline(always)]
    fn boundary(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        (): &(),
    ) -> Lobes<()> {
        plain(ruled(shading, surface, Vec3x8::all(F::dielectric(boundary, at)), at.total))
    }

    #[inline(always)]
    fn pane(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        (): &(),
    ) -> Lobes<()> {
        plain(ruled(shading, surface, Vec3x8::all(thin_reflectance(F::dielectric(boundary, at))), at.total))
    }

    #[inline(always)]
    fn coat(boundary: &Boundary<F32x8>, at: &Crossing<F32x8>, (): &()) -> Lobe<()> {
        Lobe { share: Vec3x8::all(F::dielectric(boundary, at)), carried: () }
    }

    #[inline(always)]
    fn metal(cos_i: F32x8, eta: Vec3x8, k: Vec3x8, (): &()) -> Lobe<()> {
        Lobe { share: F::conductor_rgb(cos_i, eta, k), carried: () }
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
    ) -> Lobe<()> {
        let face = F::dielectric(boundary, at);
        let reflectance = Real::select(thin, thin_reflectance(face), face);
        Lobe { share: Vec3x8::select(fixed & !at.total, shares, Vec3x8::all(reflectance)), carried: () }
    }
}

#[inline(always)]
fn plain(share: Rgb8) -> Lobes<()> {
    Lobes { reflection: Lobe { share, carried: () }, transmission: Lobe { share: WHITE - share, carried: () } }
}

/// Optics with the polarisation that each ray carries.
pub struct Polarised;

impl Polarised {
    /// Divides light at surfaces with these Mueller matrices, of which `fixed` ones have fixed shares and treat all
    /// polarisations alike.
    #[inline(always)]
    fn lobes(
        reflection: Mueller<F32x8>,
        transmission: Mueller<F32x8>,
        (fixed, shares): (Mask8, Rgb8),
        before: &Extra8,
    ) -> Lobes<Extra8> {
        let reflection = Mueller::select(fixed, Mueller::mirror(F32x8::ONE), reflection);
        let transmission = Mueller::select(fixed, Mueller::straight(F32x8::ONE), transmission);
        let (reflection, transmission) = ([reflection; 3], [transmission; 3]);
        let share = Vec3x8::select(fixed, shares, before.gain(&reflection));
        Lobes {
            reflection: Lobe { share, carried: before.then(&reflection) },
            transmission: Lobe { share: WHITE - share, carried: before.then(&transmission) },
        }
    }
}

impl Optics for Polarised {
    type Carried = Extra8;
    type Formula = Exact;

    #[inline(always)]
    fn arriving(shading: &Shading, surface: &Surface8, normal: Vec3x8) -> Extra8 {
        shading.extras[surface.place as usize].facing(surface.incident, normal)
    }

    #[inline(always)]
    fn leaving(carried: &Extra8, dir: Vec3x8) -> Option<Extra8> {
        Some(carried.along(dir))
    }

    #[inline(always)]
    fn boundary(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Extra8,
    ) -> Lobes<Extra8> {
        let (fixed, shares) = fixed_shares(shading, surface, WHITE);
        let (reflection, transmission) = (Mueller::reflected(boundary, at), Mueller::refracted(boundary, at));
        Self::lobes(reflection, transmission, (fixed & !at.total, shares), before)
    }

    #[inline(always)]
    fn pane(
        shading: &Shading,
        surface: &Surface8,
        boundary: &Boundary<F32x8>,
        at: &Crossing<F32x8>,
        before: &Extra8,
    ) -> Lobes<Extra8> {
        let (fixed, shares) = fixed_shares(shading, surface, WHITE);
        let (reflection, transmission) = Mueller::reflected(boundary, at).pane(at.total);
        Self::lobes(reflection, transmission, (fixed & !at.total, shares), before)
    }

    #[inline(always)]
    fn coat(boundary: &Boundary<F32x8>, at: &Crossing<F32x8>, before: &Extra8) -> Lobe<Extra8> {
        let surface = [Mueller::reflected(boundary, at); 3];
        Lobe { share: before.gain(&surface), carried: before.then(&surface) }
    }

    #[inline(always)]
    fn metal(cos_i: F32x8, eta: Vec3x8, k: Vec3x8, before: &Extra8) -> Lobe<Extra8> {
        let channel = |eta: F32x8, k: F32x8| Mueller::metal(cos_i, eta, k);
        let surface = [channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z)];
        Lobe { share: before.gain(&surface), carried: before.then(&surface) }
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
    ) -> Lobe<Extra8> {
        let face = Mueller::reflected(boundary, at);
        let (pane, pane_transmission) = face.pane(at.total);
        let reflection = Mueller::select(thin, pane, face);
        let transmission = Mueller::select(thin, pane_transmission, Mueller::refracted(boundary, at));
        let Lobes { reflection, transmission } =
            Self::lobes(reflection, transmission, (fixed & !at.total, shares), before);
        Lobe { share: reflection.share, carried: transmission.carried }
    }
}
