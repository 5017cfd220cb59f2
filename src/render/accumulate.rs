//! Summing a pixel's contributions so that their order does not matter.
//!
//! Floating-point sums depend on their order, and the order in which rays reach a pixel depends on how they were
//! grouped. Fixed-point sums do not: each contribution is rounded once, towards zero, to a multiple of 2^-64.

use super::limit::Limit;
use super::queue::Rgb8;
use crate::math::Real;
use crate::simd::set_lanes;

/// Binary digits after the point.
const FRACTION_BITS: i32 = 64;

/// Contributions at or beyond this magnitude are clamped (and counted): 2^62, so that 2^62 of them still fit.
const LIMIT: f32 = 4.611_686e18;

/// The sums of one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSum {
    radiance: [i128; 3],
    /// Weight that the cut-off ended.
    cut: [i128; 3],
}

/// The mean of a pixel's camera rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelMean {
    /// Radiance per channel.
    pub radiance: [f32; 3],
    /// Weight of rays that ended at a limit, per channel.
    pub truncated: [f32; 3],
    /// The limit that ended most of it.
    pub limit: Option<Limit>,
}

/// The sums of a tile's pixels.
#[derive(Debug, Default)]
pub struct Accumulator {
    pixels: Vec<PixelSum>,
    /// Weight by the limits after [`Limit::Cutoff`], apart because most tiles have none: empty until there is some.
    ended: Vec<[[i128; 3]; Limit::ALL.len() - 1]>,
    /// Contributions left out because a channel was NaN or infinite.
    pub non_finite: u64,
    /// Contributions clamped to [`LIMIT`].
    pub clamped: u64,
    /// Bits of the lanes in which light from a lamp was added, of all packets together; 0 where none was.
    pub lit: u8,
}

impl Accumulator {
    /// Clears the sums of `n` pixels.
    pub fn reset(&mut self, n: usize) {
        self.pixels.clear();
        self.pixels.resize(n, PixelSum::default());
        self.ended.clear();
    }

    /// Adds radiance to the pixels of the lanes in `lanes`.
    pub fn add_radiance8(&mut self, lanes: u8, pixel: &[u32; 8], radiance: &Rgb8) {
        self.add8(lanes, pixel, radiance, |sums, i| &mut sums.pixels[i].radiance);
    }

    /// Adds what a surface sends of the light of a lamp, as [`Self::add_radiance8`] does.
    pub fn add_light8(&mut self, lanes: u8, pixel: &[u32; 8], radiance: &Rgb8) {
        self.lit |= self.add8(lanes, pixel, radiance, |sums, i| &mut sums.pixels[i].radiance);
    }

