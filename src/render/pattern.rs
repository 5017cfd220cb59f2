//! Sample points on area lamps.
//!
//! The samples at a shaded point depend on its pixel, the camera ray's index within the pixel, the depth, and the lamp.
//! They do not depend on how rays are grouped, and both renderers use the same ones. Shaded points that agree in all
//! four share their samples; this only loses a little of the averaging between them.
//!
//! The points are Sobol's first two dimensions with Owen scrambling (Owen 1995). The scrambling uses the hash of Laine
//! & Karras 2011 with the constants of Vegdahl 2021, as in Burley 2020 ("Practical hash-based Owen scrambling", JCGT
//! 9(4)). Any aligned power of two of the points is a (0, m, 2)-net in base 2: every elementary box of that share of
//! the square's area holds exactly one. Sample counts that are powers of two make best use of that.

use crate::scene::{LampSampling, Pattern};
use crate::simd::F32x8;

/// One camera ray: its pixel and its index within the pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilmRay {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Index of the ray within the pixel, from 0.
    pub sample: u32,
}

/// Scrambling key for the samples of one shaded point and lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scramble(u32);

/// Generator of lamp samples for all shaded points.
#[derive(Clone, Debug)]
pub struct LampPoints {
    sampling: LampSampling,
    /// Centres of the cells of a grid, ordered so that the first four lie in its four quarters. Empty for Sobol points.
    cells: Vec<[f32; 2]>,
}

impl LampPoints {
    /// Creates the generator for these settings.
    #[must_use]
    pub fn new(sampling: &LampSampling) -> Self {
        let cells = if sampling.pattern == Pattern::Grid { grid(sampling.count.isqrt()) } else { Vec::new() };
        Self { sampling: *sampling, cells }
    }

    /// Returns the number of samples per shaded point, at least 1.
    #[must_use]
    pub fn count(&self) -> u32 {
        if self.cells.is_empty() { self.sampling.count.max(1) } else { self.cells.len() as u32 }
    }

    /// Returns the scrambling key for one shaded point. `depth` is the depth of the ray that hit it, and `lamp` the
    /// index of the lamp.
    #[inline]
    #[must_use]
    pub fn scramble(&self, pixel: [u32; 2], depth: u32, lamp: u32) -> Scramble {
        let mut key = mix(self.sampling.seed ^ 0x9e37_79b9);
        for part in [pixel[0], pixel[1], depth, lamp] {
            key = mix(key ^ part.wrapping_mul(0x85eb_ca6b).wrapping_add(key << 6));
        }
        Scramble(key)
    }

    /// Returns the `i`th sample, in the unit square, for the `sample`th camera ray of a pixel. Coordinates are
    /// multiples of 2^-24 below 1.
    #[inline]
    #[must_use]
    pub fn point(&self, by: Scramble, sample: u32, i: u32) -> [f32; 2] {
        if let Some(&cell) = self.cells.get(i as usize) {
            return cell;
        }
        self.number(sample, i).scrambled(by).map(fraction)
    }

    /// Returns the `i`th sample for eight shaded points, as [`Self::point`] does for one.
    #[inline(always)]
    #[must_use]
    pub fn points8(&self, by: &[Scramble; 8], sample: u32, i: u32) -> [F32x8; 2] {
        if let Some(&cell) = self.cells.get(i as usize) {
            return cell.map(F32x8::from);
        }
        let number = self.number(sample, i);
        let all = by.map(|by| number.scrambled(by));
        [0, 1].map(|dimension| F32x8::from_fn(|k| fraction(all[k][dimension])))
    }

    /// Returns the `i`th sample in the unit cube for the `sample`th camera ray of a pixel: the first two coordinates of
    /// the Sobol point, and a third one to choose among sources. There is no grid in three dimensions, so these are
    /// Sobol points under either pattern.
    #[inline]
    #[must_use]
    pub fn in_cube(&self, by: Scramble, sample: u32, i: u32) -> [f32; 3] {
        let [point] = self.in_cubes([by], sample, i);
        point
    }

    /// Returns the `i`th sample for several shaded points, as [`Self::in_cube`] does for one.
    #[inline(always)]
    #[must_use]
    pub fn in_cubes<const N: usize>(&self, by: [Scramble; N], sample: u32, i: u32) -> [[f32; 3]; N] {
        let number = self.number(sample, i);
        // The first dimension holds the index itself.
        let third = third_dimension(number.reversed[0]).reverse_bits();
        by.map(|by| {
            let [x, y] = number.scrambled(by);
            [x, y, scrambled(third, mix(by.0 ^ 0x02e5_be93))].map(fraction)
        })
    }

