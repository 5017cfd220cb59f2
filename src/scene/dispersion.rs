//! Dispersion: the refractive index of a medium as a function of wavelength.

use super::material::Medium;

/// Curve of the index over the wavelength. Wavelengths are in air and in nanometres; the coefficients are for
/// micrometres, as in the literature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Dispersion {
    /// One index for all wavelengths.
    #[default]
    None,
    /// `n = A + B / λ² + C / λ⁴` (Cauchy 1836), `A` without unit, `B` in µm², `C` in µm⁴.
    Cauchy([f64; 3]),
    /// `n² = 1 + Σ B λ² / (λ² - C)` (Sellmeier 1871), up to four pairs of `B` (without unit) and `C` (in µm²); `B = 0`
    /// leaves a term out.
    Sellmeier([[f64; 2]; 4]),
}

impl Dispersion {
    /// Returns the index at a wavelength in nanometres, or `None` without a curve. NaN where Sellmeier's sum is below
    /// -1.
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
    /// Returns the index at a wavelength in nanometres; [`Medium::ior`] if the medium has no curve.
    #[must_use]
    pub fn index_at(&self, nm: f64) -> f64 {
        self.dispersion.index_at(nm).unwrap_or(self.ior)
    }

    /// Returns true if the medium has a dispersion curve.
    #[must_use]
    pub fn disperses(&self) -> bool {
        self.dispersion != Dispersion::None
    }
}
