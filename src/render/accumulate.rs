//! Fixed-point sums of each pixel's contributions, which do not depend on the order of addition.
//!
//! A floating-point sum depends on its order, and rays reach a pixel in an order that depends on their grouping. A
//! fixed-point sum does not: each contribution is rounded once, towards zero, to a multiple of 2^-64.

use super::limit::Limit;
use super::queue::Rgb8;
use crate::math::Real;
use crate::simd::set_lanes;

/// Binary digits after the point.
const FRACTION_BITS: i32 = 64;

/// Magnitude, 2^62, at which contributions are clamped and counted. 2^62 clamped contributions still fit the sum.
const LIMIT: f32 = 4.611_686e18;

/// Sums of one pixel, in units of 2^-64.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSum {
    radiance: [i128; 3],
    /// Weight of rays ended by the cut-off.
    cut: [i128; 3],
}

/// Mean over a pixel's camera rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelMean {
    /// Radiance per channel.
    pub radiance: [f32; 3],
    /// Weight of rays that ended at a limit, per channel.
    pub truncated: [f32; 3],
    /// Limit that ended most of the truncated weight.
    pub limit: Option<Limit>,
}

/// Sums of all pixels of a tile.
#[derive(Debug, Default)]
pub struct Accumulator {
    pixels: Vec<PixelSum>,
    /// Weight ended by each limit after [`Limit::Cutoff`]. Kept apart, and empty until needed, because most tiles have
    /// none.
    ended: Vec<[[i128; 3]; Limit::ALL.len() - 1]>,
    /// Number of contributions left out because a channel was NaN or infinite.
    pub non_finite: u64,
    /// Number of contributions clamped to [`LIMIT`].
    pub clamped: u64,
    /// Union of the lanes, over all packets, in which light from a lamp was added. 0 if no lamp lit the tile.
    pub lit: u8,
}

impl Accumulator {
    /// Resets the sums to `n` pixels of zero.
    pub fn reset(&mut self, n: usize) {
        self.pixels.clear();
        self.pixels.resize(n, PixelSum::default());
        self.ended.clear();
    }

    /// Adds `radiance` to the pixels of the lanes in `lanes`.
    pub fn add_radiance8(&mut self, lanes: u8, pixel: &[u32; 8], radiance: &Rgb8) {
        self.add8(lanes, pixel, radiance, |sums, i| &mut sums.pixels[i].radiance);
    }

    /// Adds light that a surface reflects from a lamp, and records in [`Self::lit`] that a lamp contributed.
    pub fn add_light8(&mut self, lanes: u8, pixel: &[u32; 8], radiance: &Rgb8) {
        self.lit |= self.add8(lanes, pixel, radiance, |sums, i| &mut sums.pixels[i].radiance);
    }

    /// Adds the lamp light of many packets, as [`Self::add_light8`] does for one.
    pub fn add_light<'a>(&mut self, packets: impl Iterator<Item = (u8, &'a [u32; 8], &'a Rgb8)>) {
        for (lanes, pixel, radiance) in packets {
            self.lit |= self.add8(lanes, pixel, radiance, |sums, i| &mut sums.pixels[i].radiance);
        }
    }

    /// Adds `weight`, of rays ended by the cut-off, to the pixels of the lanes in `lanes`.
    pub fn add_cut8(&mut self, lanes: u8, pixel: &[u32; 8], weight: &Rgb8) {
        self.add8(lanes, pixel, weight, |sums, i| &mut sums.pixels[i].cut);
    }

    /// Adds `weight`, of rays ended by `limit`, to the pixels of the lanes in `lanes`.
    #[cold]
    pub fn add_ended8(&mut self, limit: Limit, lanes: u8, pixel: &[u32; 8], weight: &Rgb8) {
        if lanes == 0 {
            return;
        }
        let Some(place) = (limit as usize).checked_sub(1) else { return self.add_cut8(lanes, pixel, weight) };
        self.ended.resize(self.pixels.len(), Default::default());
        self.add8(lanes, pixel, weight, |sums, i| &mut sums.ended[i][place]);
    }

    /// Adds `value` to the sums chosen by `place`. Returns the lanes whose value is not zero.
    // Inlined into the functions above, which are not inlined themselves, so that a loop over packets makes no calls.
    #[inline(always)]
    fn add8(
        &mut self,
        lanes: u8,
        pixel: &[u32; 8],
        value: &Rgb8,
        place: impl Fn(&mut Self, usize) -> &mut [i128; 3],
    ) -> u8 {
        // Zero adds nothing, and many contributions are zero. NaN compares unequal to zero and is counted below.
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

    /// Returns the radiance and the truncated weight of pixel `i`, in units of 2^-64.
    #[must_use]
    pub fn sums(&self, i: usize) -> ([i128; 3], [i128; 3]) {
        let mut truncated = self.pixels[i].cut;
        for ended in self.ended.get(i).into_iter().flatten() {
            truncated.iter_mut().zip(ended).for_each(|(sum, weight)| *sum += weight);
        }
        (self.pixels[i].radiance, truncated)
    }

    /// Returns the sums of pixel `i` divided by `samples`.
    #[must_use]
    pub fn mean(&self, i: usize, samples: u32) -> PixelMean {
        let scale = 2.0_f64.powi(-FRACTION_BITS) / f64::from(samples);
        // Most pixels have no truncated weight, and 128 bits take long to convert.
        let wide = |sums: [i128; 3]| if sums == [0; 3] { [0.0; 3] } else { sums.map(|s| s as f64) };
        let to_float = |sums| wide(sums).map(|s| (s * scale) as f32);
        let (radiance, truncated) = self.sums(i);
        let mut by_limit = [self.pixels[i].cut; Limit::ALL.len()];
        by_limit[1..].copy_from_slice(&self.ended.get(i).copied().unwrap_or_default());
        let limit = Limit::heaviest(by_limit.map(wide));
        PixelMean { radiance: to_float(radiance), truncated: to_float(truncated), limit }
    }
}

/// Returns `x * 2^64`, rounded towards zero, for finite `|x| <= 2^62`.
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
