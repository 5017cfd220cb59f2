//! Contenders that trace ray streams, and the list of all contenders.

use std::sync::{Mutex, PoisonError};

use super::contender::{Answers, Contender, Label, Mode, PIECE};
use super::prepacked::Prepacked;
use super::rays::RaySet;
use super::team::Team;
use crate::accel::{Accel, Intersector};
use crate::geometry::Hit8;
use crate::simd::Mask8;

/// An accelerator that traces ray streams, as in a render.
struct Streams {
    label: Label,
    accel: Accel,
    hits: Vec<Hit8>,
    blocked: Vec<Mask8>,
    /// Scratch memory of the threads of earlier runs. A render allocates it only once, too.
    spare: Mutex<Vec<Scratch>>,
}

type Scratch = <Accel as Intersector>::Scratch;

/// Scratch memory on loan. Returns it when dropped.
struct Loan<'a> {
    scratch: Scratch,
    spare: &'a Mutex<Vec<Scratch>>,
}

impl<'a> Loan<'a> {
    fn new(spare: &'a Mutex<Vec<Scratch>>) -> Self {
        let scratch = spare.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Self { scratch: scratch.unwrap_or_default(), spare }
    }
}

impl Drop for Loan<'_> {
    fn drop(&mut self) {
        let scratch = std::mem::take(&mut self.scratch);
        self.spare.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
    }
}

impl Contender for Streams {
    fn label(&self) -> Label {
        self.label
    }

    fn prepare(&mut self, set: &RaySet) {
        self.hits.resize(if set.kind.any_hit() { 0 } else { set.rays.len() }, Hit8::default());
        self.blocked.resize(if set.kind.any_hit() { set.rays.len() } else { 0 }, Mask8::NONE);
    }

    fn trace(&mut self, set: &RaySet, team: &Team) {
        let (accel, coherence, spare) = (&self.accel, set.kind.coherence(), &self.spare);
        let pieces = set.rays.chunks(PIECE);
        if set.kind.any_hit() {
            let pieces = pieces.zip(self.blocked.chunks_mut(PIECE));
            team.share(
                pieces,
                || Loan::new(spare),
                |loan, (rays, blocked)| accel.occluded(rays, blocked, coherence, &mut loan.scratch),
            );
        } else {
            let pieces = pieces.zip(self.hits.chunks_mut(PIECE));
            team.share(
                pieces,
                || Loan::new(spare),
                |loan, (rays, hits)| accel.closest(rays, hits, coherence, &mut loan.scratch),
            );
        }
    }

    fn answers(&self, set: &RaySet) -> Answers {
        if set.kind.any_hit() { Answers::Blocked(self.blocked.clone()) } else { Answers::Closest(self.hits.clone()) }
    }
}

/// Returns all contenders over one accelerator. The first traces as in renders. The others of native are restricted to
/// one kernel each. Those of Embree make calls of one width and flag, on rays that were packed beforehand.
#[must_use]
pub fn contenders(accel: &Accel) -> Vec<Box<dyn Contender + '_>> {
    let backend = accel.backend();
    let streams = |mode, accel: Accel| -> Box<dyn Contender + '_> {
        let label = Label { backend, mode };
        Box::new(Streams { label, accel, hits: Vec::new(), blocked: Vec::new(), spare: Mutex::default() })
    };
    let mut all = vec![streams(Mode::Auto, accel.clone())];
    match accel.embree() {
        None => all.extend(accel.by_kernel().map(|(kernel, accel)| streams(Mode::Only(kernel), accel))),
        Some(embree) => all.extend(Prepacked::all(backend, embree)),
    }
    all
}
