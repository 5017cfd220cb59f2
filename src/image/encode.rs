//! Conversion between linear radiance and the codes of picture files: the sRGB transfer function (IEC 61966-2-1),
//! rounding, and counts of clipped samples.

/// Returns the sRGB code value in 0..=1 of linear light `x` in 0..=1, by the standard's two pieces.
#[must_use]
pub fn srgb_from_linear(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the linear light in 0..=1 of the sRGB code value `x` in 0..=1.
#[must_use]
pub fn linear_from_srgb(x: f64) -> f64 {
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Numbers of samples (one channel of one pixel each) that a file format could not represent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Clipped {
    /// NaN or infinite samples. In formats without such values, NaN and minus infinity became 0, and infinity the
    /// largest code.
    pub non_finite: u64,
    /// Samples below zero, which became 0.
    pub below: u64,
    /// Samples above the largest value of the format, which became that value.
    pub above: u64,
}

impl Clipped {
    /// Returns true if every sample could be represented.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Clamps `x` to `0..=max`, and counts it if it was outside.
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

    /// Counts `x` if it is not finite, for formats that represent all other values.
    pub(super) fn note(&mut self, x: f32) {
        self.non_finite += u64::from(!x.is_finite());
    }

    /// Returns the nearest code in `0..=max` for linear light `x`.
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
        // The two pieces meet within the standard's own precision.
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
