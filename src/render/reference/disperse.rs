//! Dispersion in the `f64` renderer.

use glam::DVec3;

use super::media::MediumStack;
use super::split::{Lobe, Lobes, at_boundary};
use super::trace::{Arrival, Tracer};
use crate::math::Vector3;
use crate::optics::{Boundary, Crossing, SEPARATION};
use crate::render::record::{Recorder, Split};
use crate::scene::FresnelRule;

/// Boundary between two media at which wavelengths may separate.
#[derive(Clone, Debug)]
pub(super) struct Dispersing {
    pub from: u32,
    pub to: u32,
    /// Media behind it.
    pub beyond: MediumStack,
    pub rule: FresnelRule,
    pub tint: DVec3,
}

/// One wavelength at the boundary.
struct Band {
    nm: f64,
    weight: DVec3,
    reflected: DVec3,
    boundary: Boundary<f64>,
    crossing: Crossing<f64>,
    /// Direction by the law of refraction, whichever formula bends the ray; `None` if reflection is total.
    refracted: Option<DVec3>,
}

impl<L: Recorder> Tracer<'_, '_, L> {
    /// Splits a white ray into wavelengths if their refracted directions separate. The reflected part stays one white
    /// ray. Returns true if the ray was split.
    pub fn disperse(&mut self, at: &Arrival, boundary: &Dispersing) -> bool {
        let media = &self.prepared.scene.media;
        let disperses = [boundary.from, boundary.to].iter().any(|&m| media[m as usize].disperses());
        if !disperses || at.ray.nm.is_some() {
            return false;
        }
        let bands: Vec<Band> = (0..self.bands.nm.len()).map(|k| self.band(at, boundary, k)).collect();
        if !apart(&bands) {
            return false;
        }
        let reflected: DVec3 = bands.iter().map(|b| b.weight * b.reflected).sum();
        let index = |medium: u32| media[medium as usize].ior;
        let (passing, absorbed) = ((DVec3::ONE - reflected) * boundary.tint, DVec3::ONE - boundary.tint);
        self.split(
            at,
            Split {
                indices: Some((index(boundary.from), index(boundary.to))),
                reflected,
                transmitted: passing,
                absorbed: (DVec3::ONE - reflected) * absorbed,
                ..Split::OPAQUE
            },
        );
        self.reflected(at, Lobe { share: reflected, polarisation: None });
        for band in bands.iter().filter(|b| b.refracted.is_some()) {
            let passing = band.weight * (DVec3::ONE - band.reflected) * boundary.tint;
            let lobe = Lobe { share: passing, polarisation: None };
            self.refracted(at, &band.boundary, &band.crossing, lobe, boundary.beyond.clone(), Some(band.nm));
        }
        true
    }

    fn band(&self, at: &Arrival, part: &Dispersing, k: usize) -> Band {
        let nm = self.bands.nm[k];
        let index = |medium: u32| self.prepared.scene.media[medium as usize].index_at(nm);
        let boundary = Boundary::new(index(part.from), index(part.to));
        let crossing = boundary.cross(at.cos_i);
        let Lobes { reflection, .. } = at_boundary(self.prepared.fresnel, part.rule, &boundary, &crossing, None);
        let dir: Vector3<f64> = boundary.refract(at.ray.dir.into(), at.shading.into(), &crossing);
        Band {
            nm,
            weight: DVec3::from(self.bands.weight[k].map(f64::from)),
            reflected: reflection.share,
            refracted: (!crossing.total).then(|| dir.into()),
            boundary,
            crossing,
        }
    }
}

/// Returns true if only some of the bands are refracted, or if any two directions differ by more than [`SEPARATION`].
fn apart(bands: &[Band]) -> bool {
    bands.iter().any(|a| {
        bands.iter().any(|b| match (a.refracted, b.refracted) {
            (Some(a), Some(b)) => a.distance_squared(b) > SEPARATION * SEPARATION,
            (a, b) => a.is_some() != b.is_some(),
        })
    })
}
