//! Embree at its best: every width and flag that helps it, in both accuracies.

use super::contender::{Answers, Contender, Label, PIECE, Through};
use super::rays::RaySet;
use super::team::Team;
use crate::accel::embree::{Embree, Mode, Options, Packed, Width};
use crate::accel::{BuildStats, Coherence, Intersector};
use crate::error::Result;
use crate::geometry::{Geometry, Hit8, Ray8};
use crate::simd::Mask8;

/// What is built of Embree: the name of the back end, and how to trace.
pub const MODES: [(&str, Mode); 2] = [("embree-robust", Mode::Robust), ("embree-fast", Mode::Fast)];

/// Rays a call, and the flag; `i` and `c` for incoherent and coherent, which one ray a call does not look at.
const CALLS: [(&str, Width, Coherence); 5] = [
    ("1i", Width::One, Coherence::Incoherent),
    ("8i", Width::Eight, Coherence::Incoherent),
    ("8c", Width::Eight, Coherence::Coherent),
    ("16i", Width::Sixteen, Coherence::Incoherent),
    ("16c", Width::Sixteen, Coherence::Coherent),
];

/// Builds with `RTC_BUILD_QUALITY_MEDIUM`, by so many threads.
///
/// # Errors
/// As [`Embree::build`].
pub fn build(geometry: &[Geometry], mode: Mode, threads: usize) -> Result<Embree> {
    Embree::build(geometry, &Options { mode, threads, ..Options::default() })
}

/// One scene in all modes: as renders use it, then packed beforehand by each width and flag.
pub fn contenders<'a>(backend: &'static str, embree: &'a Embree) -> Vec<Box<dyn Contender + 'a>> {
    let mut all: Vec<Box<dyn Contender + 'a>> = vec![Box::new(Through::new(backend, "auto", Shared(embree)))];
    for (mode, width, coherence) in CALLS {
        let label = Label { backend, mode };
        all.push(Box::new(Prepacked { label, embree, width, coherence, pieces: Vec::new() }));
    }
    all
}

/// A scene that several contenders hold.
struct Shared<'a>(&'a Embree);

impl Intersector for Shared<'_> {
    type Scratch = <Embree as Intersector>::Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Self::Scratch) {
        self.0.closest(rays, hits, coherence, scratch);
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Self::Scratch) {
        self.0.occluded(rays, blocked, coherence, scratch);
    }

    fn build_stats(&self) -> BuildStats {
        self.0.build_stats()
    }
}

/// Calls of Embree on rays that are in its layout before the clock starts, and hits left in it.
struct Prepacked<'a> {
    label: Label,
    embree: &'a Embree,
    width: Width,
    coherence: Coherence,
    pieces: Vec<Packed>,
}

impl Contender for Prepacked<'_> {
    fn label(&self) -> Label {
        self.label
    }

    fn prepare(&mut self, set: &RaySet) {
        self.pieces.resize_with(set.rays.len().div_ceil(PIECE), Packed::default);
        for (piece, rays) in self.pieces.iter_mut().zip(set.rays.chunks(PIECE)) {
            self.embree.pack(rays, self.width, set.kind.any_hit(), piece);
        }
    }

    fn trace(&mut self, _: &RaySet, team: &Team) {
        let (embree, coherence) = (self.embree, self.coherence);
        team.share(self.pieces.iter_mut(), || (), |(), piece| embree.trace_packed(piece, coherence));
    }

    fn answers(&self, set: &RaySet) -> Answers {
        let pieces = || self.pieces.iter().zip(set.rays.chunks(PIECE));
        if set.kind.any_hit() {
            let mut blocked = vec![Mask8::NONE; set.rays.len()];
            for ((piece, rays), blocked) in pieces().zip(blocked.chunks_mut(PIECE)) {
                self.embree.unpack_blocked(piece, rays, blocked);
            }
            Answers::Blocked(blocked)
        } else {
            let mut hits = vec![Hit8::default(); set.rays.len()];
            for ((piece, rays), hits) in pieces().zip(hits.chunks_mut(PIECE)) {
                self.embree.unpack(piece, rays, hits);
            }
            Answers::Closest(hits)
        }
    }
}
