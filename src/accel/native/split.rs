//! Where to divide a set of primitives.

use rayon::prelude::*;

use super::bvh2::{Bounds, LEAF_SIZE, PrimRef};
use crate::simd::F32x8;

/// Bins an axis.
const BINS: usize = 16;

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
        prims.iter().fold(Self::EMPTY, |e, p| {
            let [x, y, z] = [0, 1, 2].map(|axis| p.twice_centre(axis));
            let centre = F32x8::new([x, y, z, 0.0, -x, -y, -z, 0.0]);
            Self { bounds: e.bounds.union(p.0), centres: e.centres.union(centre) }
        })
    }

    fn union(self, o: Self) -> Self {
        Self { bounds: self.bounds.union(o.bounds.0), centres: self.centres.union(o.centres.0) }
    }

    /// First centre and bins a unit of length, by axis; 0 bins where the centres coincide.
    fn scale(&self, axis: usize) -> (f32, f32) {
        let (lo, hi) = (self.centres.lo()[axis], self.centres.hi()[axis]);
        let per_length = BINS as f32 / (hi - lo);
        (lo, if per_length.is_finite() { per_length } else { 0.0 })
    }
}

/// The bin of a primitive; any number at all gives a bin.
#[inline(always)]
fn bin_of(p: &PrimRef, axis: usize, (start, per_length): (f32, f32)) -> usize {
    (((p.twice_centre(axis) - start) * per_length) as usize).min(BINS - 1)
}

/// A way to divide a set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    /// Along which axis.
    pub axis: usize,
    /// The first bin of the upper part.
    pub bin: usize,
    /// Area times leaf blocks of both parts.
    pub cost: f32,
}

#[derive(Clone, Copy)]
struct Bins {
    bounds: [[Bounds; BINS]; 3],
    count: [[u32; BINS]; 3],
}

impl Bins {
    const EMPTY: Self = Self { bounds: [[Bounds::EMPTY; BINS]; 3], count: [[0; BINS]; 3] };

    fn of(prims: &[PrimRef], scales: &[(f32, f32); 3]) -> Self {
        if prims.len() > PIECE {
            return prims.par_chunks(PIECE).map(|c| Self::of(c, scales)).reduce(|| Self::EMPTY, Self::union);
        }
        let mut bins = Self::EMPTY;
        for p in prims {
            for (axis, scale) in scales.iter().enumerate() {
                let bin = bin_of(p, axis, *scale);
                bins.bounds[axis][bin] = bins.bounds[axis][bin].union(p.0);
                bins.count[axis][bin] += 1;
            }
        }
        bins
    }

    fn union(mut self, o: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
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
    let scales = [0, 1, 2].map(|axis| extent.scale(axis));
    let bins = Bins::of(prims, &scales);
    let blocks = |count: u32| count.div_ceil(LEAF_SIZE as u32) as f32;
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        let (bounds, counts) = (&bins.bounds[axis], &bins.count[axis]);
        let mut above = [0.0_f32; BINS];
        let (mut room, mut count) = (Bounds::EMPTY, 0);
        for bin in (1..BINS).rev() {
            room = room.union(bounds[bin].0);
            count += counts[bin];
            above[bin] = if count == 0 { f32::INFINITY } else { room.half_area() * blocks(count) };
        }
        let (mut room, mut count) = (Bounds::EMPTY, 0);
        for bin in 1..BINS {
            room = room.union(bounds[bin - 1].0);
            count += counts[bin - 1];
            if count == 0 {
                continue;
            }
            let cost = room.half_area() * blocks(count) + above[bin];
            if cost < best.map_or(f32::INFINITY, |b| b.cost) {
                best = Some(Split { axis, bin, cost });
            }
        }
    }
    best
}

/// Moves the primitives below `bin` to the front; how many they are.
pub(super) fn partition(prims: &mut [PrimRef], extent: &Extent, axis: usize, bin: usize) -> usize {
    let scale = extent.scale(axis);
    let (mut low, mut high) = (0, prims.len());
    loop {
        while low < high && bin_of(&prims[low], axis, scale) < bin {
            low += 1;
        }
        while low < high && bin_of(&prims[high - 1], axis, scale) >= bin {
            high -= 1;
        }
        if low >= high {
            return low;
        }
        prims.swap(low, high - 1);
    }
}

/// Divides by number at the median centre along the widest axis, where the heuristic finds nothing or must not go on.
pub(super) fn halve(prims: &mut [PrimRef], extent: &Extent) -> usize {
    let (lo, hi) = (extent.centres.lo(), extent.centres.hi());
    let width = [0, 1, 2].map(|k| hi[k] - lo[k]);
    let axis = (0..3).fold(0, |a, k| if width[k] > width[a] { k } else { a });
    let middle = prims.len() / 2;
    prims.select_nth_unstable_by(middle, |a, b| {
        a.twice_centre(axis).total_cmp(&b.twice_centre(axis)).then_with(|| a.id().cmp(&b.id()))
    });
    middle
}
