//! Subject of a study, and its progress.

use std::path::Path;
use std::time::Duration;

use super::axis::Axis;
use super::variant::Variant;
use crate::measure::Machine;
use crate::render::Observer;
use crate::scene::Scene;

/// Subject and options of a study.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// Scene, with the settings of its default picture.
    pub scene: &'a Scene,
    /// File of the scene, as named by the user.
    pub path: &'a Path,
    /// Default choices.
    pub default: Variant,
    /// Columns and rows; `None` for as many as the time limit allows.
    pub size: Option<[u32; 2]>,
    /// Number of worker threads; 0 means one per processor.
    pub threads: usize,
    /// Axes to study.
    pub axes: Vec<Axis>,
    /// Largest duration of one session.
    pub limit: Duration,
    /// Largest number of timed runs per variant.
    pub runs: usize,
    /// True if axes are combined.
    pub combine: bool,
    /// Command that started the study.
    pub command: String,
    /// Function that returns the command which repeats a variant's picture of the scene in this file, of this size.
    pub repeat: fn(&Variant, &Path, [u32; 2]) -> String,
    /// Machine that it runs on.
    pub machine: Machine,
}

/// Progress of a study, and the request to stop it.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Observer whose `stop` ends the study within a tile.
    pub observer: &'a Observer,
    /// Callback for messages on the current work.
    pub say: &'a (dyn Fn(&str) + Sync),
}
