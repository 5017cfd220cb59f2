//! Wavelengths that stand for white light, and their colours.
//!
//! White light has the spectrum of the illuminant D65 ([`super::white_at`]). The visible range is divided into bands of
//! equal width, and one wavelength of each band is traced. Its weight is its contribution to red, green and blue,
//! scaled so that all bands together are exactly white. So light whose bands arrive together is the same as undivided
//! light. The weights of one channel sum to 1 and may be below zero, since spectral colours lie outside the triangle of
//! the screen's primaries.

use super::observer::white_at;

/// First and last wavelength of white light, in nanometres. Beyond them every matching function is below 1 % of its
/// peak.
pub const VISIBLE: [f64; 2] = [385.0, 705.0];

/// Smallest number of bands. With fewer, the matching functions are sampled so unevenly that a channel's sum would be
/// off by more than a tenth before it is scaled to white.
pub const FEWEST_BANDS: u32 = 7;

/// Largest difference, in radians, at which directions of two wavelengths count as one. A white ray divides only if
/// they differ by more. The difference is measured as the length of the difference of unit vectors. The value is half a
/// pixel of a picture of 40 degrees in 1400 rows.
pub const SEPARATION: f64 = 2.5e-4;

/// Largest number of wavelength sets that the samples of a pixel take in turn.
const MOST_SETS: u32 = 64;

/// Unit of weights: weights are multiples of this, so that their sums are exact in `f32` below 4.
const QUANTUM: f64 = 1.0 / 4_194_304.0;

/// Set of wavelengths that together are white.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// The wavelengths, rising, in nanometres.
    pub nm: Vec<f64>,
    /// Contribution of each wavelength to red, green and blue. The sum over all is exactly 1 in every channel, in any
    /// order of summation.
    pub weight: Vec<[f32; 3]>,
}

impl Bands {
    /// Creates `count` bands, at least [`FEWEST_BANDS`], each with its wavelength at `offset` (0..1) of its width.
    #[must_use]
    pub fn new(count: u32, offset: f64) -> Self {
        let count = count.max(FEWEST_BANDS);
        let width = (VISIBLE[1] - VISIBLE[0]) / f64::from(count);
        let nm: Vec<f64> = (0..count).map(|k| VISIBLE[0] + (f64::from(k) + offset) * width).collect();
        let colours: Vec<[f64; 3]> = nm.iter().map(|&nm| white_at(nm)).collect();
        let mut weight = vec![[0.0; 3]; nm.len()];
        for channel in 0..3 {
            let sum: f64 = colours.iter().map(|c| c[channel]).sum();
            let mut steps: Vec<f64> = colours.iter().map(|c| (c[channel] / sum / QUANTUM).round()).collect();
            // The largest weight takes what rounding left over, since the relative change is smallest there.
            let missing = 1.0 / QUANTUM - steps.iter().sum::<f64>();
            if let Some(largest) = steps.iter_mut().max_by(|a, b| a.total_cmp(b)) {
                *largest += missing;
            }
            for (weight, steps) in weight.iter_mut().zip(steps) {
                weight[channel] = (steps * QUANTUM) as f32;
            }
        }
        Self { nm, weight }
    }
}

/// Sets of wavelengths that a pixel's samples take in turn, so that together they sample the spectrum more finely than
/// one set.
#[derive(Clone, Debug)]
pub struct Spectrum {
    sets: Vec<Bands>,
}

impl Spectrum {
    /// Creates sets of `bands` wavelengths per ray, at least [`FEWEST_BANDS`], for `samples` by `samples` rays per
    /// pixel.
    #[must_use]
    pub fn new(bands: u32, samples: u32) -> Self {
        let sets = samples.saturating_mul(samples).clamp(1, MOST_SETS);
        // Steps of about the golden ratio, so that rays that are neighbours in a row or a column get very different
        // offsets.
        let step = (1..=sets).find(|&m| f64::from(m) >= 0.618 * f64::from(sets) && coprime(m, sets)).unwrap_or(1);
        let offset = |set: u32| (f64::from(set * step % sets) + 0.5) / f64::from(sets);
        Self { sets: (0..sets).map(|set| Bands::new(bands, offset(set))).collect() }
    }

    /// The sets, at least one.
    #[must_use]
    pub fn sets(&self) -> &[Bands] {
        &self.sets
    }

    /// Index of the set for a pixel's sample with this index.
    #[must_use]
    pub fn set_of(&self, sample: u32) -> usize {
        sample as usize % self.sets.len()
    }
}

fn coprime(a: u32, b: u32) -> bool {
    if b == 0 { a == 1 } else { coprime(b, a % b) }
}
