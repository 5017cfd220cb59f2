//! Splits of a set of primitives by the binned surface area heuristic, and partitions by them.

use rayon::prelude::*;

use super::super::node::bvh8::LEAF_SIZE;
use super::primitive::{Bounds, PrimRef, half_area};
use crate::math::Real;
use crate::simd::{F32x8, Mask8};

/// Bins per axis, for large sets and for small ones (in which the bins cost more than the primitives). Multiples of eight.
const BINS: usize = 16;
const FEW_BINS: usize = 8;
/// Sets of at most this many primitives are small.
const SMALL: usize = 128;

/// Sets larger than this are scanned by several tasks, in pieces of this size.
const PIECE: usize = 1 << 15;

/// Number of neighbours in memory that are sampled together.
const RUN: usize = 4;

/// Of large sets about this many primitives are binned, evenly spread.
const SAMPLES: usize = 4096;

/// The extent of a set of primitives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// The box around the primitives.
    pub bounds: Bounds,
    /// The box around the doubled centres.
    centres: Bounds,
}

impl Extent {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, centres: Bounds::EMPTY };

    /// The extent of `prims`.
    pub fn of(prims: &[PrimRef]) -> Self {
        if prims.len() > PIECE {
            return prims.par_chunks(PIECE).map(Self::of).reduce(|| Self::EMPTY, Self::union);
        }
        prims.iter().fold(Self::EMPTY, |e, p| e.with(p.0, p.twice_centres()))
    }

    #[inline(always)]
    fn with(self, bounds: F32x8, centres: F32x8) -> Self {
        Self { bounds: self.bounds.union(bounds), centres: self.centres.union(centres) }
    }

    fn union(self, o: Self) -> Self {
        self.with(o.bounds.0, o.centres.0)
    }

    /// A grid over the centres with `cells` cells along each axis.
    pub fn grid(&self, cells: usize) -> Grid {
        Grid(Scale::new(self, cells))
    }

    /// The axis along which the centres lie farthest apart.
    fn widest(&self) -> usize {
        let (lo, hi) = (self.centres.lo(), self.centres.hi());
        let width = |k: usize| hi[k] - lo[k];
        (1..3).fold(0, |a, k| if width(k) > width(a) { k } else { a })
    }
}

/// The map from doubled centres to bins, by axis: start of the first bin, bins per unit of length (0 if the centres
/// coincide), and index of the last bin.
#[derive(Clone, Copy, Debug)]
struct Scale {
    start: F32x8,
    per_length: F32x8,
    last: F32x8,
}

impl Scale {
    #[inline(always)]
    fn new(extent: &Extent, bins: usize) -> Self {
        let (lo, hi) = (extent.centres.lo(), extent.centres.hi());
        let per_length = |axis: usize| {
            let per_length = bins as f32 / (hi[axis] - lo[axis]);
            if per_length.is_finite() { per_length } else { 0.0 }
        };
        let lanes = |[x, y, z]: [f32; 3]| F32x8::new([x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0]);
        Self {
            start: lanes(lo),
            per_length: lanes([per_length(0), per_length(1), per_length(2)]),
            last: F32x8::from((bins - 1) as f32),
        }
    }

    /// Bins of a primitive with these doubled centres, by axis. Every input gives a valid bin, NaN too.
    #[inline(always)]
    fn bins_of(&self, centres: F32x8) -> F32x8 {
        ((centres - self.start) * self.per_length).max_or(F32x8::ZERO).min_or(self.last)
    }
}

/// A grid of equal cells over the centres of a set.
pub(super) struct Grid(Scale);

impl Grid {
    /// The cell of a primitive, by axis.
    #[inline(always)]
    pub fn cell(&self, p: &PrimRef) -> [i32; 3] {
        let [x, y, z, ..] = self.0.bins_of(p.twice_centres()).truncated();
        [x, y, z]
    }
}

/// A split of a set at a bin border.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    scale: Scale,
    axis: usize,
    /// Index of the first bin of the upper part.
    bin: usize,
    /// Boxes around both parts, if every primitive was binned.
    part_bounds: Option<[Bounds; 2]>,
}

/// Bins along the three axes: the box around the primitives of each bin, and their number.
struct Bins<const N: usize> {
    bounds: [[F32x8; N]; 3],
    count: [[i32; N]; 3],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self { bounds: [[F32x8::INFINITY; N]; 3], count: [[0; N]; 3] };

    #[inline(always)]
    fn add(&mut self, prims: &[PrimRef], scale: &Scale) {
        for p in prims {
            let places = scale.bins_of(p.twice_centres()).truncated();
            for (axis, &place) in places[..3].iter().enumerate() {
                let bin = place as usize % N;
                self.bounds[axis][bin] = self.bounds[axis][bin].min_or(p.0);
                self.count[axis][bin] += 1;
            }
        }
    }

    /// Boxes around the bins below a border, and around the others.
    fn part_bounds(&self, axis: usize, border: usize) -> [Bounds; 2] {
        let (below, above) = self.bounds[axis].split_at(border);
        [below, above].map(|part| part.iter().fold(Bounds::EMPTY, |bounds, &bin| bounds.union(bin)))
    }

