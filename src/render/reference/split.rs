//! Division of light at surfaces, for one ray.

use glam::DVec3;

use super::polarisation::Polarisation;
use crate::optics::{Boundary, Crossing, FresnelFormula, FresnelModel, FresnelVisitor, Mueller, thin_reflectance};
use crate::scene::FresnelRule;

/// Lobe of light that leaves a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lobe {
    /// Share per channel, excluding tints.
    pub share: DVec3,
    /// Polarisation carried on, in the frame of the plane of incidence, if polarisation is computed.
    pub polarisation: Option<Polarisation>,
}

/// Both lobes of a transparent surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lobes {
    /// Reflected lobe.
    pub reflection: Lobe,
    /// Lobe that is refracted or passes straight.
    pub transmission: Lobe,
}

/// Divides light at a boundary. `before` is the arriving polarisation in the frame of the plane of incidence.
pub(super) fn at_boundary(
    model: FresnelModel,
    rule: FresnelRule,
    boundary: &Boundary<f64>,
    at: &Crossing<f64>,
    before: Option<Polarisation>,
) -> Lobes {
    match (rule, before) {
        (FresnelRule::Fixed(share), _) if !at.total => fixed(share.as_dvec3(), before),
        (_, None) => plain(reflectance(model, boundary, at)),
        (_, Some(before)) => {
            lobes(&before, [Mueller::reflected(boundary, at); 3], [Mueller::refracted(boundary, at); 3])
        }
    }
}

/// Divides light at a pane, given the boundary to its inside.
pub(super) fn at_pane(
    model: FresnelModel,
    rule: FresnelRule,
    boundary: &Boundary<f64>,
    at: &Crossing<f64>,
    before: Option<Polarisation>,
) -> Lobes {
    match (rule, before) {
        (FresnelRule::Fixed(share), _) if !at.total => fixed(share.as_dvec3(), before),
        (_, None) => plain(thin_reflectance(reflectance(model, boundary, at))),
        (_, Some(before)) => {
            let (reflection, transmission) = Mueller::reflected(boundary, at).pane(at.total);
            lobes(&before, [reflection; 3], [transmission; 3])
        }
    }
}

/// Reflects light at a metal.
pub(super) fn at_metal(model: FresnelModel, cos_i: f64, eta: DVec3, k: DVec3, before: Option<Polarisation>) -> Lobe {
    match before {
        None => Lobe { share: of_metal(model, cos_i, eta, k), polarisation: None },
        Some(before) => {
            let surface = std::array::from_fn(|c| Mueller::metal(cos_i, eta[c], k[c]));
            Lobe { share: before.gain(&surface), polarisation: Some(before.then(&surface)) }
        }
    }
}

/// Reflects light at a mirror of fixed reflectance, which treats all polarisations alike.
pub(super) fn at_mirror(share: DVec3, before: Option<Polarisation>) -> Lobe {
    Lobe { share, polarisation: before.map(|before| before.then(&[Mueller::mirror(1.0); 3])) }
}

fn plain(r: f64) -> Lobes {
    let lobe = |share| Lobe { share: DVec3::splat(share), polarisation: None };
    Lobes { reflection: lobe(r), transmission: lobe(1.0 - r) }
}

/// Divides light by a fixed share, which does not depend on polarisation. Only the mirror's reversal changes it.
fn fixed(share: DVec3, before: Option<Polarisation>) -> Lobes {
    Lobes {
        reflection: at_mirror(share, before),
        transmission: Lobe { share: DVec3::ONE - share, polarisation: before },
    }
}

fn lobes(before: &Polarisation, reflection: [Mueller<f64>; 3], transmission: [Mueller<f64>; 3]) -> Lobes {
    let share = before.gain(&reflection);
    Lobes {
        reflection: Lobe { share, polarisation: Some(before.then(&reflection)) },
        transmission: Lobe { share: DVec3::ONE - share, polarisation: Some(before.then(&transmission)) },
    }
}

/// Returns the reflectance of a dielectric boundary for unpolarised light.
fn reflectance(model: FresnelModel, boundary: &Boundary<f64>, at: &Crossing<f64>) -> f64 {
    struct Of<'a>(&'a Boundary<f64>, &'a Crossing<f64>);
    impl FresnelVisitor for Of<'_> {
        type Output = f64;
        fn visit<F: FresnelFormula>(self, _formula: F) -> f64 {
            F::dielectric(self.0, self.1)
        }
    }
    model.dispatch(Of(boundary, at))
}

/// Returns the reflectance of a metal for unpolarised light.
fn of_metal(model: FresnelModel, cos_i: f64, eta: DVec3, k: DVec3) -> DVec3 {
    struct Of(f64, DVec3, DVec3);
    impl FresnelVisitor for Of {
        type Output = DVec3;
        fn visit<F: FresnelFormula>(self, _formula: F) -> DVec3 {
            F::conductor_rgb(self.0, self.1.into(), self.2.into()).into()
        }
    }
    model.dispatch(Of(cos_i, eta, k))
}
