//! Who takes part: a way to trace rays, with its name.

use std::sync::{Mutex, PoisonError};

use super::rays::RaySet;
use super::team::Team;
use crate::accel::native::{Kernel, Native, Scratch};
use crate::accel::{BuildStats, Coherence, Intersector};
use crate::geometry::{Hit8, Ray8};
use crate::simd::Mask8;

/// Packets that a thread takes at a time: what renders hand over at once, some hundred microseconds of work.
pub const PIECE: usize = 1024;

/// What a contender is called in reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Label {
    /// `native`, `embree-robust` or `embree-fast`.
    pub backend: &'static str,
    /// `auto`, or what is forced.
    pub mode: &'static str,
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} {}", self.backend, self.mode)
    }
}

/// What a contender found, packet by packet.
#[derive(Clone, Debug)]
pub enum Answers {
    /// The nearest hits.
    Closest(Vec<Hit8>),
    /// Whether anything was hit.
    Blocked(Vec<Mask8>),
}

/// A way to trace rays.
pub trait Contender {
    /// Its name.
    fn label(&self) -> Label;

    /// Whatever need not be timed: room for the answers, rays in its own layout. Called before each run.
    fn prepare(&mut self, set: &RaySet);

    /// Traces all rays of the set it was prepared for: what is timed.
    fn trace(&mut self, set: &RaySet, team: &Team);

    /// What the last run found.
    fn answers(&self, set: &RaySet) -> Answers;
}

/// An accelerator, asked as renders ask it: a stream of [`Ray8`] in, hits out.
pub struct Through<I: Intersector> {
    label: Label,
    accel: I,
    hits: Vec<Hit8>,
    blocked: Vec<Mask8>,
    /// What the threads of the last run left, since a render, too, makes it once and not for every few rays.
    spare: Mutex<Vec<I::Scratch>>,
}

/// Scratch on loan.
struct Loan<'a, S> {
    scratch: Option<S>,
    spare: &'a Mutex<Vec<S>>,
}

impl<'a, S: Default> Loan<'a, S> {
    fn new(spare: &'a Mutex<Vec<S>>) -> Self {
        let scratch = spare.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Self { scratch: Some(scratch.unwrap_or_default()), spare }
    }

    fn get(&mut self) -> &mut S {
        self.scratch.get_or_insert_default()
    }
}

impl<S> Drop for Loan<'_, S> {
    fn drop(&mut self) {
        let scratch = self.scratch.take();
        self.spare.lock().unwrap_or_else(PoisonError::into_inner).extend(scratch);
    }
}

impl<I: Intersector> Through<I> {
    /// `accel` under a name.
    pub fn new(backend: &'static str, mode: &'static str, accel: I) -> Self {
        let label = Label { backend, mode };
        Self { label, accel, hits: Vec::new(), blocked: Vec::new(), spare: Mutex::default() }
    }
}

impl<I: Intersector> Contender for Through<I> {
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
                |loan, (rays, blocked)| accel.occluded(rays, blocked, coherence, loan.get()),
            );
        } else {
            let pieces = pieces.zip(self.hits.chunks_mut(PIECE));
            team.share(
                pieces,
                || Loan::new(spare),
                |loan, (rays, hits)| accel.closest(rays, hits, coherence, loan.get()),
            );
        }
    }

    fn answers(&self, set: &RaySet) -> Answers {
        if set.kind.any_hit() { Answers::Blocked(self.blocked.clone()) } else { Answers::Closest(self.hits.clone()) }
    }
}

/// The native hierarchy with one kernel for all packets.
#[derive(Clone, Copy)]
pub struct Forced<'a> {
    native: &'a Native,
    kernel: Kernel,
}

impl<'a> Forced<'a> {
    /// `native` by `kernel` alone.
    #[must_use]
    pub fn new(native: &'a Native, kernel: Kernel) -> Self {
        Self { native, kernel }
    }
}

impl Intersector for Forced<'_> {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Scratch) {
        self.native.closest_with(self.kernel, rays, hits, coherence, scratch);
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Scratch) {
        self.native.occluded_with(self.kernel, rays, blocked, coherence, scratch);
    }

    fn build_stats(&self) -> BuildStats {
        self.native.build_stats()
    }
}

/// The native hierarchy: as renders use it, then by each kernel alone.
pub fn native(native: &Native) -> Vec<Box<dyn Contender + '_>> {
    let by = |mode, kernel| -> Box<dyn Contender + '_> {
        Box::new(Through::new("native", mode, Forced::new(native, kernel)))
    };
    vec![
        by("auto", Kernel::Auto),
        by("single", Kernel::Single),
        by("packet", Kernel::Packet),
        by("batch", Kernel::Stream),
    ]
}
