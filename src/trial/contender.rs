//! Contenders of a trial: named accelerators to be timed.

use super::rays::RaySet;
use super::team::Team;
use crate::accel::Backend;
use crate::geometry::Hit8;
use crate::simd::Mask8;

/// Number of packets that a thread takes at a time: the stream length of a render, some hundred microseconds of work.
pub const PIECE: usize = 1024;

/// Name of a contender in reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Label {
    /// The back end.
    pub backend: Backend,
    /// Choice of kernels.
    pub mode: Mode,
}

/// Choice of the kernels, or of the calls of a library, that a contender traces with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Chosen by the back end, as in renders.
    Auto,
    /// A single kernel or kind of call, by name.
    Only(&'static str),
}

impl Mode {
    /// Returns the name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Only(name) => name,
        }
    }
}

impl serde::Serialize for Mode {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} {}", self.backend.mode_name(), self.mode.name())
    }
}

/// Answers of a contender, packet by packet.
#[derive(Clone, Debug)]
pub enum Answers {
    /// The nearest hits.
    Closest(Vec<Hit8>),
    /// Lanes whose ray is blocked.
    Blocked(Vec<Mask8>),
}

/// Participant of a trial.
pub trait Contender {
    /// Its name.
    fn label(&self) -> Label;

    /// Does the work that is not timed: allocates room for the answers, converts rays to its own layout. Called before
    /// each run.
    fn prepare(&mut self, set: &RaySet);

    /// Traces all rays of the set that it was prepared for. This is the timed part.
    fn trace(&mut self, set: &RaySet, team: &Team);

    /// The answers of the last run.
    fn answers(&self, set: &RaySet) -> Answers;
}
