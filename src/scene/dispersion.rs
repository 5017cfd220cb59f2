//! How the index of a medium depends on the wavelength.

use super::Medium;

/// A curve of index over wavelength. Wavelengths are those in air, in nanometres; the coefficients are for micrometres,
/// as the literature has them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Dispersion {
    /// One index for all light.
    #[default]
    None,
    /// `n = A + B / λ² + C / λ⁴` (Cauchy 1836), `A` without unit, `B` in µm², `C` in µm⁴.
    Cauchy([f64; 3]),
    /// `n² = 1 + Σ B λ² / (λ² - C)` (Sellmeier 1871), up to four pairs of `B` (without unit) and `C` (in µm²); `B = 0`
    /// leaves a term out.
    Sellmeier([[f64; 2]; 4]),
}

impl Dispersion {
    /// The index at a wavelength in nanometres; `None` without a curve. Not a number where Sellmeier's sum is below -1.
    #[must_use]
    pub fn index_at(&self, nm: f64) -> Option<f64> {
        let squared = (nm * 1e-3) * (nm * 1e-3);
        match self {
            Self::None => None,
            Self::Cauchy([a, b, c]) => Some(a + (b + c / squared) / squared),
            Self::Sellmeier(terms) => {
                let sum: f64 = terms.iter().map(|[b, c]| b * squared / (squared - c)).sum();
                Some((1.0 + sum).sqrt())
            }
        }
    }
}

impl Medium {
    /// The index at a wavelength in nanometres: [`Medium::ior`] where the medium has no curve.
    #[must_use]
    pub fn index_at(&self, nm: f64) -> f64 {
        self.dispersion.index_at(nm).unwrap_or(self.ior)
    }

    /// Whether light of different wavelengths is bent differently.
    #[must_use]
    pub fn disperses(&self) -> bool {
        self.dispersion != Dispersion::None
    }
}
