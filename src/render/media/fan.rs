//! Fan of wavelengths that a white ray divides into at a boundary of dispersive media.

use super::stack::Stack;
use super::{MediaTable, StackId};
use crate::optics::Boundary;
use crate::scene::Rgb;

/// Index of a fan of wavelengths within one [`MediaTable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FanId(pub(super) u32);

/// Boundaries for all wavelengths of the current set.
#[derive(Clone, Debug, Default)]
pub struct Fan {
    /// Bands by rising wavelength.
    pub bands: Vec<Band>,
    /// Indices of the bands with the smallest and the largest ratio of refractive indices: those refracted least and
    /// most.
    pub outermost: [usize; 2],
}

/// One wavelength at a boundary.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    /// Boundary for this wavelength.
    pub boundary: Boundary<f32>,
    /// Stack of a ray of this wavelength that crosses.
    pub beyond: StackId,
}

/// Boundary that may separate wavelengths: the media on both sides, and the bodies that a ray behind it has entered.
#[derive(Clone, Debug)]
pub(super) struct DispersiveBoundary {
    pub from: u32,
    pub to: u32,
    pub entered: Vec<u32>,
}

impl MediaTable<'_> {
    /// Returns the number of wavelengths that a white ray divides into.
    #[must_use]
    pub fn bands(&self) -> usize {
        self.spectrum.as_ref().map_or(0, |s| s.sets()[self.set].nm.len())
    }

    /// Returns the colour that the `k`th wavelength of the current set contributes to white, per channel.
    #[must_use]
    pub fn band_weight(&self, k: usize) -> Rgb {
        self.spectrum.as_ref().map_or(Rgb::ZERO, |s| s.sets()[self.set].weight[k].into())
    }

    /// Computes a fan for the current set, so that [`MediaTable::known_fan`] can return it.
    #[inline]
    pub fn learn_fan(&mut self, id: FanId) {
        let (fan, set) = (id.0 as usize, self.set);
        if self.fans[fan][set].bands.is_empty() {
            self.fans[fan][set] = self.spread(fan);
        }
    }

    /// Returns a fan for the current set; [`MediaTable::learn_fan`] must have computed it.
    #[inline]
    #[must_use]
    pub fn known_fan(&self, id: FanId) -> &Fan {
        &self.fans[id.0 as usize][self.set]
    }

    /// Computes the boundary of each wavelength of the current set, and the extreme ones.
    fn spread(&mut self, fan: usize) -> Fan {
        let DispersiveBoundary { from, to, entered } = self.fan_boundaries[fan].clone();
        let count = self.bands() as u32;
        let first = 1 + self.set as u32 * count;
        let (mut bands, mut ratios) = (Vec::new(), Vec::new());
        for wave in first..first + count {
            let (n1, n2) = (self.index(from, wave), self.index(to, wave));
            let beyond = self.beyond(StackId::default(), Stack { entered: entered.clone(), wave });
            bands.push(Band { boundary: Boundary::new(n1, n2), beyond });
            ratios.push(n1 / n2);
        }
        let by_ratio = |a: &usize, b: &usize| ratios[*a].total_cmp(&ratios[*b]);
        let [least, most] = [(0..bands.len()).min_by(by_ratio), (0..bands.len()).max_by(by_ratio)];
        Fan { bands, outermost: [least.unwrap_or(0), most.unwrap_or(0)] }
    }
}
