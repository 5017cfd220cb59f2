//! Where on a lamp with an extent its samples lie.
//!
//! The points of a place depend on its pixel, on which of the pixel's camera rays it comes of, on how often that ray
//! was reflected or refracted, and on the lamp; on nothing that has to do with how rays are grouped. Both renderers
//! take the same ones. Places that share all four share the points, which costs nothing but a little of the averaging
//! between them.
//!
//! Sobol's first two dimensions, scrambled after Owen 1995 with the hash of Laine & Karras 2011 in the constants of
//! Vegdahl 2021, as Burley 2020 ("Practical hash-based Owen scrambling", JCGT 9(4)) does it. Any aligned power of two
//! of the points is a (0, m, 2)-net in base 2: every box of that share of the square's area, however it is halved, has
//! one of them. Counts that are powers of two make best use of that.

use crate::scene::{LampSampling, Pattern};
use crate::simd::F32x8;

/// One camera ray: the pixel it belongs to, by column and row, and its number within that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilmRay {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Which of the pixel's rays, from 0.
    pub sample: u32,
}

/// What scrambles the points of one place and lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scramble(u32);

/// The points of all places.
#[derive(Clone, Debug)]
pub struct LampPoints {
    sampling: LampSampling,
    /// The cells of a grid, such that the first four lie in its four quarters.
    cells: Vec<[f32; 2]>,
}

impl LampPoints {
    /// The points that the settings ask for.
    #[must_use]
    pub fn new(sampling: &LampSampling) -> Self {
        let cells = if sampling.pattern == Pattern::Grid { grid(sampling.count.isqrt()) } else { Vec::new() };
        Self { sampling: *sampling, cells }
    }

    /// How many there are for a place, at least 1.
    #[must_use]
    pub fn count(&self) -> u32 {
        if self.cells.is_empty() { self.sampling.count.max(1) } else { self.cells.len() as u32 }
    }

    /// What scrambles the points where a ray that has been reflected and refracted `depth` times since it left the
    /// camera through `pixel` meets a surface that the lamp of this number shines on.
    #[inline]
    #[must_use]
    pub fn scramble(&self, pixel: [u32; 2], depth: u32, lamp: u32) -> Scramble {
        let mut key = mix(self.sampling.seed ^ 0x9e37_79b9);
        for part in [pixel[0], pixel[1], depth, lamp] {
            key = mix(key ^ part.wrapping_mul(0x85eb_ca6b).wrapping_add(key << 6));
        }
        Scramble(key)
    }

    /// The `i`th point, within the unit square, of the `sample`th camera ray of a pixel. Multiples of 2^-24 below 1.
    #[inline]
    #[must_use]
    pub fn point(&self, by: Scramble, sample: u32, i: u32) -> [f32; 2] {
        if let Some(&cell) = self.cells.get(i as usize) {
            return cell;
        }
        self.number(sample, i).scrambled(by).map(fraction)
    }

    /// The same for eight places.
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

    #[inline(always)]
    fn number(&self, sample: u32, i: u32) -> Sobol {
        let number = sample.wrapping_mul(self.count()).wrapping_add(i);
        // The first dimension is the number with its bits reversed.
        Sobol { reversed: [number, second_dimension(number).reverse_bits()] }
    }
}

/// A point of Sobol's sequence, the bits of both coordinates reversed.
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

/// The middles of a square grid's cells, those in the middles of its quarters first.
fn grid(side: u32) -> Vec<[f32; 2]> {
    let middle = |k: u32| ((f64::from(k) + 0.5) / f64::from(side)) as f32;
    let mut cells: Vec<[u32; 2]> = (0..side).flat_map(|y| (0..side).map(move |x| [x, y])).collect();
    let (low, high) = (side / 4, side - 1 - side / 4);
    for (front, cell) in [[low, low], [high, high], [high, low], [low, high]].into_iter().enumerate() {
        // A grid of one cell or of four has its quarters in their places.
        if let Some(at) = cells.iter().skip(front).position(|&c| c == cell) {
            cells.swap(front, front + at);
        }
    }
    cells.into_iter().map(|cell| cell.map(middle)).collect()
}

/// The hash of Burley's appendix ("lowbias32" by Wellons).
#[inline(always)]
const fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

/// A number of reversed bits, scrambled after Owen and put back in order: each bit is flipped by a hash of the bits
/// above it in the result.
#[inline(always)]
const fn scrambled(mut reversed: u32, seed: u32) -> u32 {
    reversed ^= reversed.wrapping_mul(0x3d20_adea);
    reversed = reversed.wrapping_add(seed);
    reversed = reversed.wrapping_mul((seed >> 16) | 1);
    reversed ^= reversed.wrapping_mul(0x0552_6c56);
    reversed ^= reversed.wrapping_mul(0x53a2_2864);
    reversed.reverse_bits()
}

/// Sobol's second dimension: the direction numbers of the polynomial x + 1, which are Pascal's triangle modulo 2.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: u32, pattern: Pattern, seed: u32) -> LampPoints {
        LampPoints::new(&LampSampling { count, pattern, seed, probe: true })
    }

    /// How many of the points lie in each box when the sides are cut into `2^a` and `2^b`.
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
        // 64 expected in each of 64 boxes: chi squared of 63 degrees of freedom, below 114 with a chance of 0.9999.
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