    /// Returns the cheapest border, as `(axis, first bin above)`. Eight borders are computed at once. Ties go to the lower
    /// axis, then to the lower bin.
    #[inline(always)]
    fn best(&self) -> Option<(usize, usize)> {
        let (mut best, mut place) = (F32x8::INFINITY, F32x8::ZERO);
        for axis in 0..3 {
            let (bounds, count) = (&self.bounds[axis], &self.count[axis]);
            // For each border: boxes and counts of the bins below it and above it.
            let (mut below, mut above) = ([F32x8::INFINITY; N], *bounds);
            let (mut low, mut high) = ([0; N], *count);
            for i in 1..N {
                below[i] = below[i - 1].min_or(bounds[i - 1]);
                low[i] = low[i - 1] + count[i - 1];
                let k = N - 1 - i;
                above[k] = above[k].min_or(above[k + 1]);
                high[k] += high[k + 1];
            }
            for eight in (0..N).step_by(8) {
                let areas = |boxes: &[F32x8; N]| half_areas(std::array::from_fn(|i| boxes[eight + i]));
                let blocks = |count: &[i32; N]| F32x8::from_fn(|i| blocks(count[eight + i]) as f32);
                let (low, high) = (blocks(&low), blocks(&high));
                let cost = areas(&below) * low + areas(&above) * high;
                let cheaper = cost.lt(best) & F32x8::ZERO.lt(low) & F32x8::ZERO.lt(high);
                best = cheaper.select(cost, best);
                place = cheaper.select(F32x8::from_fn(|i| (axis * N + eight + i) as f32), place);
            }
        }
        let (cost, place) = (best.to_array(), place.to_array());
        let sooner = |a: usize, b: usize| if (cost[b], place[b]) < (cost[a], place[a]) { b } else { a };
        let lane = (1..8).fold(0, sooner);
        let place = place[lane] as usize;
        (cost[lane] < f32::INFINITY).then_some((place / N, place % N))
    }
}

/// Number of leaves that `count` primitives fill.
#[inline(always)]
fn blocks(count: i32) -> i32 {
    const { assert!(LEAF_SIZE == 8) };
    (count + 7) >> 3
}

/// [`Bounds::half_area`] of eight boxes at once.
#[inline(always)]
fn half_areas(boxes: [F32x8; 8]) -> F32x8 {
    let [a, b, c, _, d, e, f, _] = F32x8::transpose(boxes);
    let length = |lo: F32x8, negated_hi: F32x8| (F32x8::ZERO - (lo + negated_hi)).max_or(F32x8::ZERO);
    half_area(length(a, d), length(b, e), length(c, f))
}

/// Returns the cheapest split by the surface area heuristic, or `None` if every border leaves one side empty or has an
/// infinite cost.
pub(super) fn best(prims: &[PrimRef], extent: &Extent) -> Option<Split> {
    if prims.len() <= SMALL {
        best_of::<FEW_BINS>(prims, prims.len(), extent)
    } else if prims.len() < 2 * SAMPLES {
        best_of::<BINS>(prims, prims.len(), extent)
    } else {
        // An odd number of runs: meshes often repeat with an even period.
        best_of::<BINS>(prims, ((prims.len() / SAMPLES) | 1) * RUN, extent)
    }
}

/// Bins the first [`RUN`] primitives of each `step`, or all primitives if `step` is their number.
#[inline(always)]
fn best_of<const N: usize>(prims: &[PrimRef], step: usize, extent: &Extent) -> Option<Split> {
    let scale = Scale::new(extent, N);
    let run = if step == prims.len() { step } else { RUN };
    let mut bins = Bins::<N>::EMPTY;
    for piece in prims.chunks(step) {
        bins.add(&piece[..run.min(piece.len())], &scale);
    }
    let (axis, bin) = bins.best()?;
    let part_bounds = (run == step).then(|| bins.part_bounds(axis, bin));
    Some(Split { scale, axis, bin, part_bounds })
}

/// Moves the primitives below the split to the front. Returns their number and the extents of both parts.
pub(super) fn partition(prims: &mut [PrimRef], split: &Split) -> (usize, [Extent; 2]) {
    let Some([low, high]) = split.part_bounds else { return move_below::<true>(prims, split) };
    let (middle, [a, b]) = move_below::<false>(prims, split);
    (middle, [Extent { bounds: low, centres: a.centres }, Extent { bounds: high, centres: b.centres }])
}

/// [`partition`] without a branch on the part of a primitive, which the CPU could not predict. The boxes of the parts are
/// computed if `BOUNDS`.
#[inline(always)]
fn move_below<const BOUNDS: bool>(prims: &mut [PrimRef], split: &Split) -> (usize, [Extent; 2]) {
    let border = F32x8::from(split.bin as f32);
    let (mut low, mut high) = (Extent::EMPTY, Extent::EMPTY);
    let mut middle = 0;
    for i in 0..prims.len() {
        let p = prims[i];
        let centres = p.twice_centres();
        // A bin before truncation is below a whole number exactly if the truncated one is.
        let below = split.scale.bins_of(centres).lt(border).bits() >> split.axis & 1;
        let (in_low, none) = (Mask8::from_bits(below.wrapping_neg()), F32x8::INFINITY);
        if BOUNDS {
            low.bounds = low.bounds.union(in_low.select(p.0, none));
            high.bounds = high.bounds.union(in_low.select(none, p.0));
        }
        low.centres = low.centres.union(in_low.select(centres, none));
        high.centres = high.centres.union(in_low.select(none, centres));
        prims[i] = prims[middle];
        prims[middle] = p;
        middle += usize::from(below);
    }
    (middle, [low, high])
}

/// Splits at the median centre along the widest axis. Used where the heuristic finds no split, or where the tree would
/// become too deep.
pub(super) fn halve(prims: &mut [PrimRef], extent: &Extent) -> (usize, [Extent; 2]) {
    let axis = extent.widest();
    let middle = prims.len() / 2;
    prims.select_nth_unstable_by(middle, |a, b| {
        a.twice_centre(axis).total_cmp(&b.twice_centre(axis)).then_with(|| a.id().cmp(&b.id()))
    });
    (middle, [Extent::of(&prims[..middle]), Extent::of(&prims[middle..])])
}