    /// Adds the light of many packets, as [`Self::add_light8`] does of one.
    pub fn add_light<'a>(&mut self, packets: impl Iterator<Item = (u8, &'a [u32; 8], &'a Rgb8)>) {
        for (lanes, pixel, radiance) in packets {
            self.lit |= self.add8(lanes, pixel, radiance, |sums, i| &mut sums.pixels[i].radiance);
        }
    }

    /// Adds the weight of rays that the cut-off ended to the pixels of the lanes in `lanes`.
    pub fn add_cut8(&mut self, lanes: u8, pixel: &[u32; 8], weight: &Rgb8) {
        self.add8(lanes, pixel, weight, |sums, i| &mut sums.pixels[i].cut);
    }

    /// Adds the weight of rays that `limit` ended to the pixels of the lanes in `lanes`.
    #[cold]
    pub fn add_ended8(&mut self, limit: Limit, lanes: u8, pixel: &[u32; 8], weight: &Rgb8) {
        if lanes == 0 {
            return;
        }
        let Some(place) = (limit as usize).checked_sub(1) else { return self.add_cut8(lanes, pixel, weight) };
        self.ended.resize(self.pixels.len(), Default::default());
        self.add8(lanes, pixel, weight, |sums, i| &mut sums.ended[i][place]);
    }

    /// Returns the lanes whose value is not zero.
    // In line in those above, and these nowhere: a loop over packets is then not one over calls.
    #[inline(always)]
    fn add8(
        &mut self,
        lanes: u8,
        pixel: &[u32; 8],
        value: &Rgb8,
        place: impl Fn(&mut Self, usize) -> &mut [i128; 3],
    ) -> u8 {
        // Zero adds nothing, and much of what comes here is zero; NaN is not zero.
        let zero = (value.x.eq(Real::zero()) & value.y.eq(Real::zero()) & value.z.eq(Real::zero())).bits();
        let adding = lanes & !zero;
        for lane in set_lanes(adding) {
            let rgb = [value.x.lane(lane), value.y.lane(lane), value.z.lane(lane)];
            if !rgb.iter().all(|c| c.is_finite()) {
                self.non_finite += 1;
                continue;
            }
            if rgb.iter().any(|c| c.abs() >= LIMIT) {
                self.clamped += 1;
            }
            let sum = place(self, pixel[lane] as usize);
            for (s, c) in sum.iter_mut().zip(rgb) {
                *s += to_fixed(c.clamp(-LIMIT, LIMIT));
            }
        }
        adding
    }

    /// The sums of pixel `i`: radiance and truncated weight, in units of 2^-64.
    #[must_use]
    pub fn sums(&self, i: usize) -> ([i128; 3], [i128; 3]) {
        let mut truncated = self.pixels[i].cut;
        for ended in self.ended.get(i).into_iter().flatten() {
            truncated.iter_mut().zip(ended).for_each(|(sum, weight)| *sum += weight);
        }
        (self.pixels[i].radiance, truncated)
    }

    /// The sums of pixel `i` divided by `samples`.
    #[must_use]
    pub fn mean(&self, i: usize, samples: u32) -> PixelMean {
        let scale = 2.0_f64.powi(-FRACTION_BITS) / f64::from(samples);
        let to_float = |sums: [i128; 3]| sums.map(|s| (s as f64 * scale) as f32);
        let (radiance, truncated) = self.sums(i);
        let mut by_limit = [self.pixels[i].cut; Limit::ALL.len()];
        by_limit[1..].copy_from_slice(&self.ended.get(i).copied().unwrap_or_default());
        let limit = Limit::heaviest(by_limit.map(|sums| sums.map(|s| s as f64)));
        PixelMean { radiance: to_float(radiance), truncated: to_float(truncated), limit }
    }
}

/// `x * 2^64` towards zero, for finite `|x| <= 2^62`.
#[inline]
fn to_fixed(x: f32) -> i128 {
    let bits = x.to_bits();
    let exponent = (bits >> 23 & 0xff) as i32;
    let mantissa = i128::from(bits & 0x7f_ffff | u32::from(exponent != 0) << 23);
    // x = mantissa * 2^(max(exponent, 1) - 150).
    let shift = exponent.max(1) - 150 + FRACTION_BITS;
    let magnitude = if shift >= 0 { mantissa << shift } else { mantissa >> (-shift).min(127) };
    if x < 0.0 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{F32x8, Vec3x8};

    #[test]
    fn fixed_point_holds_every_number_a_picture_has_exactly() {
        for x in [0.0, 1.0, -1.0, 0.1, 1e-9, 12345.678, 4e18, -3.5, f32::MIN_POSITIVE, 1e-45] {
            let back = to_fixed(x) as f64 * 2.0_f64.powi(-64);
            assert!((back - f64::from(x)).abs() <= 2.0_f64.powi(-64), "{x} came back as {back}");
        }
        assert_eq!(to_fixed(1.0), 1 << 64);
    }

    /// Case AC-03 of the catalogue.
    #[test]
    fn a_sum_is_the_same_in_any_order() {
        let values: Vec<f32> = (0..1000).map(|i| ((i * 7919) % 1000) as f32 * 1e-3 * 10f32.powi(i % 9 - 4)).collect();
        let sum = |order: &mut dyn Iterator<Item = usize>| {
            let mut a = Accumulator::default();
            a.reset(1);
            for i in order {
                a.add_radiance8(1, &[0; 8], &Vec3x8::all(F32x8::from(values[i])));
            }
            a.mean(0, 1).radiance
        };
        let forward = sum(&mut (0..1000));
        assert_eq!(forward, sum(&mut (0..1000).rev()));
        assert_eq!(forward, sum(&mut (0..1000).map(|i| i * 617 % 1000)));
    }

    /// Case AC-01 of the catalogue.
    #[test]
    fn what_is_not_finite_is_counted_and_left_out() {
        let mut a = Accumulator::default();
        a.reset(1);
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.25, 1e30] {
            a.add_radiance8(1, &[0; 8], &Vec3x8::all(F32x8::from(x)));
        }
        assert_eq!(a.non_finite, 3);
        assert_eq!(a.clamped, 1);
        assert!(a.mean(0, 1).radiance[0] >= 4.6e18);
    }
}
