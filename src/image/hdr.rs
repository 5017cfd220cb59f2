//! Radiance HDR files: three 8-bit mantissas with a shared exponent (Ward 1991).

use super::encode::Clipped;
use super::film::Film;
use super::format::{Encoded, Format, cannot_hold};
use crate::Result;

/// Largest value: mantissa 255 of 256 under the largest exponent whose power `f32` represents.
const MAX: f32 = 255.0 / 256.0 * 1.701_411_8e38;

/// Encodes a film, rounding to nearest. `image`'s encoder truncates, which is exact for the output of [`nearest`].
pub(super) fn encode(film: &Film) -> Result<Encoded> {
    let mut clipped = Clipped::default();
    let pixels: Vec<_> = film.pixels.iter().map(|p| ::image::Rgb(nearest(p.map(|x| clipped.fit(x, MAX))))).collect();
    let mut bytes = Vec::new();
    ::image::codecs::hdr::HdrEncoder::new(&mut bytes)
        .encode(&pixels, film.width as usize, film.height as usize)
        .map_err(|e| cannot_hold(film, Format::Hdr, e))?;
    Ok(Encoded { bytes, clipped })
}

/// Returns the nearest colour with three 8-bit mantissas and a shared exponent; black below 2^-120.
fn nearest(colour: [f32; 3]) -> [f32; 3] {
    let max = colour[0].max(colour[1]).max(colour[2]);
    if max < 2.0_f32.powi(-120) {
        return [0.0; 3];
    }
    // `max` lies in [2^e, 2^(e+1)), which 128 steps of 2^(e-7) divide.
    let exponent = (max.to_bits() >> 23) as i32 - 127;
    let round = |step: f32| colour.map(|x| (x / step).round_ties_even() * step);
    let step = 2.0_f32.powi(exponent - 7);
    if (max / step).round_ties_even() < 256.0 { round(step) } else { round(2.0 * step) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_format_can_hold_is_left_as_it_is() {
        for colour in [[1.0, 0.5, 0.25], [0.0, 3.0, 0.0], [255.0, 1.0, 128.0], [2.0_f32.powi(-100), 0.0, 0.0]] {
            assert_eq!(nearest(colour), colour);
        }
    }

    #[test]
    fn rounding_is_to_nearest_and_may_carry_into_the_exponent() {
        assert_eq!(nearest([0.999, 0.0, 0.0]), [1.0, 0.0, 0.0]);
        assert_eq!(nearest([1.0, 0.002, 0.006]), [1.0, 0.0, 1.0 / 128.0]);
        assert_eq!(nearest([f32::MIN_POSITIVE, 0.0, 0.0]), [0.0; 3]);
        assert!(nearest([MAX; 3]).iter().all(|x| x.is_finite()));
    }
}
