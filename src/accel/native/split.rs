//! Where to divide a set of primitives.

use rayon::prelude::*;

use super::bvh2::{Bounds, LEAF_SIZE, PrimRef};
use crate::math::{LaneMask, Real};
use crate::simd::{F32x8, Mask8};

/// Bins an axis, of large sets; and of small ones, whose bins cost more than what they hold.
const BINS: usize = 16;
const FEW_BINS: usize = 8;
const SMALL: usize = 32;

/// Sets larger than this are looked through by several tasks, in pieces of this size.
const PIECE: usize = 1 << 15;

/// The room a set takes up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// The box around it.
    pub bounds: Bounds,
    /// The box around the doubled centres.
    centres: Bounds,
}

impl Extent {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, centres: Bounds::EMPTY };

    /// Of a set.
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
}

/// From doubled centres to bins: where the first one begins, and how many there are in a unit of length, by axis; 0
/// where the centres coincide.
#[derive(Clone, Copy, Debug)]
struct Scale {
    start: F32x8,
    per_length: F32x8,
    last: F32x8,
}

impl Scale {
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

    /// The bins of a primitive with these doubled centres, by axis; any number at all gives a bin.
    #[inline(always)]
    fn bins_of(&self, centres: F32x8) -> F32x8 {
        ((centres - self.start) * self.per_length).max_or(F32x8::ZERO).min_or(self.last)
    }
}

/// A way to divide a set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    scale: Scale,
    axis: usize,
    /// The first bin of the upper part.
    bin: usize,
    /// Area times leaf blocks of both parts.
    pub cost: f32,
}

#[derive(Clone, Copy)]
struct Bins<const N: usize> {
    bounds: [[Bounds; N]; 3],
    count: [[u32; N]; 3],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self { bounds: [[Bounds::EMPTY; N]; 3], count: [[0; N]; 3] };

    fn of(prims: &[PrimRef], scale: &Scale) -> Self {
        if prims.len() > PIECE {
            return prims.par_chunks(PIECE).map(|c| Self::of(c, scale)).reduce(|| Self::EMPTY, Self::union);
        }
        let mut bins = Self::EMPTY;
        for p in prims {
            let places = scale.bins_of(p.twice_centres()).truncated();
            for (axis, &place) in places[..3].iter().enumerate() {
                let bin = place as usize % N;
                bins.bounds[axis][bin] = bins.bounds[axis][bin].union(p.0);
                bins.count[axis][bin] += 1;
            }
        }
        bins
    }

    fn union(mut self, o: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..N {
                self.bounds[axis][bin] = self.bounds[axis][bin].union(o.bounds[axis][bin].0);
                self.count[axis][bin] += o.count[axis][bin];
            }
        }
        self
    }
}

/// The cheapest division by the surface area heuristic; `None` where every bin border leaves one side empty or costs
/// more than can be told. Ties go to the lower axis, then to the lower bin.
pub(super) fn best(prims: &[PrimRef], extent: &Extent) -> Option<Split> {
    if prims.len() > SMALL { best_of::<BINS>(prims, extent) } else { best_of::<FEW_BINS>(prims, extent) }
}

fn best_of<const N: usize>(prims: &[PrimRef], extent: &Extent) -> Option<Split> {
    let scale = Scale::new(extent, N);
    let bins = Bins::<N>::of(prims, &scale);
    let blocks = |count: u32| count.div_ceil(LEAF_SIZE as u32) as f32;
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        let (bounds, counts) = (&bins.bounds[axis], &bins.count[axis]);
        let mut above = [0.0_f32; N];
        let (mut room, mut count) = (Bounds::EMPTY, 0);
        for bin in (1..N).rev() {
            room = room.union(bounds[bin].0);
            count += counts[bin];
            above[bin] = if count == 0 { f32::INFINITY } else { room.half_area() * blocks(count) };
        }
        let (mut room, mut count) = (Bounds::EMPTY, 0);
        for bin in 1..N {
            room = room.union(bounds[bin - 1].0);
            count += counts[bin - 1];
            if count == 0 {
                continue;
            }
            let cost = room.half_area() * blocks(count) + above[bin];
            if cost < best.map_or(f32::INFINITY, |b| b.cost) {
                best = Some(Split { scale, axis, bin, cost });
            }
        }
    }
    best
}

/// Moves the primitives below the division to the front; how many they are, and what room each part takes up.
///
/// Nothing branches on which part a primitive belongs to, since that cannot be foreseen.
pub(super) fn partition(prims: &mut [PrimRef], split: &Split) -> (usize, [Extent; 2]) {
    let border = F32x8::from(split.bin as f32);
    let (mut low, mut high) = (Extent::EMPTY, Extent::EMPTY);
    let mut middle = 0;
    for i in 0..prims.len() {
        let p = prims[i];
        let centres = p.twice_centres();
        // Truncated places are below a whole number exactly where the places themselves are.
        let below = split.scale.bins_of(centres).lt(border).bits() >> split.axis & 1 != 0;
        let (in_low, none) = (Mask8::splat(below), F32x8::INFINITY);
        low = low.with(in_low.select(p.0, none), in_low.select(centres, none));
        high = high.with(in_low.select(none, p.0), in_low.select(none, centres));
        prims[i] = prims[middle];
        prims[middle] = p;
        middle += usize::from(below);
    }
    (middle, [low, high])
}

/// Divides by number at the median centre along the widest axis, where the heuristic finds nothing or must not go on.
pub(super) fn halve(prims: &mut [PrimRef], extent: &Extent) -> (usize, [Extent; 2]) {
    let (lo, hi) = (extent.centres.lo(), extent.centres.hi());
    let width = [0, 1, 2].map(|k| hi[k] - lo[k]);
    let axis = (0..3).fold(0, |a, k| if width[k] > width[a] { k } else { a });
    let middle = prims.len() / 2;
    prims.select_nth_unstable_by(middle, |a, b| {
        a.twice_centre(axis).total_cmp(&b.twice_centre(axis)).then_with(|| a.id().cmp(&b.id()))
    });
    (middle, [Extent::of(&prims[..middle]), Extent::of(&prims[middle..])])
}
