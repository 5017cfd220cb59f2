//! Warnings of a command: those of the loader and the notices about the scene and its picture, one line each.

use std::path::Path;

use super::options::Reading;
use super::output;
use crate::Result;
use crate::load::{LoadReport, Loaded};
use crate::notices::{self, Notice};
use crate::render::{Observer, Options};
use crate::scene::Scene;

/// Warnings in the form of the JSON output, for every command that reports any.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub(super) struct Warnings {
    /// All warnings, as text.
    warnings: Vec<String>,
    /// Notices among them, with their parts.
    notices: Vec<Notice>,
}

impl Warnings {
    /// Combines the warnings of the loader and the notices.
    pub fn new(report: &LoadReport, notices: Vec<Notice>) -> Self {
        let loaded = report.warnings.iter().map(ToString::to_string);
        Self { warnings: loaded.chain(notices.iter().map(ToString::to_string)).collect(), notices }
    }

    /// Loads a scene with its own settings, and collects its warnings, for a command that makes no picture of its own.
    ///
    /// # Errors
    /// As [`Reading::load`] and [`notices::survey`]; under `strict` the first warning.
    pub fn survey(
        (file, reading): (&Path, &Reading),
        strict: bool,
        options: &Options,
        observer: &Observer,
    ) -> Result<(Scene, Self)> {
        let Loaded { mut scene, report } = reading.load(file, strict)?;
        let notices = super::interrupt::heeded(|| notices::survey(file, &mut scene, &report, options, observer))?;
        if strict {
            refuse(&notices)?;
        }
        Ok((scene, Self::new(&report, notices)))
    }

    /// Lines of text, one per warning.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.warnings.iter().map(|warning| format!("warning: {warning}"))
    }

    /// Writes the warnings to standard error.
    pub fn log(&self) {
        self.lines().for_each(|line| output::log(&output::one_line(&line)));
    }
}

/// Makes the first notice an error, under `--strict`.
///
/// # Errors
/// The notice.
pub(super) fn refuse(notices: &[Notice]) -> Result<()> {
    notices.first().map_or(Ok(()), |notice| Err(notice.clone().into_error()))
}
