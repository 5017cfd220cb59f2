//! Report on the input: warnings, counted once per kind, and data that was left out or filled in.

use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::{Path, PathBuf};

use super::brief::brief;
use crate::{Error, Result};

/// Number of different warnings kept with their own text; further ones are only counted.
const DISTINCT_WARNINGS: usize = 200;

/// Warning of one kind in one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// File, as named by the user.
    pub file: PathBuf,
    /// Line of the first occurrence, from 1; 0 if it concerns the whole file.
    pub line: usize,
    /// Fault and its treatment, described for the first occurrence.
    pub message: String,
    /// Number of occurrences.
    pub count: u64,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        write!(f, ": {}", self.message)?;
        if self.count > 1 {
            write!(f, " (and {} more like it)", self.count - 1)?;
        }
        Ok(())
    }
}

/// Report of a loading process.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadReport {
    /// Warnings, in the order of their first occurrence.
    pub warnings: Vec<Warning>,
    /// Number of faces left out, by reason.
    pub dropped: BTreeMap<&'static str, u64>,
    /// Parts that the scene leaves out and their defaults.
    pub defaults: Vec<String>,
    /// Model files, in the order they were read; a file that is read twice is listed twice.
    pub models: Vec<Model>,
    /// Unused materials of the scene file: name and line.
    pub unused_materials: Vec<(String, u32)>,
    /// By object: state of a dielectric mesh's surface.
    pub hulls: BTreeMap<usize, Hull>,
}

/// Numbers of faces of a model file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    /// File, as named by the user.
    pub file: PathBuf,
    /// Number of faces.
    pub faces: u64,
    /// Number of faces left out, including triangles of faces left out in part.
    pub dropped: u64,
}

/// State of the surface of a dielectric mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hull {
    /// Every edge is shared by triangles of consistent winding, and faces point outwards.
    Closed,
    /// An edge is open, or two triangles at it have opposite windings.
    Open,
    /// The surface is closed, and some faces point inwards.
    InsideOut {
        /// Number of separate parts whose faces point inwards.
        parts: usize,
        /// Number of all separate parts, except those within another one.
        of: usize,
    },
}

/// Collector of a [`LoadReport`].
#[derive(Debug, Default)]
pub(super) struct Reporter {
    report: LoadReport,
    strict: bool,
    /// Index into `report.warnings` by file and kind.
    places: HashMap<PathBuf, HashMap<String, usize>>,
}

impl Reporter {
    /// Creates an empty report; with `strict` the first warning is an error.
    pub(super) fn new(strict: bool) -> Self {
        Self { strict, ..Self::default() }
    }

    /// Records a warning. Warnings of one `kind` in one file are counted as one; `detail` describes the first and
    /// follows the kind in the message.
    ///
    /// # Errors
    /// Returns the warning itself if `strict`.
    pub(super) fn warn(&mut self, file: &Path, line: usize, kind: &str, detail: impl FnOnce() -> String) -> Result<()> {
        self.warn_times(file, line, kind, 1, detail)
    }

    /// Records a warning that occurred `count` times, first at `line`.
    ///
    /// # Errors
    /// As [`Self::warn`].
    pub(super) fn warn_times(
        &mut self,
        file: &Path,
        line: usize,
        kind: &str,
        count: u64,
        detail: impl FnOnce() -> String,
    ) -> Result<()> {
        let known = self.places.get(file).and_then(|kinds| kinds.get(kind));
        if let Some(&place) = known {
            self.report.warnings[place].count += count;
            return Ok(());
        }
        let message = brief(kind.to_owned() + &detail());
        if self.strict {
            return Err(if line > 0 { Error::at(file, line, message) } else { Error::file(file, message) });
        }
        if self.report.warnings.len() > DISTINCT_WARNINGS {
            self.report.warnings[DISTINCT_WARNINGS].count += count;
            return Ok(());
        }
        let place = self.report.warnings.len();
        let message =
            if place == DISTINCT_WARNINGS { String::from("further warnings are only counted") } else { message };
        self.report.warnings.push(Warning { file: file.to_owned(), line, message, count });
        self.places.entry(file.to_owned()).or_default().insert(kind.to_owned(), place);
        Ok(())
    }

    /// Returns the first warnings so far about `file`, as text.
    pub(super) fn first_warnings(&self, file: &Path, most: usize) -> Vec<String> {
        let of_file = self.report.warnings.iter().filter(|w| w.file == file);
        of_file.take(most).map(ToString::to_string).collect()
    }

    /// Returns the reason for which most faces were left out.
    pub(super) fn most_dropped(&self) -> Option<&'static str> {
        self.report.dropped.iter().max_by_key(|(_, count)| **count).map(|(reason, _)| *reason)
    }

    /// Counts a face that was left out.
    pub(super) fn dropped(&mut self, reason: &'static str) {
        *self.report.dropped.entry(reason).or_default() += 1;
    }

    /// Returns the number of faces left out so far.
    pub(super) fn dropped_so_far(&self) -> u64 {
        self.report.dropped.values().sum()
    }

    /// Records the faces of a model file; `dropped_before` were left out before it was read.
    pub(super) fn model(&mut self, file: &Path, faces: usize, dropped_before: u64) {
        let dropped = self.dropped_so_far() - dropped_before;
        self.report.models.push(Model { file: file.to_owned(), faces: faces as u64, dropped });
    }

    /// Records an unused material of the scene file.
    pub(super) fn unused_material(&mut self, name: String, line: u32) {
        self.report.unused_materials.push((name, line));
    }

    /// Records a default that was used.
    pub(super) fn default_used(&mut self, what: impl Into<String>) {
        self.report.defaults.push(what.into());
    }

    /// Records the state of a dielectric mesh's surface.
    pub(super) fn hull(&mut self, object: usize, hull: Hull) {
        self.report.hulls.insert(object, hull);
    }

    /// Returns the report.
    pub(super) fn finish(self) -> LoadReport {
        self.report
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_of_one_kind_and_file_are_counted_once() {
        let mut reporter = Reporter::new(false);
        for line in 1..=3 {
            reporter.warn(Path::new("a.obj"), line, "odd", || format!(": {line}")).unwrap();
        }
        reporter.warn(Path::new("b.obj"), 7, "odd", String::new).unwrap();
        let report = reporter.finish();
        assert_eq!(report.warnings.len(), 2);
        assert_eq!(report.warnings[0].to_string(), "a.obj:1: odd: 1 (and 2 more like it)");
        assert_eq!(report.warnings[1].to_string(), "b.obj:7: odd");
    }

    #[test]
    fn a_flood_of_different_warnings_stays_bounded_and_is_counted() {
        let mut reporter = Reporter::new(false);
        for i in 0..1000 {
            reporter.warn(Path::new("a.obj"), i + 1, &format!("odd {i}"), String::new).unwrap();
        }
        let report = reporter.finish();
        assert_eq!(report.warnings.len(), DISTINCT_WARNINGS + 1);
        assert_eq!(report.warnings.iter().map(|w| w.count).sum::<u64>(), 1000);
    }

    #[test]
    fn strict_makes_the_first_warning_an_error() {
        let error = Reporter::new(true).warn(Path::new("a.obj"), 4, "odd", String::new).unwrap_err();
        assert_eq!(error.to_string(), "a.obj:4: odd");
    }
}
