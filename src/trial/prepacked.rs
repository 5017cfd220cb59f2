//! Embree with calls of each width and flag, on rays converted to its layout before they are timed.

use super::contender::{Answers, Contender, Label, Mode, PIECE};
use super::rays::RaySet;
use super::team::Team;
use crate::accel::embree::{Embree, Packed, Width};
use crate::accel::{Backend, Coherence};
use crate::geometry::Hit8;
use crate::simd::Mask8;

/// Name, rays per call, and coherence flag: `i` for incoherent, `c` for coherent. Calls of one ray ignore the flag.
const CALLS: [(&str, Width, Coherence); 5] = [
    ("1i", Width::One, Coherence::Incoherent),
    ("8i", Width::Eight, Coherence::Incoherent),
    ("8c", Width::Eight, Coherence::Coherent),
    ("16i", Width::Sixteen, Coherence::Incoherent),
    ("16c", Width::Sixteen, Coherence::Coherent),
];

/// Contender that makes calls of one width and flag. Hits stay in Embree's layout while it is timed.
pub(super) struct Prepacked<'a> {
    label: Label,
    embree: &'a Embree,
    width: Width,
    coherence: Coherence,
    pieces: Vec<Packed>,
}

impl<'a> Prepacked<'a> {
    /// Returns one contender for each width and flag.
    pub fn all(backend: Backend, embree: &'a Embree) -> impl Iterator<Item = Box<dyn Contender + 'a>> {
        CALLS.into_iter().map(move |(mode, width, coherence)| -> Box<dyn Contender + 'a> {
            Box::new(Self {
                label: Label { backend, mode: Mode::Only(mode) },
                embree,
                width,
                coherence,
                pieces: Vec::new(),
            })
        })
    }
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
