//! From scene to film: tiles of ray streams, traced, shaded eight at a time, and their secondary rays queued.

mod options;
mod outcome;
pub mod reference;

pub use options::{Observer, Options};
pub use outcome::{Outcome, RayCounts, RayKind};