    #[inline(always)]
    fn number(&self, sample: u32, i: u32) -> Sobol {
        let number = sample.wrapping_mul(self.count()).wrapping_add(i);
        // The first dimension is the index with its bits reversed.
        Sobol { reversed: [number, second_dimension(number).reverse_bits()] }
    }
}

/// Point of Sobol's sequence, with the bits of both coordinates reversed.
#[derive(Clone, Copy)]
struct Sobol {
    reversed: [u32; 2],
}

impl Sobol {
    #[inline(always)]
    const fn scrambled(self, by: Scramble) -> [u32; 2] {
        [scrambled(self.reversed[0], by.0), scrambled(self.reversed[1], mix(by.0 ^ 0x68bc_21eb))]
    }
}

#[inline(always)]
fn fraction(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Returns the centres of a square grid's cells, those in the middles of its quarters first.
fn grid(side: u32) -> Vec<[f32; 2]> {
    let middle = |k: u32| ((f64::from(k) + 0.5) / f64::from(side)) as f32;
    let mut cells: Vec<[u32; 2]> = (0..side).flat_map(|y| (0..side).map(move |x| [x, y])).collect();
    let (low, high) = (side / 4, side - 1 - side / 4);
    for (front, cell) in [[low, low], [high, high], [high, low], [low, high]].into_iter().enumerate() {
        // In a grid of one or of four cells the quarters are already in place.
        if let Some(at) = cells.iter().skip(front).position(|&c| c == cell) {
            cells.swap(front, front + at);
        }
    }
    cells.into_iter().map(|cell| cell.map(middle)).collect()
}

/// Hash from Burley's appendix ("lowbias32" by Wellons).
#[inline(always)]
const fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

/// Scrambles a number of reversed bits after Owen, and reverses them back: each bit is flipped by a hash of the higher
/// bits of the result.
#[inline(always)]
const fn scrambled(mut reversed: u32, seed: u32) -> u32 {
    reversed ^= reversed.wrapping_mul(0x3d20_adea);
    reversed = reversed.wrapping_add(seed);
    reversed = reversed.wrapping_mul((seed >> 16) | 1);
    reversed ^= reversed.wrapping_mul(0x0552_6c56);
    reversed ^= reversed.wrapping_mul(0x53a2_2864);
    reversed.reverse_bits()
}

/// Returns Sobol's second dimension. The direction numbers of the polynomial x + 1 are Pascal's triangle modulo 2.
#[inline(always)]
const fn second_dimension(number: u32) -> u32 {
    let (mut x, mut direction, mut left) = (0, 1 << 31, number);
    while left != 0 {
        if left & 1 != 0 {
            x ^= direction;
        }
        direction ^= direction >> 1;
        left >>= 1;
    }
    x
}

/// Returns Sobol's third dimension, of the polynomial x^2 + x + 1 with the initial numbers 1 and 3.
#[inline(always)]
const fn third_dimension(number: u32) -> u32 {
    let (mut x, mut k, mut left) = (0, 0, number);
    while left != 0 {
        if left & 1 != 0 {
            x ^= THIRD_DIRECTIONS[k];
        }
        k += 1;
        left >>= 1;
    }
    x
}

/// Direction numbers of the third dimension, with the highest bit first.
const THIRD_DIRECTIONS: [u32; 32] = {
    // m[k] = 2 m[k - 1] ^ 4 m[k - 2] ^ m[k - 2] (Bratley & Fox 1988), and its direction is m[k] 2^(31 - k).
    let mut m = [0_u64; 32];
    (m[0], m[1]) = (1, 3);
    let mut directions = [0; 32];
    let mut k = 0;
    while k < 32 {
        if k > 1 {
            m[k] = (2 * m[k - 1]) ^ (4 * m[k - 2]) ^ m[k - 2];
        }
        directions[k] = (m[k] << (31 - k)) as u32;
        k += 1;
    }
    directions
};

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: u32, pattern: Pattern, seed: u32) -> LampPoints {
        LampPoints::new(&LampSampling { count, pattern, seed, probe: true })
    }

    /// Number of points in each box when the sides are cut into `2^a` and `2^b` parts.
    fn boxes(points: &[[f32; 2]], a: u32, b: u32) -> Vec<u32> {
        let mut found = vec![0; 1 << (a + b)];
        for [x, y] in points {
            let cell = |x: f32, bits: u32| (x * (1 << bits) as f32) as usize;
            found[(cell(*y, b) << a) + cell(*x, a)] += 1;
        }
        found
    }

    #[test]
    fn every_aligned_power_of_two_of_sobol_points_has_one_in_each_box_however_the_square_is_halved() {
        for seed in 0..20 {
            let lamp = points(64, Pattern::Sobol, seed);
            for (depth, sample) in [(0, 0), (3, 1), (7, 5)] {
                let by = lamp.scramble([17 * seed, 3 + seed], depth, seed % 3);
                let all: Vec<_> = (0..64).map(|i| lamp.point(by, sample, i)).collect();
                for m in 0..=6_u32 {
                    for part in all.chunks(1 << m) {
                        for a in 0..=m {
                            assert!(boxes(part, a, m - a).iter().all(|&n| n == 1), "{m} {a} {part:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn each_pair_of_coordinates_in_the_cube_is_spread_evenly() {
        let lamp = points(64, Pattern::Grid, 2);
        for seed in 0..8 {
            let by = lamp.scramble([seed, 3], 1, 2);
            let all: Vec<_> = (0..64).map(|i| lamp.in_cube(by, 1, i)).collect();
            for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                let plane: Vec<_> = all.iter().map(|p| [p[a], p[b]]).collect();
                // The first three dimensions form a (1, 6, 3)-net: boxes of two points, and each line of 64 cells has one.
                assert!(boxes(&plane, 3, 2).iter().all(|&n| n == 2), "{a} {b}");
                assert!(boxes(&plane, 6, 0).iter().chain(&boxes(&plane, 0, 6)).all(|&n| n == 1), "{a} {b}");
            }
        }
    }

    #[test]
    fn eight_places_have_the_points_of_each() {
        for lamp in [points(16, Pattern::Sobol, 1), points(16, Pattern::Grid, 1)] {
            let by: [Scramble; 8] = std::array::from_fn(|k| lamp.scramble([k as u32, 7], 2, 1));
            for i in 0..16 {
                let [x, y] = lamp.points8(&by, 3, i);
                for (k, &by) in by.iter().enumerate() {
                    assert_eq!([x.lane(k), y.lane(k)], lamp.point(by, 3, i));
                }
            }
        }
    }

    #[test]
    fn the_rays_of_a_pixel_continue_each_others_points() {
        let lamp = points(16, Pattern::Sobol, 1);
        let by = lamp.scramble([5, 9], 0, 0);
        let all: Vec<_> = (0..16).flat_map(|sample| (0..16).map(move |i| (sample, i))).collect();
        let all: Vec<_> = all.into_iter().map(|(sample, i)| lamp.point(by, sample, i)).collect();
        for a in 0..=8 {
            assert!(boxes(&all, a, 8 - a).iter().all(|&n| n == 1));
        }
    }

    #[test]
    fn pixels_depths_lamps_and_seeds_have_points_of_their_own() {
        let lamp = points(16, Pattern::Sobol, 7);
        let first = |lamp: &LampPoints, pixel, depth, light| lamp.point(lamp.scramble(pixel, depth, light), 0, 0);
        let here = first(&lamp, [40, 30], 0, 0);
        let others = [
            first(&lamp, [41, 30], 0, 0),
            first(&lamp, [40, 31], 0, 0),
            first(&lamp, [30, 40], 0, 0),
            first(&lamp, [40, 30], 1, 0),
            first(&lamp, [40, 30], 0, 1),
            first(&points(16, Pattern::Sobol, 8), [40, 30], 0, 0),
        ];
        assert!(others.iter().all(|&o| o != here), "{here:?} {others:?}");
    }

    #[test]
    fn scrambled_points_are_where_they_are_anywhere_as_often() {
        // The first point alone, over many pixels: a uniform one in the square.
        let lamp = points(16, Pattern::Sobol, 0);
        let firsts: Vec<_> = (0..4096).map(|i| lamp.point(lamp.scramble([i % 64, i / 64], 0, 0), 0, 0)).collect();
        let found = boxes(&firsts, 3, 3);
        // 64 points are expected in each of 64 boxes. Chi squared with 63 degrees of freedom is below 114 with
        // probability 0.9999.
        let chi: f64 = found.iter().map(|&n| (f64::from(n) - 64.0).powi(2) / 64.0).sum();
        assert!(chi < 114.0, "{chi} {found:?}");
    }

    #[test]
    fn a_grid_has_every_cell_once_and_one_of_each_quarter_first() {
        for side in 1..=9_u32 {
            let lamp = points(side * side, Pattern::Grid, 3);
            let by = lamp.scramble([1, 2], 3, 4);
            let mut cells: Vec<_> = (0..lamp.count())
                .map(|i| lamp.point(by, 7, i).map(|x| (f64::from(x) * f64::from(side)) as u32))
                .collect();
            if side > 1 {
                let quarters: std::collections::BTreeSet<_> =
                    cells[..4].iter().map(|c| c.map(|x| 2 * x >= side)).collect();
                assert!(quarters.len() == 4, "{side}: {:?}", &cells[..4]);
            }
            cells.sort_unstable();
            cells.dedup();
            assert_eq!(cells.len() as u32, side * side);
        }
    }
}
