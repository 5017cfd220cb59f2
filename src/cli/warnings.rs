//! Warnings of a command: those of the loader and the notices about the scene and its picture, one line each.

use std::path::Path;

use super::output;
use crate::Result;
use crate::load::{self, LoadOptions, LoadReport, Loaded};
use crate::notices::{self, Notice};
use crate::render::{Observer, Options};
use crate::scene::Scene;

/// Warnings as JSON has them, for every command that reports any.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub(super) struct Warnings {
    /// All of them, as text.
    warnings: Vec<String>,
    /// The notices among them, in parts.
    notices: Vec<Notice>,
}

impl Warnings {
    /// Warnings of the loader, then notices.
    pub fn new(report: &LoadReport, notices: Vec<Notice>) -> Self {
        let loaded = report.warnings.iter().map(ToString::to_string);
        Self { warnings: loaded.chain(notices.iter().map(ToString::to_string)).collect(), notices }
    }

    /// A scene with its own settings, and its warnings, for a command that makes no picture of it by itself.
    ///
    /// # Errors
    /// As [`load::scene`] and [`notices::survey`]; under `strict` the first warning.
    pub fn survey(file: &Path, strict: bool, options: &Options, observer: &Observer) -> Result<(Scene, Self)> {
        let Loaded { mut scene, report } = load::scene(file, &LoadOptions { strict, ..LoadOptions::default() })?;
        let notices = super::interrupt::heeded(|| notices::survey(file, &mut scene, &report, options, observer))?;
        if strict {
            refuse(&notices)?;
        }
        Ok((scene, Self::new(&report, notices)))
    }

    /// As text, a line each.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.warnings.iter().map(|warning| format!("warning: {warning}"))
    }

    /// Writes them to standard error.
    pub fn log(&self) {
        self.lines().for_each(|line| output::log(&output::one_line(&line)));
    }
}

/// Under `--strict`: the first notice is an error.
///
/// # Errors
/// The notice.
pub(super) fn refuse(notices: &[Notice]) -> Result<()> {
    notices.first().map_or(Ok(()), |notice| Err(notice.clone().into_error()))
}
