//! Between linear radiance and the codes of a picture file: the transfer function of sRGB (IEC 61966-2-1), rounding,
//! and a count of what the codes cannot hold.

/// Code value in 0..=1 of linear light `x` in 0..=1: the standard's two pieces, not a power of 2.2.
#[must_use]
pub fn srgb_from_linear(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// Linear light in 0..=1 of code value `x` in 0..=1.
#[must_use]
pub fn linear_from_srgb(x: f64) -> f64 {
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Samples (one channel of one pixel each) that a file format could not hold as they were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Clipped {
    /// NaN or infinite. Where the format holds neither, NaN and minus infinity became 0, infinity the largest code.
    pub non_finite: u64,
    /// Below zero; became 0.
    pub below: u64,
    /// Above the largest value the format holds; became that value.
    pub above: u64,
}

impl Clipped {
    /// Whether every sample fitted.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// `x` brought into `0..=max`, and counted where it was not there.
    pub(super) fn fit(&mut self, x: f32, max: f32) -> f32 {
        if !x.is_finite() {
            self.non_finite += 1;
            if x > 0.0 { max } else { 0.0 }
        } else if x < 0.0 {
            self.below += 1;
            0.0
        } else if x > max {
            self.above += 1;
            max
        } else {
            x
        }
    }

    /// Counts `x` if it is not finite, for formats that hold everything else.
    pub(super) fn note(&mut self, x: f32) {
        self.non_finite += u64::from(!x.is_finite());
    }

    /// The nearest of the codes `0..=max` for linear light `x`.
    pub(super) fn code(&mut self, x: f32, max: u16) -> u16 {
        let x = f64::from(self.fit(x, 1.0));
        (srgb_from_linear(x) * f64::from(max)).round() as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transfer_function_has_its_known_values() {
        assert_eq!(srgb_from_linear(0.0), 0.0);
        assert!((srgb_from_linear(1.0) - 1.0).abs() < 1e-15);
        // Mid grey: sRGB 0.5 is linear 0.21404.
        assert!((linear_from_srgb(0.5) - 0.214_041_140_482_232_5).abs() < 1e-15);
        assert!((srgb_from_linear(0.214_041_140_482_232_5) - 0.5).abs() < 1e-15);
        // Both pieces meet to the standard's own precision.
        assert!((srgb_from_linear(0.003_130_8) - 0.040_45).abs() < 1e-6);
    }

    #[test]
    fn every_code_survives_decoding_and_encoding() {
        for max in [255_u16, 65535] {
            let mut clipped = Clipped::default();
            for code in 0..=max {
                let linear = linear_from_srgb(f64::from(code) / f64::from(max)) as f32;
                assert_eq!(clipped.code(linear, max), code);
            }
            assert!(clipped.is_none());
        }
    }

    /// Cases AC-04, AC-05 of the catalogue.
    #[test]
    fn what_no_code_can_hold_is_counted_and_never_wraps() {
        let mut clipped = Clipped::default();
        let codes = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, -0.0, 1.0].map(|x| clipped.code(x, 255));
        assert_eq!(codes, [0, 255, 0, 0, 255, 0, 255]);
        assert_eq!(clipped, Clipped { non_finite: 3, below: 1, above: 1 });
    }
}
