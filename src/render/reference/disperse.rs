//! White light at the boundary of a medium that disperses it.

use glam::DVec3;

use super::media::MediumStack;
use super::split::{Way, Ways, at_boundary};
use super::trace::{Arrival, Tracer};
use crate::math::Vector3;
use crate::optics::{Boundary, Crossing, SEPARATION};
use crate::render::record::{Recorder, Split};
use crate::scene::FresnelRule;

/// The boundary between two media where wavelengths part.
#[derive(Clone, Debug)]
pub(super) struct Dispersing {
    pub from: u32,
    pub to: u32,
    /// The media behind it.
    pub beyond: MediumStack,
    pub rule: FresnelRule,
    pub tint: DVec3,
}

/// What one wavelength does there.
struct Band {
    nm: f64,
    weight: DVec3,
    reflected: DVec3,
    boundary: Boundary<f64>,
    crossing: Crossing<f64>,
    /// By the law of refraction, whichever formula bends it; none where reflection is total.
    refracted: Option<DVec3>,
}

impl<L: Recorder> Tracer<'_, '_, L> {
    /// Sends the wavelengths of a white ray their ways, where those are apart; what they reflect stays together.
    /// Says whether they were.
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
        self.reflected(at, Way { share: reflected, polarisation: None });
        for band in bands.iter().filter(|b| b.refracted.is_some()) {
            let passing = band.weight * (DVec3::ONE - band.reflected) * boundary.tint;
            let way = Way { share: passing, polarisation: None };
            self.refracted(at, &band.boundary, &band.crossing, way, boundary.beyond.clone(), Some(band.nm));
        }
        true
    }

    fn band(&self, at: &Arrival, part: &Dispersing, k: usize) -> Band {
        let nm = self.bands.nm[k];
        let index = |medium: u32| self.prepared.scene.media[medium as usize].index_at(nm);
        let boundary = Boundary::new(index(part.from), index(part.to));
        let crossing = boundary.cross(at.cos_i);
        let Ways { back, .. } = at_boundary(self.prepared.fresnel, part.rule, &boundary, &crossing, None);
        let dir: Vector3<f64> = boundary.refract(at.ray.dir.into(), at.shading.into(), &crossing);
        Band {
            nm,
            weight: DVec3::from(self.bands.weight[k].map(f64::from)),
            reflected: back.share,
            refracted: (!crossing.total).then(|| dir.into()),
            boundary,
            crossing,
        }
    }
}

/// Whether some of the bands go on and some do not, or any two in directions that differ.
fn apart(bands: &[Band]) -> bool {
    bands.iter().any(|a| {
        bands.iter().any(|b| match (a.refracted, b.refracted) {
            (Some(a), Some(b)) => a.distance_squared(b) > SEPARATION * SEPARATION,
            (a, b) => a.is_some() != b.is_some(),
        })
    })
}
